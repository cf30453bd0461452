"""Truth of the robot on given wheel rates, wheel rates from increments, and the drift of a path."""

import itertools
import math
import os
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare.engine import engines
from simcompare.engine.simulation import sample_times
from simcompare.hardware.conditioning import derived_channels
from simcompare.measures import Request, drift
from simcompare.model.scenario import Probe
from simcompare.model.settings import Settings
from simcompare.model.signals import Chirp, Constant, Ramp, Sine, SineSteps, Step, Table
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.instants import corners_of
from simcompare.scenarios.odometry.reference import driven, reference, robot_of

LOG = "odometry_plaza/Plaza1_.mat"
MOVING = {
    "start_x_m": 3.0, "start_y_m": -2.0, "start_heading_rad": 2.4, "wheel_radius_m": 0.12,
    "start_left_rate_rad_s": 9.0, "start_right_rate_rad_s": 11.0, "body_yaw_inertia_kg_m2": 2.0,
}  # fmt: skip


def scene(**changes):
    return catalogue.load("odometry").resolve(changes)


def recorded():
    """The real log's matrices, or a skip with the reason."""
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder or not (Path(folder) / LOG).is_file():
        pytest.skip(f"SIMCOMPARE_DATA names no folder with {LOG}")
    from scipy.io import loadmat

    return loadmat(Path(folder) / LOG)


def stepped(parameters, signals, times):
    """Independent: DOP853 of the same robot as bodies, restarted at every corner of its goals."""
    p = parameters
    r, track = p["wheel_radius_m"], p["track_m"]
    ball = 2 * p["wheel_mass_kg"] * r**2 / 3
    bodies = [  # mass, place ahead of the axle, to the left, yaw inertia
        (p["body_mass_kg"], 0.0, 0.0, p["body_yaw_inertia_kg_m2"]),
        (0.001, p["mark_ahead_m"], 0.0, 1e-6),
        (p["caster_mass_kg"], p["caster_m"], 0.0, 1e-4 * p["caster_mass_kg"]),
        (p["caster_mass_kg"], -p["caster_m"], 0.0, 1e-4 * p["caster_mass_kg"]),
        (p["wheel_mass_kg"], 0.0, track / 2, ball),
        (p["wheel_mass_kg"], 0.0, -track / 2, ball),
    ]
    mass = sum(m for m, *_ in bodies)
    first = sum(m * a for m, a, *_ in bodies)
    yaw = sum(i + m * (a**2 + s**2) for m, a, s, i in bodies)
    spin = ball
    gain = (mass * r**2 + 2 * spin) / (2 * p["lag_s"])

    def change(t, state):
        _, _, heading, v, w, _, _ = state
        rates = ((v - w * track / 2) / r, (v + w * track / 2) / r)
        goals = [float(s.at(np.array([t]))[0]) for s in signals]
        # torque on each wheel; what is left after spinning it pushes the robot
        matrix = np.array([[mass + 2 * spin / r**2, 0], [0, yaw + spin * track**2 / (2 * r**2)]])
        torque = [gain * (g - q) for g, q in zip(goals, rates, strict=True)]
        ahead = (torque[0] + torque[1]) / r
        about = (torque[1] - torque[0]) * track / (2 * r)
        # the centre of mass turns about the axle: m·a·ω² inwards, and the way of the axle turns it
        growth, turning = np.linalg.solve(matrix, [ahead + first * w**2, about - first * v * w])
        return [v * math.cos(heading), v * math.sin(heading), w, growth, turning, *rates]

    left, right = p["start_left_rate_rad_s"], p["start_right_rate_rad_s"]
    state = [
        p["start_x_m"], p["start_y_m"], p["start_heading_rad"],
        r * (left + right) / 2, r * (right - left) / track, 0.0, 0.0,
    ]  # fmt: skip
    end = float(times[-1])
    corners = np.unique(np.concatenate([[0.0, end], *(corners_of(s) for s in signals)]))
    corners = corners[(corners >= 0) & (corners <= end)]
    found = [state]
    for start, stop in itertools.pairwise(corners):
        inside = times[(times > start) & (times <= stop)]
        run = solve_ivp(
            change, (start, stop), state, "DOP853", rtol=1e-12, atol=1e-13, max_step=0.02,
            t_eval=np.union1d(inside, [stop]),
        )  # fmt: skip
        state = run.y[:, -1]
        found += [run.y[:, i] for i, t in enumerate(run.t) if t in inside]
    return np.array(found).T


