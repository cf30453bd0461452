"""Physics of contacts: bounces, friction, a stack, and what does not touch."""

from __future__ import annotations

import math

import numpy as np

from simcompare.backends.conformance_scenes import (
    STEP_S,
    PhysicsCheck,
    all_near,
    ball,
    box,
    floor,
    near,
    orientations_near,
    physics,
    scene,
    signal,
)
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import G_M_S2
from simcompare.model.trajectory import Trajectory

_DROP_M, _RADIUS_M, _E = 0.3, 0.05, 0.6
_LANDS_S = math.sqrt(2 * _DROP_M / G_M_S2)


def _drop(name: str, restitution: float) -> Scenario:
    falling = ball(0.2, _RADIUS_M, position_m=[0, 0, _RADIUS_M + _DROP_M])
    contacts = [{"pair": ["ball", "floor"], "restitution": restitution}]
    return scene(name, {"floor": floor(), "ball": falling}, 0.55, contacts=contacts)


def _rises_to(run: Trajectory) -> float:
    """Greatest height of the ball's lowest point once it has landed [m]."""
    after = run.time_s > _LANDS_S + 0.05
    return float(signal(run, "ball.position_m")[after, 2].max()) - _RADIUS_M


@physics(_drop("drop", _E))
def bounces_by_its_restitution(run: Trajectory) -> None:
    """A ball that is dropped leaves the floor e times as fast as it met it."""
    e = math.sqrt(max(_rises_to(run), 0.0) / _DROP_M)
    # in a plain loop one bounce depends on where in the step it falls: with calibrated springs it
    # scatters by up to 3.4 % about a mean that is right (measured in 25 phases)
    near("the ball bounces with e =", e, _E, 0.05 * _E, "")


@physics(_drop("dead_drop", 0.0))
def stays_down_without_restitution(run: Trajectory) -> None:
    """A ball without restitution stays on the floor, and does not sink into it."""
    # a critically damped spring, the least bouncy there is, gives back e = 0.14 (e² = 0.02)
    near("a ball without restitution rises to", _rises_to(run), 0.0, 0.02 * _DROP_M, "m")
    # what one step goes deep may stay, where an engine does not push bodies out of each other
    end = float(signal(run, "ball.position_m")[-1, 2]) - _RADIUS_M
    near("it comes to rest at a height of", end, 0.0, STEP_S * G_M_S2 * _LANDS_S, "m")


_SPEED = 1.0
_GRIPS = {"smooth": 0.25, "rough": 0.6}


@physics(
    scene(
        "two_slides",
        {
            "floor": floor(),
            "smooth": box(0.5, (0.12, 0.12, 0.03), position_m=[0, 0, 0.015],
                          velocity_m_s=[_SPEED, 0, 0]),
            "rough": box(0.3, (0.12, 0.12, 0.03), position_m=[-1, 0, 0.015],
                         velocity_m_s=[_SPEED, 0, 0]),
        },
        0.45,
        contacts=[{"pair": [name, "floor"], "friction": mu} for name, mu in _GRIPS.items()],
    )
)  # fmt: skip
def friction_brakes(run: Trajectory) -> None:
    """Blocks stop after v²/(2·µ·g), each by the friction of its own pair."""
    for name, mu in _GRIPS.items():
        place = signal(run, f"{name}.position_m")
        slid = float(place[-1, 0] - place[0, 0])
        wanted = _SPEED**2 / (2 * mu * G_M_S2)
        # a step counts with the velocity of one of its ends: v·dt/2 more or less; twice that
        wrong = "does not brake" if slid > 2 * wanted else "brakes wrongly"
        near(f"friction {wrong}, µ = {mu:g}: slid", slid, wanted, _SPEED * STEP_S, "m")


_ASIDE = 0.6


@physics(
    scene(
        "aslant",
        {
            "floor": floor(),
            "block": box(
                0.5,
                (0.12, 0.12, 0.03),
                position_m=[0, 0, 0.015],
                velocity_m_s=[math.cos(_ASIDE), math.sin(_ASIDE), 0],
            ),
        },
        0.3,
        contacts=[{"pair": ["block", "floor"], "friction": 0.5}],
    )
)
def friction_brakes_in_all_directions(run: Trajectory) -> None:
    """A block that slides aslant to the axes stops as far away, and straight ahead."""
    way = signal(run, "block.position_m")[-1]
    ahead = np.array([math.cos(_ASIDE), math.sin(_ASIDE)])
    slid, aside = float(way[:2] @ ahead), float(way[1] * ahead[0] - way[0] * ahead[1])
    wanted = _SPEED**2 / (2 * 0.5 * G_M_S2)
    near("friction brakes wrongly aslant: slid", slid, wanted, _SPEED * STEP_S, "m")
    near("a block that slides aslant leaves its line by", aside, 0.0, 0.01 * wanted, "m")


