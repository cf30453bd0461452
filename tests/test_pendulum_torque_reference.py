"""The driven pendulum: its reference against other integrations, laws of friction, and logs."""

import itertools
import math
import os
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare.engine.drives import laws_of
from simcompare.engine.simulation import sample_times
from simcompare.model.signals import Chirp, Constant, Ramp, Sine, SineSteps, Step, Table
from simcompare.scenarios import catalogue
from simcompare.scenarios.instants import corners_of
from simcompare.scenarios.pendulum_torque import reference as pendulum
from simcompare.scenarios.pendulum_torque.reference import Pendulum, motion

TIMES = np.arange(3001) / 500
SIGNALS = {
    "sine": Sine(signal="sine", amplitude=0.9, frequency_Hz=0.6),
    "chirp": Chirp(signal="chirp", amplitude=0.6, start_Hz=0.2, end_Hz=2, duration_s=6),
    "steps": SineSteps(
        signal="sine_steps", amplitude=0.5, frequencies_Hz=(0.3, 0.8, 2), dwell_s=1.7003
    ),
    "step": Step(signal="step", before=0.2, after=-0.4, time_s=1.23456),
    "ramp": Ramp(signal="ramp", start=-0.5, end=0.8, start_s=1.0007, end_s=3.3),
    "table": Table(
        signal="table",
        time_s=tuple(0.0131 * i + 0.003 * math.sin(i) for i in range(400)),
        value=tuple(math.cos(0.9 * i) + 0.3 * math.sin(0.1 * i) for i in range(400)),
    ),
}
FREE = Pendulum(inertia=0.15, weight=3.0, damping=0.05, friction=0.0, gain=0.9)


def integrated(body, start, times, signal):
    """DOP853 from corner to corner of the signal, for a pendulum without Coulomb friction."""
    corners = np.concatenate(([0.0], corners_of(signal), [times[-1]]))
    corners = np.unique(np.clip(corners, 0, times[-1]))
    found = np.empty((2, len(times)))
    state = np.array(start)
    for begin, end in itertools.pairwise(corners):

        def change(t, y, end=end):
            # just before the corner, so that a jump there is not yet seen
            given = signal.at(np.array([min(t, end - 1e-8)]))[0]
            drive = body.gain * given - body.weight * math.sin(y[0]) - body.damping * y[1]
            return [y[1], drive / body.inertia]

        solved = solve_ivp(
            change, (begin, end), state, "DOP853", dense_output=True, rtol=1e-13, atol=1e-13,
            max_step=0.02,
        )  # fmt: skip
        inside = (times >= begin) & (times <= end)
        found[:, inside] = solved.sol(times[inside])
        state = solved.y[:, -1]
    return found


@pytest.mark.parametrize("name", SIGNALS)
def test_agrees_with_an_integration_of_eighth_order(name):
    angle, rate = motion(FREE, (0.3, -0.2), TIMES, SIGNALS[name])
    expected = integrated(FREE, (0.3, -0.2), TIMES, SIGNALS[name])
    np.testing.assert_allclose(angle, expected[0], rtol=0, atol=1e-9)
    np.testing.assert_allclose(rate, expected[1], rtol=0, atol=1e-8)


@pytest.mark.parametrize("name", ["sine", "step", "table"])
def test_the_samples_asked_for_do_not_change_the_motion(name):
    body = Pendulum(0.15, 3.0, 0.02, 0.13)
    dense = motion(body, (0.3, 0.0), TIMES, SIGNALS[name])[0]
    coarse = motion(body, (0.3, 0.0), TIMES[::50], SIGNALS[name])[0]
    late = motion(body, (0.3, 0.0), TIMES[1777:], SIGNALS[name])[0]
    np.testing.assert_allclose(coarse, dense[::50], rtol=0, atol=2e-8)
    np.testing.assert_allclose(late, dense[1777:], rtol=0, atol=2e-8)


