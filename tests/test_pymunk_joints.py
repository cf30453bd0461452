"""Joints and efforts on them in pymunk, against closed forms; gaps of its constraints and all."""

import math

import numpy as np
import pytest

from simcompare.engine import engines
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.model.settings import Settings
from tests.planar_scenes import FRAME, G, body, run, scene, signals, turned


def planar(found, name):
    return found[f"{name}.position_m"][:, [0, 2]]


# --- hinges ---------------------------------------------------------------------------------------


def pendulum(axis=1, r=0.3, duration=1.5, **more):
    """Let go where it points along +x."""
    hinge = {"type": "hinge", "parent": "frame", "child": "bob", "axis": [0, axis, 0], **more}
    return scene({**FRAME, "bob": body(at=[r, 0, 0])}, {"hinge": hinge}, duration)


def quarter_period(r=0.3, inertia=0.01):
    """From horizontal to vertical: K(sin 45°)/ω by the arithmetic-geometric mean."""
    a, b = 1.0, math.cos(math.pi / 4)
    for _ in range(6):
        a, b = (a + b) / 2, math.sqrt(a * b)
    return math.pi / (2 * a) * math.sqrt((inertia + r**2) / (G * r))


@pytest.mark.parametrize("axis", [1, -1])
def test_a_pendulum_swings_as_told_to_second_order(axis):
    errors = []
    for step in (0.002, 0.001):
        scenario = pendulum(axis).model_copy(update={"world": _stepped(pendulum(axis), step)})
        found = run(scenario)
        angle = axis * found.signals["hinge.angle_rad"] - math.pi / 2
        k = int(np.argmax(angle > 0))  # passes the vertical, where its rate is largest
        passing = np.interp(0, angle[k - 1 : k + 1], found.time_s[k - 1 : k + 1])
        errors.append(abs(passing - quarter_period()))
    assert errors[1] < 5e-6
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.3)


def _stepped(scenario, step):
    return scenario.world.model_copy(update={"step_s": step})


def test_a_pendulum_keeps_its_length_to_second_order():
    gaps = []
    for step in (0.002, 0.001):
        scenario = pendulum().model_copy(update={"world": _stepped(pendulum(), step)})
        length = np.linalg.norm(planar(run(scenario).signals, "bob"), axis=1)
        gaps.append(np.abs(length - 0.3).max())
    # half of (ω·h)²·r
    assert gaps[1] == pytest.approx(0.3 * (7.67e-3) ** 2 / 2, rel=0.02)
    assert gaps[0] / gaps[1] == pytest.approx(4, rel=0.02)


def test_with_its_defaults_a_pendulum_grows_longer():
    length = np.linalg.norm(planar(run(pendulum(), "default").signals, "bob"), axis=1)
    assert length.max() - 0.3 > 5e-4


@pytest.mark.parametrize("axis", [1, -1])
def test_a_hinge_starts_at_its_rate_and_turns_more_than_once(axis):
    hinge = {"type": "hinge", "parent": "frame", "child": "bob", "axis": [0, axis, 0], "rate": 40}
    found = signals({**FRAME, "bob": body(at=[0.1, 0, 0])}, {"hinge": hinge}, gravity=0)
    np.testing.assert_allclose(found["bob.velocity_m_s"][0], [0, 0, -axis * 4], atol=1e-12)
    np.testing.assert_allclose(found["bob.rate_rad_s"][0], [0, axis * 40, 0])
    # it goes along chords: the gap is (ω·h)²/2 of the radius, and so is the excess of its turn
    assert found["hinge.angle_rad"][-1] == pytest.approx(20, rel=1e-3)


def double(mass):
    """A pendulum of 1 kg on another one."""
    first = {"type": "hinge", "parent": "frame", "child": "upper", "axis": [0, 1, 0]}
    second = {**first, "parent": "upper", "child": "lower", "anchor_m": [0.2, 0, 0]}
    upper = body(mass, mass * 0.01, [0.2, 0, 0])
    bodies = {**FRAME, "upper": upper, "lower": body(at=[0.5, 0, 0.1])}
    return scene(bodies, {"first": {**first, "rate": -3}, "second": {**second, "rate": -2}})