@pytest.mark.parametrize("changes", [{}, MOVING], ids=["default", "moving"])
def test_agrees_with_an_integration_that_steps(changes):
    scenario = scene(**changes, duration_s=8.0)
    signals = (scenario.inputs["left_rate"], scenario.inputs["right_rate"])
    times = np.linspace(0, 8, 33)
    truth = reference(scenario.parameters, times, scenario.inputs)
    x, y, _, v, w, left, right = stepped(scenario.parameters, signals, times)
    np.testing.assert_allclose(truth["mark.position_m"][:, 0], x, atol=1e-9)
    np.testing.assert_allclose(truth["chassis.position_m"][:, 1], y, atol=1e-9)
    np.testing.assert_allclose(truth["left.angle_rad"], left, atol=1e-9)
    np.testing.assert_allclose(truth["right.angle_rad"], right, atol=1e-9)
    np.testing.assert_allclose(truth["chassis.rate_rad_s"][:, 2], w, atol=1e-9)
    speed = np.hypot(*truth["chassis.velocity_m_s"][:, :2].T)
    np.testing.assert_allclose(speed, v, atol=1e-9)


def test_a_mark_of_one_gram_ahead_of_the_axle_shifts_the_path_by_less_than_half_a_millimetre():
    scenario = scene(mark_ahead_m=1.0)
    signals = (scenario.inputs["left_rate"], scenario.inputs["right_rate"])
    times = np.linspace(0, 9, 10)
    truth = reference(scenario.parameters, times, scenario.inputs)["mark.position_m"]
    x, y, heading, *_ = stepped(scenario.parameters, signals, times)
    np.testing.assert_allclose(truth[:, 0], x + np.cos(heading), atol=5e-4)
    np.testing.assert_allclose(truth[:, 1], y + np.sin(heading), atol=5e-4)


@pytest.mark.parametrize(
    "signal",
    [
        Constant(signal="constant", value=8.0),
        Step(signal="step", before=2.0, after=9.0, time_s=0.7),
        Ramp(signal="ramp", start=1.0, end=9.0, start_s=0.2, end_s=1.1),
        Sine(signal="sine", amplitude=3.0, frequency_Hz=2.0, offset=5.0),
        SineSteps(signal="sine_steps", amplitude=3.0, frequencies_Hz=(1.0, 3.0), dwell_s=0.8),
        Chirp(signal="chirp", amplitude=3.0, start_Hz=0.5, end_Hz=4.0, duration_s=2.0),
    ],
    ids=lambda s: s.signal,
)
def test_every_kind_of_signal_is_followed(signal):
    parameters = scene(**MOVING).parameters
    other = Constant(signal="constant", value=7.0)
    times = np.linspace(0, 2, 21)
    x, y, heading, v, w, _ = driven(parameters, robot_of(parameters), times, (other, signal))
    found = stepped(parameters, (other, signal), times)
    for ours, theirs in zip((x, y, heading, v, w), found[:5], strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-9)


def test_speed_and_turn_lag_behind_their_goals_in_closed_form():
    parameters = scene().parameters
    robot = robot_of(parameters)
    goals = (Constant(signal="constant", value=6.0), Constant(signal="constant", value=10.0))
    times = np.linspace(0, 0.5, 11)
    *_, v, w, way = driven(parameters, robot, times, goals)
    assert robot.lags_s[0] == pytest.approx(parameters["lag_s"], rel=1e-12)
    v_end, w_end = 0.1 * 8.0, 0.1 * 4.0 / 0.5
    np.testing.assert_allclose(v, v_end * -np.expm1(-times / robot.lags_s[0]), atol=1e-13)
    np.testing.assert_allclose(w, w_end * -np.expm1(-times / robot.lags_s[1]), atol=1e-13)
    lag = robot.lags_s[0]
    np.testing.assert_allclose(way, v_end * (times + lag * np.expm1(-times / lag)), atol=1e-13)


def test_the_times_that_are_asked_for_do_not_change_the_truth():
    scenario = scene(**MOVING)
    few = np.array([0.0, 1.234, 5.5])
    many = np.unique(np.concatenate((few, np.linspace(0, 6, 601))))
    first = reference(scenario.parameters, few, scenario.inputs)
    second = reference(scenario.parameters, many, scenario.inputs)
    at = np.searchsorted(many, few)
    for name, values in first.items():
        np.testing.assert_allclose(values, second[name][at], atol=1e-12, err_msg=name)


def test_the_default_course_is_a_figure_of_eight_that_ends_near_its_start():
    scenario = scene()
    times = sample_times(scenario)
    place = reference(scenario.parameters, times, scenario.inputs)["mark.position_m"]
    length = np.hypot(*np.diff(place[:, :2], axis=0).T).sum()
    assert np.hypot(*place[-1, :2]) < 0.15 * length
    # one circle on either side
    assert place[:, 1].max() > 1
    assert place[:, 1].min() < -1


