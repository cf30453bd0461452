"""Truths of sensors at rest and in motion, what is derived from logs for them, and real logs."""

import itertools
import math
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from simcompare.engine import engines
from simcompare.engine.simulation import sample_times
from simcompare.errors import InputError
from simcompare.hardware.conditioning import derived_channels
from simcompare.model.settings import Settings
from simcompare.model.signals import Constant, Sine, Step, Table
from simcompare.scenarios import catalogue
from simcompare.scenarios.imu_motion import reference as motion
from simcompare.scenarios.imu_rest import reference as rest
from simcompare.scenarios.linear_response import Pieces

AXES = ("x", "y", "z", "yaw", "pitch", "roll")


def scene(name, **changes):
    return catalogue.load(name).resolve(changes)


def data(path):
    """A real log, or a skip with the reason."""
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder or not (Path(folder) / path).is_file():
        pytest.skip(f"SIMCOMPARE_DATA names no folder with {path}")
    return Path(folder) / path


# --- at rest --------------------------------------------------------------------------------------


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(1, 20))
def test_at_rest_g_upwards_is_turned_into_the_sensor(roll, pitch, gravity):
    parameters = {**scene("imu_rest").parameters, "roll_rad": roll, "pitch_rad": pitch}
    parameters["gravity_m_s2"] = gravity
    truth = rest.reference(parameters, np.array([0.0, 0.5]))
    turned = Rotation.from_euler("y", pitch) * Rotation.from_euler("x", roll)
    expected = turned.inv().apply((0, 0, gravity))
    np.testing.assert_allclose(
        truth["accelerometer.specific_force_m_s2"], [expected] * 2, atol=1e-12 * gravity
    )
    assert not truth["gyroscope.rate_rad_s"].any()
    assert np.linalg.norm(expected) == pytest.approx(gravity, rel=1e-12)


def test_the_sensor_is_drawn_as_the_truth_turns_it():
    scenario = scene("imu_rest", roll_rad=0.4, pitch_rad=-0.9)
    w, x, y, z = scenario.sensors["accelerometer"].orientation_wxyz
    drawn = Rotation.from_quat((x, y, z, w))
    expected = drawn.inv().apply((0, 0, 9.80665))
    found = rest.specific_force_m_s2(scenario.parameters)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_errors_of_a_sensor_are_added_by_the_probes():
    scenario = scene("imu_rest", offset_x_m_s2=0.1, rate_offset_z_rad_s=0.01, offset_size_m_s2=-0.2)
    assert scenario.probes["forward_m_s2"].offset == 0.1
    assert scenario.probes["rate_z_rad_s"].offset == 0.01
    assert scenario.probes["magnitude_m_s2"].offset == -0.2


# --- in motion ------------------------------------------------------------------------------------


def apart(time_s, parameters, signals):
    """Independent: the carriage in its rings as free bodies with torques in the hinges, DOP853.

    State: six coordinates and their rates. Angular momenta of the bodies, each the same about every
    axis, change by the torques of springs and dampers; accelerations of the rings follow from
    requiring that the torque along each hinge is what its servo gives (Kane's equations).
    """
    omega, zeta = 2 * math.pi * parameters["bandwidth_Hz"], parameters["damping_ratio"]
    moments = (4.0, 2.0, 1.0)
    felt = (7.0, 3.0, 1.0)

    def axes_of(q):
        yaw, pitch = Rotation.from_euler("z", q[3]), Rotation.from_euler("y", q[4])
        return np.array([[0, 0, 1], yaw.apply((0, 1, 0)), (yaw * pitch).apply((1, 0, 0))])

    def change(t, state):
        q, v = state[:6], state[6:]
        goals = np.array([float(signals[f"{n}_goal"].at(np.array([t]))[0]) for n in AXES])
        wanted = omega**2 * (goals - q) - 2 * zeta * omega * v
        axes = axes_of(q)
        rates = np.cumsum(v[3:, None] * axes, axis=0)
        # each hinge axis is carried by the body before it
        carried = np.cross(np.vstack((np.zeros(3), rates[:-1])), axes)
        known = np.cumsum(v[3:, None] * carried, axis=0)
        matrix, right = np.zeros((3, 3)), np.zeros(3)
        for i in range(3):
            right[i] = felt[i] * wanted[3 + i]
            for body in range(i, 3):
                right[i] -= moments[body] * known[body] @ axes[i]
                for j in range(body + 1):
                    matrix[i, j] += moments[body] * axes[j] @ axes[i]
        return np.concatenate((v, wanted[:3], np.linalg.solve(matrix, right)))

    names = {"x": "m", "y": "m", "z": "m", "yaw": "rad", "pitch": "rad", "roll": "rad"}
    state = np.array([parameters[f"start_{n}_{u}"] for n, u in names.items()] + [0.0] * 6)
    corners = [0.0, float(time_s[-1])]
    corners += [t for s in signals.values() if isinstance(s, Table) for t in s.time_s]
    corners = sorted(t for t in set(corners) if 0 <= t <= time_s[-1])
    found = [state]
    for start, stop in itertools.pairwise(corners):
        inside = time_s[(time_s > start) & (time_s <= stop)]
        run = solve_ivp(
            change, (start, stop), state, "DOP853", rtol=1e-12, atol=1e-13,
            t_eval=np.union1d(inside, [stop]),
        )  # fmt: skip
        state = run.y[:, -1]
        found += [run.y[:, i] for i, t in enumerate(run.t) if t in inside]
    states = np.array(found)
    accelerations = [change(t, s)[6:] for t, s in zip(time_s, states, strict=True)]
    return states, np.array(accelerations)