def test_friction_agrees_with_an_integration_between_turns():
    # strong enough a drive that it never rests: the sign of the friction changes at each turn
    body = Pendulum(0.15, 3.0, 0.02, 0.13)
    signal = Sine(signal="sine", amplitude=1.5, frequency_Hz=0.9, phase_rad=math.pi / 2)
    way, state, begin, turns = 1.0, np.array([0.0, 0.0]), 0.0, 0
    expected = np.empty(len(TIMES))
    while begin < TIMES[-1]:

        def change(t, y, way=way):
            given = 1.5 * math.cos(2 * math.pi * 0.9 * t)
            drive = given - 3.0 * math.sin(y[0]) - 0.02 * y[1] - 0.13 * way
            return [y[1], drive / 0.15]

        def turn(t, y):
            return y[1]

        turn.terminal, turn.direction = True, -way
        solved = solve_ivp(
            change, (begin, TIMES[-1]), state, "DOP853", dense_output=True, rtol=1e-13,
            atol=1e-13, max_step=0.01, events=turn,
        )  # fmt: skip
        end = solved.t[-1]
        inside = (begin <= TIMES) & (end >= TIMES)
        expected[inside] = solved.sol(TIMES[inside])[0]
        begin, state, way, turns = end, np.array([solved.y[0, -1], 0.0]), -way, turns + 1
    assert turns > 8
    angle = motion(body, (0.0, 0.0), TIMES, signal)[0]
    np.testing.assert_allclose(angle, expected, rtol=0, atol=2e-8)


def test_it_stays_exactly_where_friction_holds_it():
    body = Pendulum(0.15, 3.0, 0.02, 0.2)
    signal = Sine(signal="sine", amplitude=0.199, frequency_Hz=0.7)
    angle, rate = motion(body, (0.0, 0.0), TIMES, signal)
    assert not angle.any()
    assert not rate.any()
    angle, rate = motion(
        body, (0.0, 0.0), TIMES, Sine(signal="sine", amplitude=0.201, frequency_Hz=0.7)
    )
    assert angle.any()


def test_it_sets_off_when_the_drive_exceeds_the_friction():
    body = Pendulum(0.15, 3.0, 0.0, 0.2)
    ramp = Ramp(signal="ramp", start=0.0, end=1.0, start_s=0.0, end_s=1.0)
    times = np.linspace(0, 0.25, 100_001)
    angle, _ = motion(body, (0.0, 0.0), times, ramp)
    assert not angle[times < 0.2 - 1e-9].any()
    # J·θ̈ = slope·t at first, so θ = slope·t³/(6·J)
    t = times[times > 0.2] - 0.2
    short = t < 0.01
    np.testing.assert_allclose(
        angle[times > 0.2][short], t[short] ** 3 / (6 * 0.15), rtol=2e-4, atol=1e-14
    )


def test_it_comes_to_rest_where_friction_can_hold_it():
    body = Pendulum(0.15, 3.0, 0.05, 0.2)
    angle, rate = motion(body, (1.0, 0.0), TIMES, Constant(signal="constant", value=0.5))
    assert rate[-1] == 0
    assert np.ptp(angle[-500:]) == 0
    assert abs(0.5 - 3.0 * math.sin(angle[-1])) <= 0.2


def test_each_half_swing_on_a_spring_loses_twice_the_friction_over_the_stiffness():
    # without weight the equation is linear between the turns (Den Hartog 1930)
    body = Pendulum(0.01, 0.0, 0.0, 0.05, stiffness=1.0)
    half = math.pi * math.sqrt(0.01)
    times = half * np.array([1, 2, 3, 4, 5.5])
    angle, rate = motion(body, (0.47, 0.0), times, Constant(signal="constant", value=0.0))
    np.testing.assert_allclose(angle[:4], [-0.37, 0.27, -0.17, 0.07], rtol=0, atol=1e-9)
    # from 0.07 the spring still overcomes the friction; at 0.03 on the same side it does not
    assert angle[4] == pytest.approx(0.03, abs=1e-9)
    assert rate[4] == 0


