"""The contract of every backend, as checks that raise ``AssertionError`` with a sentence.

They know no engine and no scenario: other people's backends are held to the same ones.

    from simcompare.backends import conformance
    conformance.check(my_backend, scenario, Settings())  # the interface, for any scenario
    conformance.check_physics(my_backend)  # does it do physics? See ``conformance_physics``

The checks of ``CHECKS`` can be called one by one, as ``check(conformance.Run(my_backend, …))``;
they share what the run has simulated.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from simcompare.backends.conformance_audit import values_are_read_back
from simcompare.backends.conformance_physics import PHYSICS as PHYSICS
from simcompare.backends.conformance_physics import check as check_physics
from simcompare.backends.conformance_run import FEW_STEPS, Run, further_signals, shorter, thrown
from simcompare.engine.backend import Backend
from simcompare.engine.features import Feature, needs
from simcompare.engine.simulation import sample_times
from simcompare.errors import SimcompareError, Unsupported
from simcompare.model.scenario import Joint, Scenario
from simcompare.model.settings import ASSISTED, DEFAULT, TUNED, Settings
from simcompare.model.trajectory import BODY_SIGNALS

__all__ = ["CHECKS", "PHYSICS", "Run", "check", "check_physics", "faults"]

Check = Callable[[Run], None]


def names_and_shapes(run: Run) -> None:
    """Every body, joint, actuator and sensor has its signals, each with one row per sample."""
    signals, rows = run.trajectory.signals, len(run.trajectory.time_s)
    wanted = {
        f"{body}.{part}": width
        for body in run.scenario.moving_bodies()
        for part, width in BODY_SIGNALS.items()
    }
    further = further_signals(run.scenario)
    for name, width in {**wanted, **further}.items():
        if name in further and name in run.trajectory.lacks:
            assert len(run.trajectory.lacks[name]) > 20, f"{name} is lacking without a reason"
            continue
        assert name in signals, f"{name} is not recorded"
        shape, expected = signals[name].shape, (rows, width) if width > 1 else (rows,)
        assert shape == expected, f"{name} has {shape=} but {expected=}"


def clock(run: Run) -> None:
    """The k-th sample is the state after k steps, from the start to the end of the scenario."""
    np.testing.assert_array_equal(run.trajectory.time_s, sample_times(run.scenario))


def starts_as_told(run: Run) -> None:
    """The first sample is the scenario's initial state, in the world's frame."""
    free = run.scenario.free_bodies()
    for name, body in run.scenario.moving_bodies().items():
        # how a body on a joint moves follows from the joint
        for part in BODY_SIGNALS if name in free else ("position_m", "orientation_wxyz"):
            got, wanted = run.signal(f"{name}.{part}")[0], getattr(body, part)
            atol = max(1e-9, 10 * run.precision)
            np.testing.assert_allclose(got, wanted, rtol=1e-6, atol=atol, err_msg=f"{name}.{part}")


def joints_start_as_told(run: Run) -> None:
    """At the start a joint's coordinate is 0, and its rate the scenario's."""
    held = run.walk.states[0].joints
    for name, joint in run.scenario.movable_joints().items():
        assert name in held, f"the state does not hold {name}"
        wanted, atol = (0.0, joint.rate), max(1e-9, 10 * run.precision)
        np.testing.assert_allclose(held[name], wanted, rtol=1e-6, atol=atol, err_msg=name)


def finite_and_rigid(run: Run) -> None:
    """All numbers are finite and all orientations are rotations."""
    for name, values in run.trajectory.signals.items():
        assert np.isfinite(values).all(), f"{name} is not finite"
        if name.endswith("orientation_wxyz"):
            lengths = np.linalg.norm(values, axis=1)
            np.testing.assert_allclose(lengths, 1, atol=1e-6, err_msg=name)


def repeats_bit_for_bit(run: Run) -> None:
    """The same run gives the same bits, also after a different run in the same process."""
    first = run.trajectory
    other = DEFAULT if run.settings.contact == ASSISTED else ASSISTED
    with contextlib.suppress(Unsupported):  # then there is no run of that kind to be disturbed by
        run.backend.simulate(shorter(run), replace(run.settings, contact=other))
    again = run.backend.simulate(run.scenario, run.settings)
    for name, values in first.signals.items():
        assert np.array_equal(values, again.signals[name]), f"{name} depends on the run before"


def stepping_is_simulating(run: Run) -> None:
    """Stepping by hand passes through the samples of ``simulate``."""
    times = run.trajectory.time_s
    for k, state in run.walk.states.items():
        assert math.isclose(state.time_s, times[k], rel_tol=1e-12), (
            f"{state.time_s} after {k} steps"
        )
        for body, motion in state.bodies.items() if k else ():
            for part in BODY_SIGNALS:
                got, wanted = np.array(getattr(motion, part)), run.signal(f"{body}.{part}")[k]
                if part == "orientation_wxyz" and got @ wanted < 0:
                    got = -got  # the same rotation
                said = f"{body}.{part} after {k} steps"
                np.testing.assert_allclose(got, wanted, rtol=1e-9, atol=1e-9, err_msg=said)


#: largest differences after going back twice: rounding, and for rates what is left by a solver that
#: remembers its last solution and stops 1e-6 before the next (measured: 2e-8 rad/s)
_ALIKE = {"position_m": 1e-9, "orientation_wxyz": 1e-9, "velocity_m_s": 1e-9, "rate_rad_s": 1e-6}


def state_can_be_restored(run: Run) -> None:
    """Going back to a state and stepping again gives the same motion, also through contacts."""
    start, (once, again) = run.walk.states[run.half // 2], run.walk.returns
    assert math.isclose(once.time_s, again.time_s)
    for body in start.bodies:
        one, two = once.bodies[body], again.bodies[body]
        for part, atol in _ALIKE.items():
            first, second, said = getattr(one, part), getattr(two, part), f"{body}.{part}"
            loose = max(atol, run.precision)
            np.testing.assert_allclose(first, second, rtol=1e-9, atol=loose, err_msg=said)


def saving_is_exact(run: Run) -> None:
    """From a token that was saved everything goes on bit for bit, also through contacts."""
    one, two = run.walk.kept
    assert one.time_s == two.time_s
    for body, motion in one.bodies.items():
        assert motion == two.bodies[body], f"{body} goes on in another way after a restore"
    assert one.joints == two.joints, "joints go on in another way after a restore"


def features_are_true(run: Run) -> None:
    """What runs is covered by the features that are stated, and what is not stated is refused."""
    backend, scenario = run.backend, run.scenario
    lacking = needs(scenario).required - backend.features
    assert not lacking, f"{backend.name} runs what it says it cannot: {sorted(lacking)}"
    child = next(iter(scenario.moving_bodies()))
    parent = next((name for name in scenario.bodies if name != child), None)
    for feature, kind in _JOINTS.items():
        if feature in backend.features or parent is None:
            continue
        joint = Joint.model_validate({**kind, "parent": parent, "child": child})
        bare = {"joints": {"joint": joint}, "actuators": {}, "sensors": {}}
        try:
            backend.open(scenario.model_copy(update=bare), run.settings).close()
        except Unsupported:
            continue
        raise AssertionError(f"{backend.name} leaves out {feature} without a word")


_JOINTS: dict[Feature, dict[str, str | float]] = {
    Feature.HINGE: {"type": "hinge"},
    Feature.SLIDER: {"type": "slider"},
    Feature.BALL_JOINT: {"type": "ball"},
    Feature.JOINT_LIMIT: {"type": "hinge", "upper": 1.0},
}


def bodies_hang_on_their_joints(run: Run) -> None:
    """Where the engine itself has a body is where its joints put it, to 0.1 mm."""
    if not run.scenario.joints:
        return
    few = run.walk.states[min(FEW_STEPS, run.half)]
    # a scene may fall over by default; where its bodies are must be known all the same
    for body, motion in few.bodies.items():
        np.testing.assert_allclose(
            run.walk.origins[body], motion.position_m, rtol=0, atol=1e-4, err_msg=body
        )


def inputs_drive_joints(run: Run) -> None:
    """Inputs that are given in a step replace the scenario's signals; nonsense is refused."""
    inputs = run.scenario.inputs
    if not inputs:
        return
    simulation = run.backend.open(run.scenario, run.settings)
    try:
        simulation.step(dict.fromkeys(inputs, 0.0))
        for wrong in ({"no such input": 1.0}, dict.fromkeys(inputs, math.nan), [1.0]):
            try:
                simulation.step(wrong)  # type: ignore[arg-type]
            except SimcompareError:
                continue
            raise AssertionError(f"{run.backend.name} takes the inputs {wrong}")
    finally:
        simulation.close()