@pytest.mark.parametrize("engine", ["mujoco", "pybullet", "dart"])
def test_engines_arrive_where_the_truth_does_and_better_with_shorter_steps(engine):
    apart = []
    for substeps in (10, 20):
        scenario = scene(start_heading_rad=0.7, start_x_m=2.0)
        world = scenario.world.model_copy(update={"substeps": substeps})
        scenario = scenario.model_copy(update={"world": world})
        run = engines.get(engine).simulate(scenario, Settings(contact="assisted"))
        truth = reference(scenario.parameters, run.time_s, scenario.inputs)
        off = run.signals["mark.position_m"][:, :2] - truth["mark.position_m"][:, :2]
        apart.append(float(np.hypot(*off.T).max()))
    assert apart[0] < 0.01
    assert apart[1] < 0.75 * apart[0]


# --- drift ----------------------------------------------------------------------------------------


def path(x, y):
    time_s = np.arange(len(x)) * 0.5
    signals = {"p": np.column_stack((x, y, np.zeros(len(x))))}
    return Trajectory("made", time_s, signals)


REQUEST = Request(
    Probe(observe="p", component=0, label="x", unit="m"),
    {"side": Probe(observe="p", component=1, label="y", unit="m")},
    {"count": 100},
)


def test_drift_is_the_distance_of_the_ends_over_the_length_of_the_true_path():
    truth = drift.measure(path([0, 3, 3], [0, 0, 4]), REQUEST)
    ours = drift.measure(path([0, 3, 3.3], [0, 1, 4.4]), REQUEST)
    found = drift.against(ours, truth)
    assert found["path_length"][1] == pytest.approx(7)
    assert found["end_error"] == (pytest.approx(0.5), 0.0)
    assert found["largest_error"] == (pytest.approx(1.0), 0.0)
    assert found["end_drift"] == (pytest.approx(0.5 / 7), 0.0)


def test_a_path_that_leads_nowhere_has_no_drift():
    truth = drift.measure(path([1, 1], [2, 2]), REQUEST)
    assert "end_drift" not in drift.against(truth, truth)


def test_paths_at_other_times_are_not_compared():
    truth = drift.measure(path([0, 3, 3], [0, 0, 4]), REQUEST)
    ours = drift.measure(path([0, 3], [0, 0]), REQUEST)
    assert drift.against(ours, truth)["end_error"] == (None, 0.0)


# --- the real log ---------------------------------------------------------------------------------


def test_the_surveyed_heading_is_the_sum_of_the_odometry_turns():
    """So heading must not be judged: it is the same measurement twice."""
    log = recorded()
    turned = log["GT"][0, 3] + np.cumsum(log["DR"][:, 2])
    apart = turned - log["GT"][1:, 3]
    apart -= 2 * np.pi * np.round(apart / (2 * np.pi))
    assert np.abs(apart).max() < 1e-9


def test_the_truth_repeats_dead_reckoning_of_the_real_log_and_its_known_end_error():
    log = recorded()
    odometry, survey = log["DR"], log["GT"]
    time_s = survey[:, 0] - survey[0, 0]
    times, left, right = derived_channels.wheel_rates(
        odometry[:, 1], odometry[:, 2], time_s[1:], 0.1, 0.5
    )
    # here the first increment's interval is known
    times[0] = 0.0
    inputs = {
        name: Table(signal="table", time_s=tuple(times), value=tuple(values))
        for name, values in (("left_rate", left), ("right_rate", right))
    }
    parameters = {
        **scene().parameters, "duration_s": float(time_s[-1]),
        "start_x_m": survey[0, 1], "start_y_m": survey[0, 2], "start_heading_rad": survey[0, 3],
    }  # fmt: skip
    place = reference(parameters, time_s, inputs)["mark.position_m"][:, :2]
    gap = np.hypot(*(place - survey[:, 1:3]).T)
    # arcs of the increments, with no lag
    heading = survey[0, 3] + np.append(0, np.cumsum(odometry[:, 2]))
    middle = (heading[1:] + heading[:-1]) / 2
    reckoned = np.cumsum(
        odometry[:, 1:2] * np.column_stack((np.cos(middle), np.sin(middle))), axis=0
    )
    assert np.hypot(*(place[-1] - reckoned[-1])) < 0.05
    assert gap[-1] == pytest.approx(4.45, abs=0.1)
    assert odometry[:, 1].sum() == pytest.approx(1861.3, abs=0.1)