def felt_by(states, accelerations, parameters):
    """Specific force and rate of a sensor, by rotation matrices and differences of rotations."""
    lever = np.array([parameters[f"lever_{a}_m"] for a in "xyz"])
    forces, rates = [], []
    for state, acceleration in zip(states, accelerations, strict=True):

        def turned(dt, state=state, acceleration=acceleration):
            angles = state[3:6] + dt * state[9:] + dt**2 / 2 * acceleration[3:]
            return Rotation.from_euler("ZYX", angles)

        h = 1e-3
        here = turned(0.0)
        # eighth-order differences of the lever's end, as seen from outside
        second = (-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560)
        ends = np.array([turned(k * h).apply(lever) for k in range(-4, 5)])
        arm = np.array(second) @ ends / h**2
        outside = acceleration[:3] + np.array((0, 0, parameters["gravity_m_s2"])) + arm
        forces.append(here.inv().apply(outside))
        first = (1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280)
        slope = np.tensordot(first, [turned(k * h).as_matrix() for k in range(-4, 5)], 1) / h
        spin = here.as_matrix().T @ slope
        rates.append((spin[2, 1], spin[0, 2], spin[1, 0]))
    return np.array(forces), np.array(rates)


TURNED = {
    "start_x_m": 0.3, "start_z_m": 1.5, "start_yaw_rad": 0.7, "start_pitch_rad": -0.4,
    "start_roll_rad": 2.5, "lever_x_m": 0.05, "lever_y_m": -0.03, "lever_z_m": 0.08,
    "bandwidth_Hz": 10,
}  # fmt: skip


def violent(start):
    """Goals that turn the rings quickly, away from where they start."""
    made = {}
    for i, name in enumerate(AXES):
        amplitude = 0.1 if i < 3 else 0.6
        made[f"{name}_goal"] = Sine(
            signal="sine", amplitude=amplitude, frequency_Hz=1 + 0.3 * i, phase_rad=-math.pi / 2,
            offset=amplitude + start.get(name, 0.0),
        )  # fmt: skip
    return made


@pytest.mark.parametrize("kind", ["sines", "tables"])
def test_agrees_with_bodies_that_turn_in_their_hinges(kind):
    parameters = {**scene("imu_motion").parameters, **TURNED}
    start = {"x": 0.3, "z": 1.5, "yaw": 0.7, "pitch": -0.4, "roll": 2.5}
    signals = violent(start)
    time_s = np.linspace(0, 0.8, 17)
    if kind == "tables":
        nodes = np.linspace(0, 0.9, 31)
        signals = {
            n: Table(signal="table", time_s=tuple(nodes), value=tuple(s.at(nodes)))
            for n, s in signals.items()
        }
    truth = motion.reference(parameters, time_s, signals)
    states, accelerations = apart(time_s, parameters, signals)
    for i, name in enumerate(AXES):
        part, unit = ("position_m", "m") if i < 3 else ("angle_rad", "rad")
        np.testing.assert_allclose(
            truth[f"{name}.{part}"], states[:, i] - parameters[f"start_{name}_{unit}"],
            atol=1e-9, err_msg=name,
        )  # fmt: skip
    forces, rates = felt_by(states, accelerations, parameters)
    np.testing.assert_allclose(truth["gyroscope.rate_rad_s"], rates, atol=1e-8)
    np.testing.assert_allclose(truth["accelerometer.specific_force_m_s2"], forces, atol=1e-6)
    turned = Rotation.from_euler("ZYX", states[:, 3:6]).as_matrix()
    w, x, y, z = truth["carriage.orientation_wxyz"].T
    found = Rotation.from_quat(np.column_stack((x, y, z, w))).as_matrix()
    np.testing.assert_allclose(found, turned, atol=1e-9)