def test_the_energy_is_what_drive_and_friction_made_of_it():
    body = Pendulum(0.15, 3.0, 0.05, 0.13)
    signal = Sine(signal="sine", amplitude=0.8, frequency_Hz=0.6)
    times = np.arange(60_001) / 1e4
    angle, rate = motion(body, (0.2, 0.0), times, signal)
    energy = 0.075 * rate**2 + 3.0 * (1 - np.cos(angle))
    power = signal.at(times) * rate - 0.05 * rate**2 - 0.13 * np.abs(rate)
    work = np.concatenate(([0.0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(times))))
    np.testing.assert_allclose(energy - energy[0], work, atol=2e-7)


def test_the_scene_is_the_pendulum_of_the_reference():
    scene = catalogue.load("pendulum_torque").resolve({"start_angle_rad": 0.4, "zero_rad": 0.1})
    law, rod = laws_of(scene)["hinge"], scene.bodies["rod"]
    p = scene.parameters
    assert law.gains == {"torque": 1.0}
    assert (law.damping, law.friction, law.armature) == (0.02, 0.13, 0.0022)
    assert law.stiffness == 0
    assert math.hypot(*rod.position_m) == pytest.approx(p["length_m"])
    # 0.3 rad from hanging, about +y: the rod's lower end is at -x
    assert math.atan2(-rod.position_m[0], -rod.position_m[2]) == pytest.approx(0.3)
    times = sample_times(scene)
    found = pendulum.reference(p, times, scene.inputs)
    inertia = p["mass_kg"] * p["length_m"] ** 2 + 0.0098 + 0.0022
    body = Pendulum(inertia, p["mass_kg"] * p["length_m"] * p["gravity_m_s2"], 0.02, 0.13)
    angle, rate = motion(body, (0.3, 0.0), times, scene.inputs["torque"])
    np.testing.assert_allclose(found["hinge.angle_rad"], angle - 0.3, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found["hinge.rate_rad_s"], rate, rtol=0, atol=1e-12)


# --- logs of a real one -------------------------------------------------------------------------

#: what least squares made of the first 3.5 s of the log "sac"
FITTED = {
    "mass_kg": 0.676, "length_m": 0.452, "inertia_kg_m2": 0.0131, "rotor_inertia_kg_m2": 0.0022,
    "damping_N_m_s_rad": 0.0104, "friction_N_m": 0.1337, "torque_scale": 0.8384,
    "gravity_m_s2": 9.80665, "start_rate_rad_s": 0.0,
}  # fmt: skip


def log_of(name):
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder:
        pytest.skip("SIMCOMPARE_DATA does not name a folder with the recordings")
    path = Path(folder) / "pendulum_actuated" / f"control_method_{name}" / "data_measured.csv"
    if not path.is_file():
        pytest.skip(f"{path} is not here")
    return np.loadtxt(path, delimiter=",", skiprows=1)


def missed(log, end_s, zero_rad):
    """Root mean square of the replayed angle minus the measured one until a time [rad]."""
    part = log[log[:, 0] <= end_s]
    start = part[0, 1]
    given = Table(signal="table", time_s=tuple(part[:, 0]), value=tuple(part[:, 3]))
    parameters = {**FITTED, "zero_rad": zero_rad, "start_angle_rad": start}
    found = pendulum.reference(parameters, part[:, 0], {"torque": given})["hinge.angle_rad"]
    return float(np.sqrt(np.mean((found + start - part[:, 1]) ** 2)))


def test_a_swing_up_is_replayed_until_it_stands_upright():
    log = log_of("sac")
    assert missed(log, 3.5, -0.012) < 0.0035
    # upright, errors grow by e^(4.4·t): nothing open-loop can be said after that
    assert missed(log, 5.0, -0.012) > 20 * missed(log, 3.5, -0.012)


def test_parameters_of_one_log_predict_another_until_it_is_pushed():
    log = log_of("ilqr")
    assert missed(log, 2.9, 0.0) < 0.006
    rate = np.gradient(log[:, 2], log[:, 0])
    pushed = (log[:, 0] > 2.93) & (log[:, 0] < 3.05)
    # all that gravity and the reported torque could give is 25 rad/s²
    possible = (3.0 + 0.84 * np.abs(log[pushed, 3]).max()) / 0.1534
    assert possible < 25
    assert rate[pushed].min() > 1.5 * possible
