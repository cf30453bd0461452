"""The contract of every backend, as checks that raise ``AssertionError`` with a sentence.

They know no engine and no scenario: other people's backends are held to the same ones.

    from simcompare.backends import conformance
    for check in conformance.CHECKS:
        check(my_backend, scenario, Settings())
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from simcompare.backend import Backend, Feature, needs
from simcompare.errors import SimcompareError, Unsupported
from simcompare.scenario import ACTUATOR_SIGNALS, MOVABLE, SENSOR_SIGNALS, Joint, Scenario
from simcompare.settings import ASSISTED, Settings
from simcompare.simulation import sample_times
from simcompare.trajectory import BODY_SIGNALS

Check = Callable[[Backend, Scenario, Settings], None]


def names_and_shapes(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Every body, joint, actuator and sensor has its signals, each with one row per sample."""
    trajectory = backend.simulate(scenario, settings)
    for body in scenario.moving_bodies():
        for part, width in BODY_SIGNALS.items():
            name = f"{body}.{part}"
            assert name in trajectory.signals, f"{name} is not recorded"
            shape = trajectory.signals[name].shape
            wanted = (len(trajectory.time_s), width)
            assert shape == wanted, f"{name} has {shape=} but {wanted=}"
    for name, width in _further_signals(scenario).items():
        if name in trajectory.lacks:
            continue  # it says why
        assert name in trajectory.signals, f"{name} is not recorded"
        shape = trajectory.signals[name].shape
        wanted_shape = (len(trajectory.time_s), width) if width > 1 else (len(trajectory.time_s),)
        assert shape == wanted_shape, f"{name} has {shape=} but {wanted_shape=}"


