"""Half-step start: motion begins half a step away from the start, where steps store velocities.

Semi-implicit Euler stores velocities half a step away from positions, but a scenario's initial
velocities belong to the start itself. Left as they are, all motion runs ahead, or behind, by half a
step of the first acceleration. The engine itself tells how large that is, by steps that are taken
back, or that end at the start.

Where bodies may touch at the start, velocities that come first are left as they are: an engine may
find the contact only in its second step, and moving backwards there turns friction round.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare.engine.clearance import starts_in_flight
from simcompare.engine.contacts import touching_pairs
from simcompare.engine.kinematics import add_children
from simcompare.engine.planar_joints import angle_of
from simcompare.engine.state import BodyState, State
from simcompare.engine.steppable import Planar, Retractable
from simcompare.model.scenario import MOVABLE, Scenario
from simcompare.model.trajectory import Array


def acts(scenario: Scenario, positions_first: bool, *, is_landing: bool) -> bool:
    """Whether velocities are to be moved in a scene."""
    if is_landing:
        return True
    if positions_first:
        return not any(contact.restitution > 0 for contact in scenario.contacts)
    return not touching_pairs(scenario) or starts_in_flight(scenario)


def begin_before(simulation: Retractable) -> None:
    """Moves the velocities to half a step before the start, by a step that is taken back.

    An engine that divides its steps stores them half an inner step before the start.
    """
    recoil, felt = simulation.recoil, None
    start = simulation.save()
    for _ in range(recoil.tries if recoil else 0):
        assert recoil is not None
        simulation.advance(1)
        recoil.look(simulation.rotor_motions())
        felt = recoil.felt
        simulation.restore(start)
        recoil.begin(felt)
    before = simulation.state
    simulation.advance(1)
    after = simulation.state
    simulation.go_to(
        half_a_step_back(before, after, simulation.step_s, simulation.driven, simulation.stagger)
    )
    if recoil is not None:
        recoil.begin(felt)


def half_a_step_back(
    start: State,
    after: State,
    step_s: float,
    driven: Sequence[str] | None,
    stagger: float = -0.5,
) -> State:
    """The start with all velocities moved to half a step before it, by how they change in a step.

    Args:
        start: the state with velocities of its own instant.
        after: the state that one engine step makes of it.
        step_s: the engine step [s].
        driven: driven joints, whose rates one step earlier are chosen so that the first estimate of
            the rate at the positions' instant (see ``drives``) is the rate at the start itself.
        stagger: steps by which they are moved; less than half of one, where an engine divides it.
    """

    def back(value: float, later: float) -> float:
        return value + stagger * (later - value)

    bodies = {
        name: BodyState(
            held.position_m,
            held.orientation_wxyz,
            tuple(map(back, held.velocity_m_s, after.bodies[name].velocity_m_s)),
            tuple(map(back, held.rate_rad_s, after.bodies[name].rate_rad_s)),
        )
        for name, held in start.bodies.items()
    }
    joints = {
        name: (position, back(rate, after.joints[name][1]))
        for name, (position, rate) in start.joints.items()
    }
    before = None
    if driven is not None:
        before = tuple(3 * joints[name][1] - 2 * start.joints[name][1] for name in driven)
    return State(start.time_s, bodies, step_s, joints, before)


def begin_after(simulation: Planar) -> None:
    """Moves the velocities to half a step after the start.

    Bodies are put where they were a step before the start, so that the step that ends there gives
    all accelerations at the start.

    Bodies on joints go along chords, which leaves gaps that the engine closes in the next step.
    What the joints' motion alone bends them by is put into the start as such a gap, else forces
    and velocities would have to find it in the first two steps.
    """
    step_s, index = simulation.step_s, simulation.index
    names = list(simulation.scenario.moving_bodies())
    start = [simulation.get(name) for name in names]
    bends = _bends(simulation.scenario, simulation.state, step_s)
    reached, earlier = [], []
    for (x, z, vx, vz, _, rate), (bend_x, bend_z) in zip(start, bends, strict=True):
        reached.append((x - bend_x, z - bend_z))
        earlier.append((vx - bend_x / step_s, vz - bend_z / step_s, rate))
    recoil = simulation.recoil
    for last in [False] * (recoil.tries if recoil else 0) + [True]:
        for name, (x, z), (ux, uz, rate), (*_, angle, _) in zip(
            names, reached, earlier, start, strict=True
        ):
            simulation.put(
                name, (x - step_s * ux, z - step_s * uz, ux, uz, angle - step_s * rate, rate)
            )
        simulation.take_step_that_ends_at(index, last=last)
        for name, (x, z), (*_, angle, _) in zip(names, reached, start, strict=True):
            _, _, vx, vz, _, rate = simulation.get(name)
            simulation.put(name, (x, z, vx, vz, angle, rate))
    later = [simulation.get(name) for name in names]
    for part in (-0.5, 0.5):
        for name, (_, _, vx, vz, _, rate), (ux, uz, was), (x, z, wx, wz, angle, spin) in zip(
            names, start, earlier, later, strict=True
        ):
            moved = vx + part * (wx - ux), vz + part * (wz - uz)
            simulation.put(name, (x, z, *moved, angle, rate + part * (spin - was)))
        if part < 0:
            simulation.note_rates_before()


def _bends(scenario: Scenario, state: State, step_s: float) -> list[tuple[float, float]]:
    """Half the second differences of all positions in a step, if joints kept their rates."""
    times = step_s * np.array((-1.0, 0.0, 1.0))
    signals: dict[str, Array] = {}
    for name in scenario.free_bodies():
        held = state.bodies[name]
        half = (times * held.rate_rad_s[1] - angle_of(held.orientation_wxyz)) / 2
        zero = np.zeros(3)
        signals[f"{name}.position_m"] = held.position_m + np.outer(times, held.velocity_m_s)
        signals[f"{name}.orientation_wxyz"] = np.column_stack(
            (np.cos(half), zero, np.sin(half), zero)
        )
        for part in ("velocity_m_s", "rate_rad_s"):
            signals[f"{name}.{part}"] = np.tile(getattr(held, part), (3, 1))
    for name, joint in scenario.movable_joints().items():
        position, rate = state.joints[name]
        coordinate, speed = MOVABLE[joint.type]
        signals[f"{name}.{coordinate}"] = position + rate * times
        signals[f"{name}.{speed}"] = np.full(3, rate)
    add_children(scenario, signals, 3)
    found = []
    for name in scenario.moving_bodies():
        before, now, after = signals[f"{name}.position_m"]
        x, _, z = ((before + after) / 2 - now).tolist()
        found.append((x, z))
    return found