def test_bodies_are_drawn_as_they_start():
    scenario = scene("imu_motion", **TURNED)
    w, x, y, z = scenario.bodies["carriage"].orientation_wxyz
    drawn = Rotation.from_quat((x, y, z, w)).as_matrix()
    np.testing.assert_allclose(drawn, Rotation.from_euler("ZYX", (0.7, -0.4, 2.5)).as_matrix())
    truth = motion.reference(
        scenario.parameters, np.array([0.0, 0.1]), violent({"x": 0.3, "z": 1.5})
    )
    np.testing.assert_allclose(truth["carriage.position_m"][0], (0.3, 0, 1.5), atol=1e-14)


def test_every_servo_carries_what_the_truth_says_that_it_carries():
    scenario = scene("imu_motion")
    omega = 2 * math.pi * scenario.parameters["bandwidth_Hz"]
    names = list(AXES)
    for i, name in enumerate(names):
        joint = scenario.joints[name]
        bodies = [scenario.bodies[scenario.joints[n].child] for n in names[i:]]
        if i < 3:
            carried = sum(body.mass_kg for body in bodies)
        else:
            carried = sum(body.inertia_kg_m2[0] for body in bodies)
        assert joint.stiffness == pytest.approx(carried * omega**2, rel=1e-12)
        assert joint.damping == pytest.approx(carried * math.sqrt(2) * omega, rel=1e-9)
        assert scenario.actuators[f"{name}_servo"].gear == pytest.approx(joint.stiffness)
    yaw, pitch, roll = (
        scenario.bodies[b].inertia_kg_m2[0] for b in ("ring_yaw", "ring_pitch", "carriage")
    )
    assert (yaw / roll, pitch / roll) == (motion.I_1, motion.I_2)


def test_servos_hardly_change_a_motion_of_an_eighth_of_their_bandwidth_but_delay_it():
    parameters = {**scene("imu_motion").parameters, "duration_s": 1.0}
    goals = {f"{n}_goal": Constant(signal="constant", value=0.0) for n in AXES}
    goals["x_goal"] = Sine(signal="sine", amplitude=0.01, frequency_Hz=5)
    time_s = np.linspace(0.4, 1.0, 1201)
    place = motion.reference(parameters, np.append(0, time_s), goals)["x.position_m"][1:]
    turn = 2 * math.pi * 5 * time_s
    design = np.column_stack((np.sin(turn), np.cos(turn)))
    sine, cosine = np.linalg.lstsq(design, place, rcond=None)[0]
    assert math.hypot(sine, cosine) == pytest.approx(0.01, rel=2e-4)
    assert math.atan2(-cosine, sine) / (2 * math.pi * 5) == pytest.approx(0.0056, abs=1e-4)


def test_a_pitch_over_the_zenith_is_refused():
    parameters = scene("imu_motion").parameters
    goals = {f"{n}_goal": Constant(signal="constant", value=0.0) for n in AXES}
    goals["pitch_goal"] = Step(signal="step", after=80.0, time_s=0.05)
    goals["roll_goal"] = Step(signal="step", after=1e5, time_s=0.05)
    with pytest.raises(InputError, match="yaw and roll cannot follow"):
        motion.reference(parameters, np.linspace(0, 1, 11), goals)


@pytest.mark.parametrize("engine", ["mujoco", "pybullet", "dart"])
def test_engines_carry_the_sensors_as_the_truth_does(engine):
    scenario = scene("imu_motion", lever_x_m=0.05, lever_z_m=-0.1, duration_s=1)
    run = engines.get(engine).simulate(scenario, Settings(contact="assisted"))
    truth = motion.reference(scenario.parameters, run.time_s, scenario.inputs)
    later = run.time_s > 0.1  # differences of samples round the start of the servos off
    for name, limit in (
        ("accelerometer.specific_force_m_s2", 5e-3),
        ("gyroscope.rate_rad_s", 5e-4),
    ):
        off = np.abs(run.signals[name] - truth[name])[later]
        assert off.max() < limit
    assert np.abs(run.signals["roll.angle_rad"] - truth["roll.angle_rad"]).max() < 1e-5