def clock(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """The k-th sample is the state after k steps, from the start to the end of the scenario."""
    trajectory = backend.simulate(scenario, settings)
    np.testing.assert_array_equal(trajectory.time_s, sample_times(scenario))


def starts_as_told(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """The first sample is the scenario's initial state, in the world's frame."""
    trajectory = backend.simulate(scenario, settings)
    for name, body in scenario.moving_bodies().items():
        # how a body on a joint moves follows from the joint
        free = name in scenario.free_bodies()
        for part in BODY_SIGNALS if free else ("position_m", "orientation_wxyz"):
            got, wanted = trajectory.signals[f"{name}.{part}"][0], getattr(body, part)
            np.testing.assert_allclose(got, wanted, rtol=1e-6, atol=1e-9, err_msg=f"{name}.{part}")


def finite_and_rigid(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """All numbers are finite and all orientations are rotations."""
    trajectory = backend.simulate(scenario, settings)
    for name, values in trajectory.signals.items():
        assert np.isfinite(values).all(), f"{name} is not finite"
        if name.endswith("orientation_wxyz"):
            lengths = np.linalg.norm(values, axis=1)
            np.testing.assert_allclose(lengths, 1, atol=1e-6, err_msg=name)


def repeats_bit_for_bit(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """The same run gives the same bits, also after a different run in the same process."""
    first = backend.simulate(scenario, settings)
    other = "default" if settings.contact == ASSISTED else ASSISTED
    backend.simulate(_shorter(scenario), replace(settings, contact=other))
    again = backend.simulate(scenario, settings)
    for name, values in first.signals.items():
        assert np.array_equal(values, again.signals[name]), f"{name} depends on the run before"


def stepping_is_simulating(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Stepping by hand passes through the samples of ``simulate``."""
    short = _shorter(scenario)
    whole = backend.simulate(short, settings)
    simulation = backend.open(short, settings)
    try:
        for k in range(1, len(whole.time_s)):
            simulation.step()
            assert math.isclose(simulation.time_s, whole.time_s[k], rel_tol=1e-12)
        state = simulation.state
    finally:
        simulation.close()
    for body, motion in state.bodies.items():
        got, wanted = motion.position_m, whole.signals[f"{body}.position_m"][-1]
        np.testing.assert_allclose(got, wanted, rtol=1e-9, atol=1e-9, err_msg=body)


def state_can_be_restored(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Going back to a state and stepping again gives the same motion, also through contacts."""
    short = _shorter(scenario)
    steps = len(sample_times(short)) // 2
    simulation = backend.open(short, settings)
    try:
        for _ in range(steps):
            simulation.step()
        start = simulation.state
        ends = []
        for _ in range(2):
            simulation.set_state(start)
            for _ in range(steps):
                simulation.step()
            ends.append(simulation.state)
    finally:
        simulation.close()
    assert math.isclose(ends[0].time_s, ends[1].time_s)
    for body in start.bodies:
        one, two = (end.bodies[body] for end in ends)
        np.testing.assert_allclose(one.position_m, two.position_m, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(one.velocity_m_s, two.velocity_m_s, rtol=1e-9, atol=1e-9)


def values_are_read_back(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Mass and gravity of the engine are on record, and what was set is what it holds."""
    audit = backend.simulate(_shorter(scenario), settings).audit
    quantities = {row.quantity for row in audit if row.read_value is not None}
    for body in scenario.moving_bodies():
        assert f"{body}.mass_kg" in quantities, f"the mass of {body} is not read back"
    assert any(name.startswith("gravity") for name in quantities), "gravity is not read back"
    for row in audit:
        if row.set_value is not None and row.read_value is not None:
            close = math.isclose(row.set_value, row.read_value, rel_tol=1e-6, abs_tol=1e-12)
            assert close, f"{row.quantity}: set {row.set_value}, holds {row.read_value}"


def features_are_true(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """What runs is covered by the features that are stated, and what is not stated is refused."""
    lacking = needs(scenario) - backend.features
    assert not lacking, f"{backend.name} runs what it says it cannot: {sorted(lacking)}"
    child = next(iter(scenario.moving_bodies()))
    parent = next((name for name in scenario.bodies if name != child), None)
    for feature, kind in _JOINTS.items():
        if feature in backend.features or parent is None:
            continue
        joint = Joint.model_validate({**kind, "parent": parent, "child": child})
        bare = {"joints": {"joint": joint}, "actuators": {}, "sensors": {}}
        try:
            backend.open(scenario.model_copy(update=bare), settings).close()
        except Unsupported:
            continue
        raise AssertionError(f"{backend.name} leaves out {feature} without a word")


_JOINTS: dict[Feature, dict[str, str | float]] = {
    Feature.HINGE: {"type": "hinge"},
    Feature.SLIDER: {"type": "slider"},
    Feature.BALL_JOINT: {"type": "ball"},
    Feature.JOINT_LIMIT: {"type": "hinge", "upper": 1.0},
}


def bodies_hang_on_their_joints(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Where the engine itself has a body is where its joints put it, to 0.1 mm."""
    if not scenario.joints:
        return
    simulation = backend.open(_shorter(scenario), settings)
    try:
        for _ in range(20):
            simulation.step()
        # a scene may fall over by default; where its bodies are must be known all the same
        for body, motion in simulation.state.bodies.items():
            np.testing.assert_allclose(
                simulation.origin_of(body), motion.position_m, rtol=0, atol=1e-4, err_msg=body
            )
    finally:
        simulation.close()


def inputs_drive_joints(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Inputs that are given in a step replace the scenario's signals; nonsense is refused."""
    if not scenario.inputs:
        return
    simulation = backend.open(_shorter(scenario), settings)
    try:
        simulation.step(dict.fromkeys(scenario.inputs, 0.0))
        for wrong in ({"no such input": 1.0}, dict.fromkeys(scenario.inputs, math.nan), [1.0]):
            try:
                simulation.step(wrong)  # type: ignore[arg-type]
            except SimcompareError:
                continue
            raise AssertionError(f"{backend.name} takes the inputs {wrong}")
    finally:
        simulation.close()


def flies_freely(backend: Backend, scenario: Scenario, settings: Settings) -> None:
    """Lifted off and thrown, free bodies move as gravity says, up to the first-order g·dt·t."""
    if not scenario.free_bodies():
        return
    thrown = _thrown(scenario)
    trajectory = backend.simulate(thrown, settings)
    world = thrown.world
    gravity = np.array(world.gravity_m_s2)
    t = trajectory.time_s[:, None]
    slack = float(np.linalg.norm(gravity)) * world.engine_step_s
    for name, body in thrown.moving_bodies().items():
        wanted = np.array(body.position_m) + np.array(body.velocity_m_s) * t + gravity * t**2 / 2
        got = trajectory.signals[f"{name}.position_m"]
        # linear damping of an engine's defaults may slow it by a few per cent of its path
        damped = 0.0 if settings.gives_all else 0.05 * float(np.abs(wanted - got[0]).max())
        assert np.abs(got - wanted).max() <= slack * t[-1] + damped + 1e-9, f"{name} flies wrongly"


CHECKS: tuple[Check, ...] = (
    names_and_shapes,
    clock,
    starts_as_told,
    finite_and_rigid,
    repeats_bit_for_bit,
    stepping_is_simulating,
    state_can_be_restored,
    values_are_read_back,
    features_are_true,
    bodies_hang_on_their_joints,
    inputs_drive_joints,
    flies_freely,
)


def _further_signals(scenario: Scenario) -> dict[str, int]:
    """What is recorded besides bodies, with the number of components."""
    found = {}
    for name, joint in scenario.movable_joints().items():
        found.update({f"{name}.{part}": 1 for part in MOVABLE[joint.type]})
    for name, actuator in scenario.actuators.items():
        found.update({f"{name}.{part}": 1 for part in ACTUATOR_SIGNALS[actuator.type]})
    for name, sensor in scenario.sensors.items():
        part, width = SENSOR_SIGNALS[sensor.type]
        found[f"{name}.{part}"] = width
    return found


def _shorter(scenario: Scenario) -> Scenario:
    """The same scene for at most half its time and at most 600 steps."""
    world = scenario.world
    duration = min(world.duration_s / 2, 600 * world.step_s)
    return _with_world(scenario, duration_s=duration)


def _thrown(scenario: Scenario) -> Scenario:
    """The free bodies 100 m up, thrown within the x-z plane, for a fifth of a second, undragged."""
    bodies = {}
    free = scenario.free_bodies()
    for name, body in scenario.bodies.items():
        if body.fixed:
            bodies[name] = body
        if name not in free:
            continue
        x, y, z = body.position_m
        moved = {"position_m": (x, y, z + 100), "velocity_m_s": (1.5, 0.0, 2.0), "drag": None}
        bodies[name] = body.model_copy(update=moved)
    contacts = tuple(
        contact.model_copy(update={"restitution": 0.0})  # nothing is to bounce up there
        for contact in scenario.contacts
        if all(name in bodies for name in contact.pair)
    )
    bare: dict[str, object] = {"joints": {}, "actuators": {}, "sensors": {}, "contacts": contacts}
    thrown = scenario.model_copy(update={"bodies": bodies, **bare})
    return _with_world(thrown, duration_s=0.2)


def _with_world(scenario: Scenario, **changes: float) -> Scenario:
    world = scenario.world.model_copy(update=changes)
    return scenario.model_copy(update={"world": world})