def flies_freely(run: Run) -> None:
    """Lifted off and thrown, free bodies move as gravity says, up to the first-order g·dt·t."""
    if not run.scenario.free_bodies():
        return
    flight = Run(run.backend, thrown(run.scenario), run.settings)
    world = flight.scenario.world
    gravity = np.array(world.gravity_m_s2)
    t = flight.trajectory.time_s[:, None]
    slack = float(np.linalg.norm(gravity)) * world.engine_step_s
    for name, body in flight.scenario.moving_bodies().items():
        wanted = np.array(body.position_m) + np.array(body.velocity_m_s) * t + gravity * t**2 / 2
        got = flight.signal(f"{name}.position_m")
        # linear damping of an engine's defaults may slow it by a few per cent of its path
        damped = 0.0 if run.settings.gives(TUNED) else 0.05 * float(np.abs(wanted - got[0]).max())
        rounded = max(1e-9, run.precision * float(np.abs(wanted).max()))
        assert np.abs(got - wanted).max() <= slack * t[-1] + damped + rounded, (
            f"{name} flies wrongly"
        )


CHECKS: tuple[Check, ...] = (
    names_and_shapes,
    clock,
    starts_as_told,
    joints_start_as_told,
    finite_and_rigid,
    repeats_bit_for_bit,
    stepping_is_simulating,
    state_can_be_restored,
    saving_is_exact,
    values_are_read_back,
    features_are_true,
    bodies_hang_on_their_joints,
    inputs_drive_joints,
    flies_freely,
)


def faults(backend: Backend, scenario: Scenario, settings: Settings) -> list[str]:
    """Every check that a backend fails with a scenario, by name, with what is wrong.

    Raises:
        Unsupported: the backend refuses the scenario at this level.
    """
    run, found = Run(backend, scenario, settings), []
    backend.open(scenario, settings).close()
    for one in CHECKS:
        try:
            one(run)
        except (AssertionError, SimcompareError) as error:
            found.append(f"{one.__name__}: {error}")
    return found


def check(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Holds a backend to all checks of the interface with one scenario at one level.

    Raises:
        Unsupported: the backend refuses the scenario at this level.
        AssertionError: some checks fail; every one is named.
    """
    found = faults(backend, scenario, settings)
    assert not found, f"{backend.name}, {scenario.name}, {settings.contact}: " + "\n".join(found)