def test_a_heavy_body_on_a_light_one_takes_more_sweeps_and_does_not_run_away():
    furthest = []
    for sweeps in (None, 10):
        simulation = engines.get("pymunk").open(double(0.01), Settings())
        simulation._space.iterations = sweeps or simulation._space.iterations
        for _ in range(400):
            simulation.step()
        # the arms reach 0.4 m and 0.316 m
        furthest.append(np.linalg.norm(simulation.state.bodies["lower"].position_m))
    assert furthest[0] < 0.72
    assert not furthest[1] < 10


def test_masses_too_different_for_its_solver_are_refused():
    with pytest.raises(Unsupported, match="sweeps"):
        run(double(1e-5))


# --- sliders --------------------------------------------------------------------------------------

TILT, STIFFNESS, DAMPING, REST, MASS = 0.5, 200.0, 3.0, 0.02, 0.5


def oscillator(step, **more):
    """On a rail that falls by TILT, from rest at 0; its centre lies far beside the rail."""
    rail = {"frame": {"fixed": True, "orientation_wxyz": turned(TILT)}}
    slider = {"type": "slider", "parent": "frame", "child": "mass", "axis": [1, 0, 0]}
    law = {"stiffness": STIFFNESS, "damping": DAMPING, "rest": REST}
    bodies = {**rail, "mass": body(MASS, 0.001, [0.1, 0, 0.2])}
    return scene(bodies, {"slider": {**slider, **law, **more}}, 0.4, step)


def oscillation(time_s, rate=0.0):
    """The same in closed form: under-damped, about where spring and weight balance."""
    middle = REST + MASS * G * math.sin(TILT) / STIFFNESS
    decay = DAMPING / (2 * MASS)
    omega = math.sqrt(STIFFNESS / MASS - decay**2)
    cosine, sine = np.cos(omega * time_s), np.sin(omega * time_s)
    return middle + np.exp(-decay * time_s) * (
        -middle * cosine + (rate - decay * middle) / omega * sine
    )


@pytest.mark.parametrize("rate", [0.0, 0.7])
def test_a_slider_swings_on_its_spring_to_second_order(rate):
    errors = []
    for step in (0.002, 0.001):
        found = run(oscillator(step, rate=rate))
        wrong = found.signals["slider.position_m"] - oscillation(found.time_s, rate)
        errors.append(np.abs(wrong).max())
    assert errors[1] < 2e-5
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)


def test_a_slider_neither_leaves_its_rail_nor_turns():
    found = run(oscillator(0.001)).signals
    along = np.array([math.cos(TILT), -math.sin(TILT)])
    path = planar(found, "mass") - [0.1, 0.2]
    off = path - np.outer(found["slider.position_m"], along)
    assert np.abs(off).max() < 1e-12
    assert np.abs(found["mass.rate_rad_s"]).max() < 1e-12


def test_with_its_defaults_a_slider_leaves_its_groove():
    found = run(oscillator(0.001), "default").signals
    along = np.array([math.cos(TILT), -math.sin(TILT)])
    path = planar(found, "mass") - [0.1, 0.2]
    assert np.abs(path - np.outer(path @ along, along)).max() > 1e-3


def test_substeps_are_smaller_steps():
    whole = run(oscillator(0.00025)).signals
    world = oscillator(0.001).world.model_copy(update={"substeps": 4})
    parts = run(oscillator(0.001).model_copy(update={"world": world})).signals
    for name in ("slider.position_m", "mass.velocity_m_s"):
        np.testing.assert_array_equal(parts[name], whole[name][::4])