_M, _N, _HIT = 0.2, 0.1, 0.5


@physics(
    scene(
        "two_balls",
        {
            "fast": ball(_M, _RADIUS_M, position_m=[-0.2, 0, 0], velocity_m_s=[_SPEED, 0, 0]),
            "still": ball(_N, _RADIUS_M),
        },
        0.3,
        (0.0, 0.0, 0.0),
        contacts=[{"pair": ["fast", "still"], "restitution": _HIT}],
    )
)
def balls_share_their_momentum(run: Trajectory) -> None:
    """Two balls keep their momentum and leave each other e times as fast as they met."""
    fast, still = (signal(run, f"{name}.velocity_m_s") for name in ("fast", "still"))
    whole = _M * _SPEED
    # equal and opposite forces, to the rounding of single precision
    all_near("momentum is", _M * fast + _N * still, np.array([whole, 0, 0]), 1e-4 * whole, "N·s")
    e = float(still[-1, 0] - fast[-1, 0]) / _SPEED
    # as for a drop: a calibrated spring scatters over the step
    near("the balls bounce with e =", e, _HIT, 0.05 * _HIT, "")


_LOW_KG, _HIGH_KG, _EDGE_M = 1.0, 0.5, 0.1


@physics(
    scene(
        "stack",
        {
            "floor": floor(),
            "low": box(_LOW_KG, (_EDGE_M,) * 3, position_m=[0, 0, _EDGE_M / 2]),
            "high": box(_HIGH_KG, (_EDGE_M,) * 3, position_m=[0, 0, 1.5 * _EDGE_M]),
        },
        0.5,
        contacts=[
            # 1 for all, also for the two that never meet: that can be given to engines with a
            # friction per body, whether they multiply two or take the smaller
            {"pair": pair, "friction": 1.0}
            for pair in (["low", "floor"], ["low", "high"], ["high", "floor"])
        ],
        sensors={
            "below": {"type": "contact_force", "pair": ["low", "floor"]},
            "between": {"type": "contact_force", "pair": ["low", "high"]},
        },
    )
)
def stack_stands(run: Trajectory) -> None:
    """Of two boxes at rest the floor bears both, the lower one the upper one; none moves."""
    for name, height in (("low", _EDGE_M / 2), ("high", 1.5 * _EDGE_M)):
        # springs that are soft give way by 0.05 mm at first, and a solver that takes contacts in
        # turns lets the boxes creep by 0.09 mm (both measured); a box that falls is off by far more
        place = np.array([0, 0, height])
        all_near(f"box {name} stands at", signal(run, f"{name}.position_m"), place, 2e-4, "m")
        upright = np.array([[1.0, 0.0, 0.0, 0.0]])
        got = signal(run, f"{name}.orientation_wxyz")
        orientations_near(f"box {name} leans", got, upright, 1e-3)
    # the first tenth of a second is for springs to settle, the mean for solvers that share the
    # load of a stack in turns
    settled = run.time_s > 0.1
    for name, mass in (("below", _LOW_KG + _HIGH_KG), ("between", _HIGH_KG)):
        force = float(signal(run, f"{name}.normal_force_N")[settled].mean())
        near(f"the contact {name} bears", force, mass * G_M_S2, 0.01 * mass * G_M_S2, "N")


@physics(
    scene(
        "strangers",
        {
            "right": ball(0.2, _RADIUS_M, position_m=[-0.2, 0, 0], velocity_m_s=[_SPEED, 0, 0]),
            "left": ball(0.1, _RADIUS_M, position_m=[0.2, 0, 0], velocity_m_s=[-_SPEED, 0, 0]),
        },
        0.4,
        (0.0, 0.0, 0.0),
    )
)
def strangers_pass_through(run: Trajectory) -> None:
    """Two moving bodies whose pair is not named pass through each other."""
    t = run.time_s[:, None]
    for name, start in (("right", -0.2), ("left", 0.2)):
        speed = math.copysign(_SPEED, -start)
        wanted = np.array([start, 0, 0]) + t * np.array([speed, 0, 0])
        got = signal(run, f"{name}.position_m")
        # nothing acts: only rounding, in single precision 3 µm after all steps (measured)
        all_near("two bodies that do not touch: one is at", got, wanted, 1e-5, "m")


CHECKS: tuple[PhysicsCheck, ...] = (
    bounces_by_its_restitution,
    stays_down_without_restitution,
    friction_brakes,
    friction_brakes_in_all_directions,
    balls_share_their_momentum,
    stack_stands,
    strangers_pass_through,
)
