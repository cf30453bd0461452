"""The extended filter: its derivatives, and its consistency on a truth that it knows."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from simcompare.errors import InputError
from simcompare.estimation import consistency, estimators, pose_model, timing
from simcompare.estimation.estimate import Given, Signal
from simcompare.estimation.pose_model import (
    HEADING,
    LEFT,
    LEFT_MOTOR,
    PUSH,
    RATE,
    RIGHT,
    RIGHT_MOTOR,
    SPEED,
    TURN,
    Ranger,
    Robot,
    X,
)  # fmt: skip
from simcompare.statistics.streams import stream

#: the robot of the catalogue: η·N·k/(R·r) and η·N²·(k²/R + b)/r² of one motor
ROBOT = Robot(0.0325, 0.12, 0.782691, 2.5e-3, 0.4738, 4.00178, 0.5, 0.0108, 0.1, 10.0)
STATES = [
    np.array([0.3, -0.2, 0.7, 0.15, -0.9, 0.2, -1.0, 0.1, 0.2, 0.05, -0.1]),
    np.array([0.0, 0.0, -2.9, -0.3, 2.0, -0.5, 3.0, -0.1, 0.3, -0.02, 0.1]),
    np.array([1.0, 2.0, 0.1, 0.4, *7 * [0.0]]),
]


def differences(function, state, size):
    """Central differences; each step is small beside the state and large beside rounding."""
    columns = []
    for i in range(pose_model.STATES):
        step = np.zeros(pose_model.STATES)
        step[i] = 1e-6
        high, low = (np.atleast_1d(function(state + sign * step)) for sign in (1, -1))
        columns.append((high - low) / 2e-6)
    return np.array(columns).T.reshape(size, pose_model.STATES)


#: rounding 1e-16 over a step of 1e-6, and its square times third derivatives of up to 100
CLOSE = {"abs": 2e-8, "rel": 1e-7}


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("step_s", [0.001, 0.128])
def test_the_motion_is_differentiated_rightly(state, step_s):
    found = pose_model.move(ROBOT, state, step_s, 1.0, 2.5).transition
    by_steps = differences(
        lambda one: pose_model.move(ROBOT, one, step_s, 1.0, 2.5).mean, state, 11
    )
    assert found == pytest.approx(by_steps, **CLOSE)


def test_the_motion_begins_as_the_equations_say():
    state = STATES[0]
    theta, v, w = state[HEADING], state[SPEED], state[RATE]
    step_s = 1e-7
    rows = (pose_model.move(ROBOT, state, step_s, 1.0, 2.5).transition - np.eye(11)) / step_s
    back = ROBOT.load_behind_kg_m / ROBOT.inertia_kg
    turned = ROBOT.load_behind_kg_m / ROBOT.turning_inertia_kg_m2
    known = np.zeros((11, 11))
    known[0, 2], known[0, 3] = -v * math.sin(theta), math.cos(theta)
    known[1, 2], known[1, 3] = v * math.cos(theta), math.sin(theta)
    known[2, 4] = 1.0
    known[3, 3] = -2 * ROBOT.damping_N_s_m / ROBOT.inertia_kg
    known[3, 4], known[3, PUSH] = -2 * back * w, 1.0
    known[4, 4] = -ROBOT.damping_N_s_m * ROBOT.track_m**2 / (2 * ROBOT.turning_inertia_kg_m2)
    known[4, 4] += turned * v
    known[4, 3], known[4, TURN] = turned * w, 1.0
    for motor, sign, given in ((LEFT_MOTOR, -1, 1.0), (RIGHT_MOTOR, 1, 2.5)):
        force = ROBOT.drive * given - ROBOT.damping_N_s_m * (v + sign * 0.06 * w)
        known[3:5, motor] = force / ROBOT.inertia_kg, sign * 0.06 * force / 2.5e-3
        slowed = state[motor] * ROBOT.damping_N_s_m
        known[3, [3, 4]] -= slowed / ROBOT.inertia_kg * np.array([1, sign * 0.06])
        known[4, [3, 4]] -= sign * 0.06 * slowed / 2.5e-3 * np.array([1, sign * 0.06])
    known[LEFT, [3, 4]], known[RIGHT, [3, 4]] = (1.0, -0.06), (1.0, 0.06)
    # λ²·T/2 of the exponential, T = 1e-7 and λ = 12/s, and rounding 1e-16/T
    assert rows == pytest.approx(known, abs=2e-5)


@pytest.mark.parametrize("state", STATES)
def test_what_wheels_and_accelerometer_read_is_differentiated_rightly(state):
    _, found = pose_model.wheel_rates(ROBOT, state)
    by_steps = differences(lambda one: pose_model.wheel_rates(ROBOT, one)[0], state, 2)
    assert found == pytest.approx(by_steps, **CLOSE)
    _, found = pose_model.accelerations(ROBOT, state, 1.0, 2.5)
    by_steps = differences(lambda one: pose_model.accelerations(ROBOT, one, 1.0, 2.5)[0], state, 2)
    assert found == pytest.approx(by_steps, **CLOSE)


@pytest.mark.parametrize("state", STATES)
def test_ranges_are_differentiated_rightly(state):
    ranger, beacon = Ranger(0.05, -0.02, 0.4, 0.3), np.array([2.3, 0.1])
    _, found = pose_model.range_to_beacon(ranger, state, beacon)
    by_steps = differences(lambda one: pose_model.range_to_beacon(ranger, one, beacon)[0], state, 1)
    assert found[None] == pytest.approx(by_steps, **CLOSE)
    _, found = pose_model.range_to_wall(ranger, state, 0.2, 3.0)
    by_steps = differences(lambda one: pose_model.range_to_wall(ranger, one, 0.2, 3.0)[0], state, 1)
    assert found[None] == pytest.approx(by_steps, **CLOSE)


def test_a_range_to_a_wall_is_how_far_the_beam_goes():
    state = np.array([0.5, *10 * [0.0]])
    found, _ = pose_model.range_to_wall(Ranger(0.1, 0.0, math.pi / 3), state, 0.0, 1.0)
    assert found == pytest.approx(0.4 / math.cos(math.pi / 3))


def test_a_zone_tells_how_far_the_wall_is_along_the_axis_of_its_sensor():
    """D·cos ψ/(cos ψ + tan az·sin ψ), the wall at D along the axis, which is turned by -ψ."""
    turned, zone = 0.3, math.radians(2.8125)
    state = np.array([0.0, 0.0, -turned, *8 * [0.0]])
    found, _ = pose_model.range_to_wall(Ranger(zone_rad=zone), state, 0.0, 1.0)
    along = 1.0 / math.cos(turned)
    known = along * math.cos(turned) / (math.cos(turned) + math.tan(zone) * math.sin(turned))
    assert found == pytest.approx(known, rel=1e-12)
    across, _ = pose_model.range_to_wall(Ranger(zone_rad=zone), np.zeros(11), 0.0, 1.0)
    assert across == pytest.approx(1.0, rel=1e-12)


def test_a_motor_speeds_a_robot_up_as_its_closed_form_says():
    state = np.zeros(11)
    for _ in range(50):
        state = pose_model.move(ROBOT, state, 0.01, 2.0, 2.0).mean
    push = (2 * 2 * ROBOT.drive - ROBOT.friction_N) / ROBOT.inertia_kg
    closed = push / ROBOT.decay_1_s * -math.expm1(-ROBOT.decay_1_s * 0.5)
    assert state[SPEED] == pytest.approx(closed, rel=1e-12)


def test_a_measured_current_drives_the_robot_as_its_voltage_does():
    """The same motor with its back-EMF in the damping, or in the current already."""
    share, ratio, k, resistance, rotor, radius = 0.35, 48, 0.0055, 6.0, 2e-7, 0.0325
    by_voltage = Robot(
        radius, 0.12, 0.78, 2.5e-3, share * ratio * k / (resistance * radius),
        share * ratio**2 * (k**2 / resistance + rotor) / radius**2, 0.5,
    )  # fmt: skip
    by_current = Robot(
        radius, 0.12, 0.78, 2.5e-3, share * ratio * k / radius,
        share * ratio**2 * rotor / radius**2, 0.5,
    )  # fmt: skip
    speed, voltage = 0.12, 2.0
    current = (voltage - k * ratio * speed / radius) / resistance
    told = [
        robot.push_m_s2(speed, given, given) - robot.decay_1_s * speed
        for robot, given in ((by_voltage, voltage), (by_current, current))
    ]
    assert told[0] == pytest.approx(told[1], rel=1e-12)


def test_the_filter_takes_currents_in_place_of_voltages():
    given = driven(0)
    names = {"left_voltage": "left_current", "right_voltage": "right_current"}
    signals = {names.get(role, role): one for role, one in given.signals.items()}
    options = {**OPTIONS, "drive_N_A": ROBOT.drive, "current_damping_N_s_m": ROBOT.damping_N_s_m}
    estimator = estimators.load("pose_filter")
    by_current = estimators.apply(estimator, Given(signals, given.truth, options))
    by_voltage = estimators.apply(estimator, given)
    # a current that drives and brakes as the voltage does is the same motor
    for state, one in by_voltage.best.states.items():
        assert np.array_equal(by_current.best.states[state].values, one.values)


#: along the heading: way, speed and what the motors do not explain
FORWARD = np.ix_((X, SPEED, PUSH), (X, SPEED, PUSH))


def test_damping_is_in_the_noise_of_the_motion():
    """Against van Loan's exponential of a block matrix, at λ = 6.7/s and 50 ms."""
    robot = Robot(0.0325, 0.12, 1.0, 1.0, damping_N_s_m=3.35, jerk_density_m2_s5=0.1)
    state = np.array([0.0, 0.0, 0.0, 0.1, *7 * [0.0]])
    found = pose_model.move(robot, state, 0.05, 0.0, 0.0).noise[FORWARD]
    drift = np.array([[0.0, 1.0, 0.0], [0.0, -6.7, 1.0], [0.0, 0.0, 0.0]])
    block = expm(0.05 * np.block([[-drift, np.diag([0, 0, 0.1])], [np.zeros((3, 3)), drift.T]]))
    assert found == pytest.approx(block[3:, 3:].T @ block[:3, 3:], rel=1e-9)