@pytest.mark.parametrize("heavy", ["parent", "child"])
def test_what_slides_on_a_turning_body_keeps_momenta_and_energy(heavy):
    inertias = (0.03, 0.01) if heavy == "parent" else (0.01, 0.03)
    bodies = {
        "a": body(1.0, inertias[0], orientation_wxyz=turned(0.4), rate_rad_s=[0, 3, 0]),
        "b": body(0.5, inertias[1], [0.1, 0, 0.2], orientation_wxyz=turned(-1)),
    }
    slider = {"type": "slider", "parent": "a", "child": "b", "axis": [1, 0, 0.5], "rate": 0.4}
    lost = []
    for step in (0.002, 0.001):
        joints = {"slider": {**slider, "stiffness": 100}}
        found = signals(bodies, joints, step=step, gravity=0)
        energy = 50 * found["slider.position_m"] ** 2
        spin = np.zeros(len(energy))
        momentum = np.zeros((len(energy), 3))
        for (name, one), inertia in zip(bodies.items(), inertias, strict=True):
            mass, position = one["mass_kg"], found[f"{name}.position_m"]
            # where positions are: stored velocities belong to half a step later
            v, w = (_centred(found[f"{name}.{part}"]) for part in ("velocity_m_s", "rate_rad_s"))
            energy += mass / 2 * (v**2).sum(axis=1) + inertia / 2 * w[:, 1] ** 2
            spin += inertia * w[:, 1] + mass * np.cross(position, v)[:, 1]
            momentum += mass * v
        np.testing.assert_allclose(np.ptp(momentum[2:-2], axis=0), 0, atol=1e-12)
        lost.append((np.ptp(energy[2:-2]) / energy[2], np.ptp(spin[2:-2]) / abs(spin[2])))
    for coarse, fine in zip(*lost, strict=True):
        assert fine < 2e-5
        assert coarse / fine == pytest.approx(4, rel=0.2)


def _centred(stored):
    """Velocities at the instants of positions, from those half a step after and before."""
    return (stored + np.vstack((stored[:1], stored[:-1]))) / 2


# --- efforts --------------------------------------------------------------------------------------


def test_coulomb_friction_stops_a_hinge_and_holds_it():
    hinge = {"type": "hinge", "parent": "frame", "child": "disk", "axis": [0, 1, 0]}
    joint = {**hinge, "rate": 5, "friction": 0.2}
    found = run(scene({**FRAME, "disk": body()}, {"hinge": joint}))
    angle, t = found.signals["hinge.angle_rad"], found.time_s
    stop = 0.25  # I·ω/τ
    moving = t <= stop
    np.testing.assert_allclose(angle[moving], (5 * t - 10 * t**2)[moving], atol=1e-12)
    np.testing.assert_allclose(angle[~moving], 0.625, atol=1e-9)


@pytest.mark.parametrize("beside", [0.0, 0.2])
def test_coulomb_friction_stops_a_slider_and_holds_it(beside):
    """On a rail that falls by 0.5 rad: it slides up, stops, and its weight does not move it."""
    rail = {"frame": {"fixed": True, "orientation_wxyz": turned(0.5)}}
    slider = {"type": "slider", "parent": "frame", "child": "mass", "axis": [-1, 0, 0]}
    joint = {**slider, "rate": 2, "friction": 6.0}
    found = run(scene({**rail, "mass": body(at=[0, 0, beside])}, {"slider": joint}))
    position, t = found.signals["slider.position_m"], found.time_s
    slowing = G * math.sin(0.5) + 6
    moving = t <= 2 / slowing
    np.testing.assert_allclose(position[moving], (2 * t - slowing / 2 * t**2)[moving], atol=1e-9)
    np.testing.assert_allclose(position[~moving][2:], 2 / slowing, atol=1e-6)
    assert np.ptp(position[~moving][2:]) < 1e-9


def motor(**more):
    """A motor on a disk: its reflected inertia and friction, and the end of its speed."""
    return {
        "type": "dc_motor", "joint": "hinge", "input": "voltage", "resistance_Ohm": 6.0,
        "torque_constant_N_m_A": 0.0055, "gear_ratio": 48, "efficiency": 0.5,
        "rotor_friction_N_m": 1e-4, "rotor_damping_N_m_s_rad": 2e-7, "rotor_inertia_kg_m2": 1e-7,
        **more,
    }  # fmt: skip