# --- linear systems, piece by piece ---------------------------------------------------------------


def test_an_oscillator_answers_a_straight_line_in_closed_form():
    omega, zeta = 30.0, 0.2
    edges = np.sort(np.append(np.linspace(0, 0.5, 12), 0.123))
    pieces = Pieces(edges)
    # y = t is the answer to 2ζω + ω²·t; a free oscillation is added by the start
    push = 2 * zeta * omega + omega**2 * pieces.inside
    inside, (place, rate) = pieces.driven(push, omega, zeta, (0.3, 1.0))
    fast = omega * math.sqrt(1 - zeta**2)
    fading = 0.3 * np.exp(-zeta * omega * edges)
    free = fading * (np.cos(fast * edges) + zeta * omega / fast * np.sin(fast * edges))
    np.testing.assert_allclose(place, edges + free, atol=1e-12)
    slope = -fading * omega**2 / fast * np.sin(fast * edges)
    np.testing.assert_allclose(rate, 1 + slope, atol=1e-11)
    assert inside[0].shape == pieces.inside.shape


# --- real logs ------------------------------------------------------------------------------------


def test_a_real_sensor_at_rest_reads_seven_milli_g_less_than_g():
    log = np.genfromtxt(data("imu_xio/sensor_data.csv"), delimiter=",", skip_header=1)
    still = log[log[:, 0] < 5, 4:7]
    assert np.linalg.norm(still.mean(axis=0)) == pytest.approx(0.9935, abs=5e-5)


@pytest.mark.parametrize(
    ("name", "start_s", "force", "rate"),
    [
        ("11_undisturbed_slow_translation_B", 31.0, 0.06, 0.025),
        ("02_undisturbed_slow_rotation_B", 39.0, 0.055, 0.025),
    ],
    ids=["translation", "rotation"],
)
def test_a_replayed_motion_tells_what_the_real_sensor_read(name, start_s, force, rate):
    import h5py

    with h5py.File(data(f"imu_broad/{name}.hdf5")) as log:
        rate_Hz = float(log.attrs["sampling_rate"])
        read = {k: np.array(log[k]) for k in ("imu_acc", "imu_gyr", "opt_pos", "opt_quat")}
    time_s = np.arange(len(read["imu_acc"])) / rate_Hz - start_s

    def slow(values):
        return derived_channels.low_pass(values, rate_Hz, 5)

    goals = dict(
        zip(
            ("yaw", "pitch", "roll"), derived_channels.yaw_pitch_roll(read["opt_quat"]), strict=True
        )
    )
    goals |= {axis: read["opt_pos"][:, i] for i, axis in enumerate("xyz")}
    goals = {name: slow(values) for name, values in goals.items()}
    window = (time_s > -0.1) & (time_s < 20.1)
    inputs = {
        f"{n}_goal": Table(signal="table", time_s=tuple(time_s[window]), value=tuple(v[window]))
        for n, v in goals.items()
    }
    start = {
        f"start_{n}_{'m' if n in 'xyz' else 'rad'}": float(np.interp(0, time_s, v))
        for n, v in goals.items()
    }
    lever = {"lever_x_m": 0.0025, "lever_y_m": -0.002, "lever_z_m": 0.008}
    scenario = scene("imu_motion", **start, **lever, gravity_m_s2=9.8128, duration_s=20.0)
    truth = motion.reference(scenario.parameters, sample_times(scenario), inputs)
    judged = (time_s > 0.5) & (time_s < 19.5)
    for signal, column, limit in (
        ("accelerometer.specific_force_m_s2", "imu_acc", force),
        ("gyroscope.rate_rad_s", "imu_gyr", rate),
    ):
        for i in range(3):
            # the servos are 5.6 ms late, and the sensor is by a sample behind the cameras
            told = np.interp(time_s[judged] + 0.0021, sample_times(scenario), truth[signal][:, i])
            assert np.std(slow(read[column][:, i])[judged] - told) < limit