def test_without_damping_the_noise_is_the_textbooks():
    robot = Robot(0.0325, 0.12, jerk_density_m2_s5=0.1)
    t = 0.05
    found = pose_model.move(robot, np.zeros(11), t, 0.0, 0.0).noise[FORWARD]
    known = [
        [t**5 / 20, t**4 / 8, t**3 / 6], [t**4 / 8, t**3 / 3, t**2 / 2], [t**3 / 6, t**2 / 2, t]
    ]  # fmt: skip
    assert found == pytest.approx(0.1 * np.array(known), rel=1e-12)


def test_friction_alone_moves_nothing():
    state = pose_model.move(ROBOT, np.zeros(11), 0.01, 0.2, 0.2).mean
    assert state == pytest.approx(np.zeros(11), abs=0)


def test_a_load_behind_the_axle_pushes_into_the_curve_as_newton_says():
    """Against DOP853 of the equations in the model's heading, a second in steps of 10 ms."""
    state = np.array([0.0, 0.0, 0.0, 0.15, 0.5, *6 * [0.0]])
    inputs = (2.0, 2.2)

    def motion(_, s):
        grown, _ = pose_model.accelerations(ROBOT, np.append(s, 6 * [0.0]), *inputs)
        return [s[3] * math.cos(s[2]), s[3] * math.sin(s[2]), s[4], *grown]

    known = solve_ivp(motion, (0, 1), state[:5], "DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    for _ in range(100):
        state = pose_model.move(ROBOT, state, 0.01, *inputs).mean
    # of second order in the step: 2e-5 of a second, and less than any sensor tells
    assert state[:5] == pytest.approx(known, abs=2e-4)


COUNT, STEP_S = 80, 0.02
OPTIONS = {
    "radius_m": ROBOT.radius_m, "track_m": ROBOT.track_m, "inertia_kg": ROBOT.inertia_kg,
    "turning_inertia_kg_m2": ROBOT.turning_inertia_kg_m2, "drive_N_V": ROBOT.drive,
    "damping_N_s_m": ROBOT.damping_N_s_m, "friction_N": ROBOT.friction_N,
    "load_behind_kg_m": ROBOT.load_behind_kg_m, "jerk_density_m2_s5": ROBOT.jerk_density_m2_s5,
    "turn_jerk_density_rad2_s5": ROBOT.turn_jerk_density_rad2_s5, "u_push_m_s2": 0.2,
    "u_turn_rad_s2": 1.0,
    "u_start_m": 0.005, "u_start_heading_rad": 0.02, "u_start_speed_m_s": 0.02,
    "u_start_rate_rad_s": 0.1, "gate": 0.0,
}  # fmt: skip
U = {"wheel": 0.15, "gyroscope": 0.05, "range": 0.03, "accelerometer": 0.05}
AHEAD_M, BIAS_M_S2 = 0.03, 0.4
BEACON = np.array([1.0, 0.8])


def driven(run, *, spoilt=False, felt=False, u_motor=0.0, robot=ROBOT):
    """A run whose truth is as the filter's model says, with white noise of known size."""
    generator = stream(3, "extended", run)
    time_s = STEP_S * np.arange(COUNT)
    inputs = 2.0 + np.array([np.sin(2 * time_s), np.cos(3 * time_s)]).T
    names = ["u_start_m", "u_start_m", "u_start_heading_rad", "u_start_speed_m_s"]
    names += ["u_start_rate_rad_s", "u_push_m_s2", "u_turn_rad_s2"]
    start_u = [OPTIONS[name] for name in names]
    # the robot drives already, so that its friction does not change sides
    parts = u_motor * stream(4, "motors", run).standard_normal(2)
    state = np.concatenate([start_u * generator.standard_normal(7), [0.0, 0.0], parts])
    state[SPEED] = abs(state[SPEED])
    states, wheels, ranges = [], [], []
    for number in range(COUNT):
        if number:
            both = inputs[number - 1 : number + 1].mean(axis=0)
            moved = pose_model.move(robot, state, STEP_S, *both)
            # of the noise, rank 6 of 11: by its eigenvectors
            values, vectors = np.linalg.eigh(moved.noise)
            shake = vectors @ (np.sqrt(np.clip(values, 0, None)) * generator.standard_normal(11))
            state = moved.mean + shake
        states.append(state)
        rates, _ = pose_model.wheel_rates(robot, state)
        wheels.append(rates + U["wheel"] * generator.standard_normal(2))
        distance, _ = pose_model.range_to_beacon(Ranger(), state, BEACON)
        ranges.append(distance + U["range"] * generator.standard_normal())
    truth, wheels, ranges = np.array(states), np.array(wheels), np.array(ranges)
    gyroscope = truth[:, RATE] + U["gyroscope"] * generator.standard_normal(COUNT)
    every = zip(truth, inputs, strict=True)
    grown = np.array([pose_model.accelerations(robot, one, *both)[0][0] for one, both in every])
    if spoilt:
        ranges[40] += 2.0
    signals = {
        "left_rate": Signal(time_s, wheels[:, 0], U["wheel"]),
        "right_rate": Signal(time_s, wheels[:, 1], U["wheel"]),
        "turning_rate": Signal(time_s, gyroscope, U["gyroscope"]),
        "left_voltage": Signal(time_s, inputs[:, 0]),
        "right_voltage": Signal(time_s, inputs[:, 1]),
        "range": Signal(time_s, ranges, U["range"]),
        "beacon_x": Signal(time_s, np.full(COUNT, BEACON[0])),
        "beacon_y": Signal(time_s, np.full(COUNT, BEACON[1])),
    }
    if felt:
        # the sensor is off the axle
        read = grown - AHEAD_M * truth[:, RATE] ** 2
        read += BIAS_M_S2 + U["accelerometer"] * generator.standard_normal(COUNT)
        signals["acceleration"] = Signal(time_s, read, U["accelerometer"])
    roles = ("x", "y", "heading", "speed", "rate")
    true = {role: Signal(time_s, truth[:, i]) for i, role in enumerate(roles)}
    true["acceleration"] = Signal(time_s, grown)
    return Given(signals, true, dict(OPTIONS))


@pytest.fixture(scope="module")
def runs():
    estimator = estimators.load("pose_filter")
    return [estimators.apply(estimator, driven(run)) for run in range(60)]


def test_the_extended_filter_is_consistent_on_a_truth_that_it_knows(runs):
    found = consistency.nees(np.array([one.innovations.nees for one in runs]), 6)
    assert found.outcome == "consistent", found
    nis = consistency.nis(
        np.array([one.innovations.nis for one in runs]),
        np.array([one.innovations.used for one in runs]),
    )
    assert nis.outcome == "consistent", nis


def test_motors_that_are_not_as_told_are_states_and_without_them_the_filter_is_too_sure():
    """5 % of each motor, and engines that are late by 5 ms of a motion that settles in 98 ms."""
    robot = replace(
        ROBOT,
        jerk_density_m2_s5=1e-4,
        turn_jerk_density_rad2_s5=1e-3,
        lag_s=0.005,
        settling_s=0.098,
    )
    given = [driven(run, u_motor=0.05, robot=robot) for run in range(60)]
    estimator = estimators.load("pose_filter")
    told = {
        "jerk_density_m2_s5": 1e-4, "turn_jerk_density_rad2_s5": 1e-3, "lag_s": 0.005,
        "settling_s": 0.098,
    }  # fmt: skip
    found = {}
    for u_motor in (0.05, 1e-9):
        options = {**OPTIONS, **told, "u_motor": u_motor}
        runs = [estimators.apply(estimator, Given(g.signals, g.truth, options)) for g in given]
        found[u_motor] = consistency.nees(np.array([one.innovations.nees for one in runs]), 6)
    assert found[0.05].outcome == "consistent", found
    assert found[1e-9].outcome in ("too sure", "diverged"), found


def test_an_accelerometer_helps_and_the_filter_still_knows_its_error(runs):
    """What motors do not explain is a state: the motion's noise and the reading are independent."""
    estimator = estimators.load("pose_filter")
    options = {**OPTIONS, "acceleration_bias": 1, "accelerometer_ahead_m": AHEAD_M}
    given = [driven(run, felt=True) for run in range(60)]
    found = [
        estimators.apply(estimator, Given(one.signals, one.truth, options)) for one in given
    ]  # fmt: skip
    verdict = consistency.nees(np.array([one.innovations.nees for one in found]), 6)
    assert verdict.outcome == "consistent", verdict
    felt, unfelt = (
        np.mean([one.best.states["speed_m_s"].rms_error for one in every])
        for every in (found, runs)
    )
    assert felt < 0.9 * unfelt
    bias = [one.numbers["last_acceleration_bias_m_s2"] for one in found]
    # 60 runs: three standard uncertainties of their mean
    far = abs(np.mean([one.value for one in bias]) - BIAS_M_S2)
    assert far < 3 * bias[0].u / math.sqrt(60)


def test_the_smoother_errs_less_than_the_filter_and_that_less_than_the_wheels(runs):
    for state in ("x_m", "y_m", "heading_rad"):
        errors = {
            way: np.mean([one.ways[way].states[state].rms_error for one in runs])
            for way in (0, 1, 2)
        }
        assert errors[1] < errors[0] < errors[2]


def test_a_range_that_cannot_be_is_refused():
    estimator = estimators.load("pose_filter")
    given = driven(0, spoilt=True)
    options = {**OPTIONS, "gate": 5.0}
    found = estimators.apply(estimator, Given(given.signals, given.truth, options))
    assert found.innovations.refused["range"] >= 1
    assert found.best.states["x_m"].rms_error < 0.05


def test_a_wheel_that_slips_once_is_counted_anew():
    """20 mm on ice, far more than a mark: a few counts are refused, and no later ones."""
    given = driven(0)
    time_s = np.arange(0.0, 1.58, 0.001)
    speed, rate = (given.truth[role].at(time_s) for role in ("speed", "rate"))
    signals = {r: s for r, s in given.signals.items() if r not in ("left_rate", "right_rate")}
    for side, sign in (("left", -1), ("right", 1)):
        turned = np.cumsum((speed + sign * 0.06 * rate) * 0.001) / ROBOT.radius_m
        if side == "left":
            turned[time_s > 0.8] += 0.02 / ROBOT.radius_m
        signals[f"{side}_marks"] = Signal(time_s, np.floor(turned * 960 / (2 * np.pi) + 0.3))
    options = {**OPTIONS, "marks": 960, "gate": 5.0, "gate_s": 0.02}
    found = estimators.apply(
        estimators.load("pose_filter"), Given(signals, given.truth, options)
    )  # fmt: skip
    assert 1 <= found.innovations.refused["left_marks"] <= 3
    assert found.innovations.refused["right_marks"] == 0
    after = found.best.time_s > 0.9
    speed = found.best.states["speed_m_s"]
    # half a mark in 20 ms is 5 mm/s; 20 mm taken for a way would have been a metre a second
    assert np.nanmax(np.abs(speed.error[after])) < 0.02


def test_counts_at_uneven_times_have_white_errors_where_even_ones_repeat():
    """8.414 marks in a gate of 10 ms, read each 0.1 ms; even gates: 1 - 6f(1 - f), f = 0.414."""
    time_s = 1e-4 * np.arange(200_001)
    counts = Signal(time_s, np.floor(841.4 * time_s + 0.3))
    uneven = timing.turned(counts, 960, 0.01)
    errors = uneven.values * 960 / (2 * np.pi) - 841.4 * uneven.time_s
    even = counts.values[::100] - 841.4 * time_s[::100]
    # 2000 counts tell a correlation to 0.022
    assert consistency.autocorrelation(even)[0] == pytest.approx(1 - 6 * 0.414 * 0.586, abs=0.03)
    assert consistency.autocorrelation(errors)[0] == pytest.approx(0, abs=0.07)
    assert np.std(errors) / (960 / (2 * np.pi)) == pytest.approx(uneven.u, rel=0.05)


def test_speeds_and_accelerations_are_changes_of_the_true_place_and_heading():
    """A circle of 0.5 m, driven ever faster: v = 0.2 + 0.3·t, ω = v/0.5."""
    given = driven(0)
    time_s = np.linspace(0, 1.6, 3201)
    turned = (0.2 * time_s + 0.15 * time_s**2) / 0.5
    truth = {
        "x": Signal(time_s, 0.5 * np.sin(turned)), "y": Signal(time_s, 0.5 * (1 - np.cos(turned))),
        "heading": Signal(time_s, turned),
    }  # fmt: skip
    options = {**OPTIONS, "truth_over_s": 0.02}
    found = estimators.apply(estimators.load("pose_filter"), Given(given.signals, truth, options))
    states = found.best.states
    t = found.best.time_s[2:-2]
    known = {
        "speed_m_s": 0.2 + 0.3 * t, "acceleration_m_s2": 0.3 + 0 * t,
        "rate_rad_s": 0.4 + 0.6 * t, "turn_acceleration_rad_s2": 0.6 + 0 * t,
    }  # fmt: skip
    for name, values in known.items():
        # straight lines between samples of 0.5 ms miss a circle by 3e-8 m, over (10 ms)² by 3e-4
        assert states[name].truth[2:-2] == pytest.approx(values, abs=1e-3), name


def test_a_true_place_of_a_mark_is_that_of_the_axle_once_the_heading_is_known():
    given = driven(0)
    heading = given.truth["heading"].values
    ahead = {"x": np.cos(heading), "y": np.sin(heading)}
    moved = {r: Signal(s.time_s, s.values - 0.02 * ahead[r])
             for r, s in given.truth.items() if r in ahead}  # fmt: skip
    options = {**OPTIONS, "mark_ahead_m": -0.02}
    estimator = estimators.load("pose_filter")
    same = estimators.apply(estimator, Given(given.signals, {**given.truth, **moved}, options))
    plain = estimators.apply(estimator, given)
    for state in ("x_m", "y_m"):
        known = plain.best.states[state].truth
        assert same.best.states[state].truth == pytest.approx(known, abs=1e-12)
    with pytest.raises(InputError, match="expected the truth of the heading"):
        estimators.apply(estimator, Given(given.signals, moved, options))


def test_the_usual_gate_refuses_no_right_reading_and_leaves_a_right_filter_right():
    """At 2.576, χ² of 99 %, it takes one in a hundred, and NIS is too small."""
    assert estimators.load("pose_filter").options["gate"].default == 5.0
    found = {gate: gated(gate) for gate in (5.0, 2.5758293)}
    refused = {
        gate: np.mean([sum(one.innovations.refused.values()) for one in every]) / (4 * COUNT)
        for gate, every in found.items()
    }
    assert refused[5.0] == 0
    assert refused[2.5758293] == pytest.approx(0.01, abs=0.004)  # 6400 readings: ±0.0012
    nis = {
        gate: consistency.nis(
            np.array([one.innovations.nis for one in every]),
            np.array([one.innovations.used for one in every]),
        )
        for gate, every in found.items()
    }
    assert nis[5.0].outcome == "consistent"
    assert nis[2.5758293].outcome == "too careful"
    squares = {
        gate: np.mean(
            [np.mean(row**2) for one in every for row in one.innovations.whitened.values()]
        )
        for gate, every in found.items()
    }
    # of one reading 1 - 2·g·φ(g)/0.99; those of one instant are correlated, so that NIS loses less
    assert squares[2.5758293] / squares[5.0] == pytest.approx(0.925, abs=0.02)


def gated(gate):
    """Twenty runs with this gate, in place of none."""
    estimator = estimators.load("pose_filter")
    given = [driven(run) for run in range(20)]
    return [
        estimators.apply(estimator, Given(one.signals, one.truth, {**OPTIONS, "gate": gate}))
        for one in given
    ]


def test_all_that_is_missing_is_told_at_once():
    estimator = estimators.load("pose_filter")
    with pytest.raises(InputError) as told:
        estimators.apply(estimator, Given({"wheel": Signal(np.arange(3.0), np.zeros(3))}))
    text = str(told.value)
    for word in ("wheel", "radius_m is missing", "track_m is missing"):
        assert word in text


def test_a_filter_without_wheels_is_refused():
    estimator = estimators.load("pose_filter")
    signals = {"turning_rate": Signal(np.arange(3.0), np.zeros(3), 0.1)}
    with pytest.raises(InputError, match="the wheels are not given; expected left_marks"):
        estimators.apply(estimator, Given(signals, {}, {"radius_m": 0.03, "track_m": 0.1}))