@pytest.mark.parametrize("axis", [1, -1])
def test_a_motor_speeds_up_as_its_data_sheet_says(axis):
    hinge = {"type": "hinge", "parent": "frame", "child": "disk", "axis": [0, axis, 0]}
    more = {
        "inputs": {"voltage": {"signal": "constant", "value": 3.0}},
        "actuators": {"motor": motor()},
    }
    n, share, k, resistance = 48, 0.5, 0.0055, 6.0
    inertia = 0.001 + share * n**2 * 1e-7
    damping = share * n**2 * (k**2 / resistance + 2e-7)
    torque = share * n * (k * 3.0 / resistance - 1e-4)
    errors = []
    for step in (0.002, 0.001):
        bodies = {**FRAME, "disk": body(inertia=0.001)}
        found = run(scene(bodies, {"hinge": hinge}, step=step, **more))
        t, tau = found.time_s, inertia / damping
        truth = torque / damping * (t - tau * (1 - np.exp(-t / tau)))
        errors.append(np.abs(found.signals["hinge.angle_rad"] - truth).max())
    assert errors[1] < 1e-5
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)


def test_efforts_on_a_chain_act_on_both_bodies_of_a_joint():
    """Nothing but inner efforts: the free bodies keep their momenta."""
    bodies = {"a": body(at=[0, 0, 0]), "b": body(0.5, 0.02, [0.2, 0, 0]), "c": body(at=[0.4, 0, 0])}
    joints = {
        "hinge": {"type": "hinge", "parent": "a", "child": "b", "axis": [0, 1, 0]},
        "slider": {"type": "slider", "parent": "b", "child": "c", "axis": [1, 0, 1]},
    }
    more = {
        "inputs": {"one": {"signal": "constant", "value": 1.0}},
        "actuators": {
            "twist": {"type": "torque", "joint": "hinge", "input": "one", "gear": 0.05},
            "push": {"type": "force", "joint": "slider", "input": "one", "gear": 0.4},
        },
    }
    found = signals(bodies, joints, gravity=0, **more)
    momentum = sum(b["mass_kg"] * found[f"{n}.velocity_m_s"] for n, b in bodies.items())
    spin = sum(
        b["inertia_kg_m2"][1] * _centred(found[f"{n}.rate_rad_s"])[:, 1]
        + b["mass_kg"]
        * np.cross(found[f"{n}.position_m"], _centred(found[f"{n}.velocity_m_s"]))[:, 1]
        for n, b in bodies.items()
    )
    np.testing.assert_allclose(momentum, 0, atol=1e-12)
    assert np.abs(spin[1:]).max() < 1e-5
    assert found["slider.position_m"][-1] > 0.05
    assert found["hinge.angle_rad"][-1] > 0.1


def test_what_cannot_be_built_is_refused():
    slider = {"type": "slider", "parent": "frame", "child": "mass", "axis": [1, 0, 0]}
    with pytest.raises(Unsupported, match=r"no armature, and slider, a slider"):
        signals({**FRAME, "mass": body()}, {"slider": {**slider, "armature": 0.1}})


# --- the rest -------------------------------------------------------------------------------------


def test_a_weld_makes_one_body_of_two():
    bodies = {
        "base": body(1.0, 0.02, rate_rad_s=[0, 6, 0]),
        "mass": body(0.4, 0.001, [0.3, 0, 0.1], orientation_wxyz=turned(1)),
    }
    found = signals(
        bodies, {"bolt": {"type": "fixed", "parent": "base", "child": "mass"}}, gravity=0
    )
    between = found["mass.position_m"] - found["base.position_m"]
    length = np.linalg.norm(between, axis=1)
    np.testing.assert_allclose(length, math.hypot(0.3, 0.1), rtol=2e-5)
    spin = found["base.rate_rad_s"][:, 1]
    np.testing.assert_allclose(spin, 6, rtol=1e-4)
    np.testing.assert_allclose(found["mass.rate_rad_s"][:, 1], spin, rtol=1e-9)


@pytest.mark.parametrize("contact", ["assisted", "default"])
def test_a_state_brings_joints_back_over_turns(contact):
    hinge = {"type": "hinge", "parent": "frame", "child": "crank", "axis": [0, -1, 0], "rate": 70}
    slider = {"type": "slider", "parent": "crank", "child": "mass", "axis": [1, 0, 0]}
    joints = {
        "hinge": {**hinge, "friction": 0.01},
        "slider": {**slider, "stiffness": 3000, "damping": 1},
        "bolt": {"type": "fixed", "parent": "mass", "child": "tail"},
    }
    bodies = {
        **FRAME, "crank": body(1, 0.02), "mass": body(0.1, 0.001, [0.1, 0, 0]),
        "tail": body(0.1, 0.001, [0.1, 0, 0.05]),
    }  # fmt: skip
    simulation = engines.get("pymunk").open(scene(bodies, joints), Settings(contact))
    for _ in range(200):
        simulation.step()
    state = simulation.state
    assert state.joints["hinge"][0] > 4 * math.pi
    ends = []
    for _ in range(2):
        simulation.set_state(state)
        for name, held in simulation.state.joints.items():
            assert held == pytest.approx(state.joints[name], rel=1e-12, abs=1e-12)
        for _ in range(50):
            simulation.step()
        ends.append(simulation.state)
    assert ends[0] == ends[1]


def test_the_start_can_be_brought_back():
    simulation = engines.get("pymunk").open(oscillator(0.001), Settings())
    start, ends = simulation.state, []
    for _ in range(2):
        simulation.set_state(start)
        for _ in range(30):
            simulation.step()
        ends.append(simulation.state)
    assert ends[0] == ends[1]
    assert ends[0].joints["slider"][0] == pytest.approx(float(oscillation(0.03)), abs=1e-6)


def test_what_was_set_is_on_record():
    rows = {row.quantity: row for row in run(oscillator(0.001, friction=0.1)).audit}
    assert rows["slider.friction"].read_value == 0.1
    assert rows["slider.stiffness"].set_value == STIFFNESS
    assert rows["slider.stiffness"].read_value is None
    assert rows["joints"].read_value >= 50
    hinge = {"type": "hinge", "parent": "frame", "child": "disk", "axis": [0, 1, 0]}
    found = run(scene({**FRAME, "disk": body()}, {"hinge": {**hinge, "armature": 0.004}}))
    moment = {row.quantity: row for row in found.audit}["disk.inertia_kg_m2.2"]
    assert (moment.scenario_value, moment.read_value) == (0.01, pytest.approx(0.014))
    assert "armature" in moment.note


@pytest.mark.parametrize("contact", ["assisted", "coefficients", "default"])
@pytest.mark.parametrize("named", [True, False])
def test_moving_bodies_touch_only_where_they_are_named(contact, named):
    ball = [{"type": "sphere", "radius_m": 0.05}]
    bodies = {
        "a": body(shapes=ball, velocity_m_s=(1, 0, 0)),
        "b": body(shapes=ball, at=(0.2, 0, 0)),
    }
    contacts = [{"pair": ("a", "b")}] if named else []
    found = run(scene(bodies, {}, 0.3, contacts=contacts), contact)
    moved = found.signals["b.position_m"][-1, 0] > 0.21
    assert moved == (named or contact == "default")


@pytest.mark.parametrize(
    ("force", "what"), [(1e7, "end of its rail"), (1e200, r"slider\.velocity_m_s")]
)
def test_numbers_without_sense_are_an_error(force, what):
    slider = {"type": "slider", "parent": "frame", "child": "mass", "axis": [1, 0, 0]}
    drive = {"type": "force", "joint": "slider", "input": "push"}
    more = {
        "inputs": {"push": {"signal": "constant", "value": force}},
        "actuators": {"drive": drive},
    }
    with pytest.raises(SimulationDiverged, match=what):
        signals({**FRAME, "mass": body()}, {"slider": slider}, **more)
