"""The robot with unequal wheels: its truth, what odometry makes of it, and the way back."""

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare.engine import engines
from simcompare.engine.simulation import sample_times
from simcompare.estimation.dead_reckoning import Wheels
from simcompare.estimation.umbmark import Course, by_formula, separate
from simcompare.measures import Request, dead_reckoning, take
from simcompare.model.scenario import Probe
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.instants import corners_of
from simcompare.scenarios.robot_line.reference import reference


def scene(name, preset=None, **changes):
    return catalogue.load(name).resolve(changes, preset=preset)


def truth_of(scenario):
    times = sample_times(scenario)
    return Trajectory("truth", times, reference(scenario.parameters, times, scenario.inputs))


def measured(scenario, trajectory):
    wanted = next(m for m in scenario.measures if m.function == "dead_reckoning")
    return take(wanted, scenario, trajectory).values


def integrated(scenario, times):
    """Independent: wheels, body, and the forces of the floor between them, by DOP853."""
    p = scenario.parameters
    radii = (p["wheel_radius_m"], p["wheel_radius_m"] * (1 + p["right_larger"]))
    spins = [2 * p["wheel_mass_kg"] * r**2 / 3 for r in radii]
    half = p["track_m"] / 2
    mass = p["body_mass_kg"] + 2 * p["wheel_mass_kg"] + 2 * p["caster_mass_kg"] + 0.001
    yaw = p["body_yaw_inertia_kg_m2"] + sum(spins) + 2 * p["wheel_mass_kg"] * half**2
    yaw += 2 * p["caster_mass_kg"] * (1e-4 + p["caster_m"] ** 2) + 1e-6
    gain = (mass * radii[0] ** 2 + 2 * spins[0]) / (2 * p["lag_s"])
    goals = scenario.inputs["left_rate"], scenario.inputs["right_rate"]
    # unknown: dv/dt, dω/dt, both wheels' dφ'/dt, both forces of the floor
    matrix = np.array([
        [mass, 0, 0, 0, -1, -1],
        [0, yaw, 0, 0, half, -half],
        [0, 0, spins[0], 0, radii[0], 0],
        [0, 0, 0, spins[1], 0, radii[1]],
        [1, -half, -radii[0], 0, 0, 0],
        [1, half, 0, -radii[1], 0, 0],
    ])  # fmt: skip

    def change(t, state):
        _, _, heading, v, w, left, right = state
        torques = [
            gain * (float(goal.at(np.array([t]))[0]) - rate)
            for goal, rate in zip(goals, (left, right), strict=True)
        ]
        found = np.linalg.solve(matrix, [0, 0, *torques, 0, 0])
        return [v * math.cos(heading), v * math.sin(heading), w, *found[:4]]

    end, state, rows = float(times[-1]), np.zeros(7), {0.0: np.zeros(7)}
    corners = np.unique(np.concatenate([[0.0, end], *(corners_of(g) for g in goals)]))
    for start, stop in itertools.pairwise(corners[corners <= end]):
        inside = times[(times > start) & (times <= stop)]
        run = solve_ivp(change, (start, stop), state, "DOP853", rtol=1e-12, atol=1e-13,
                        t_eval=np.union1d(inside, [stop]))  # fmt: skip
        state = run.y[:, -1]
        rows |= dict(zip(run.t.tolist(), run.y.T, strict=True))
    return np.array([rows[t] for t in times.tolist()]).T


@pytest.mark.parametrize(
    ("name", "changes"),
    [("robot_line", {"right_larger": 0.08}), ("robot_square", {"right_larger": -0.05})],
)
def test_the_truth_agrees_with_an_integration_of_wheels_and_forces(name, changes):
    scenario = scene(name, **changes)
    times = np.linspace(0, scenario.world.duration_s, 41)
    truth = reference(scenario.parameters, times, scenario.inputs)
    x, y, heading, v, _, left, right = integrated(scenario, times)
    np.testing.assert_allclose(truth["mark.position_m"][:, 0], x, atol=1e-9)
    np.testing.assert_allclose(truth["mark.position_m"][:, 1], y, atol=1e-9)
    np.testing.assert_allclose(truth["chassis.velocity_m_s"][:, 0], v * np.cos(heading), atol=1e-9)
    np.testing.assert_allclose(truth["left.rate_rad_s"], left, atol=1e-8)
    np.testing.assert_allclose(truth["right.rate_rad_s"], right, atol=1e-8)


def test_equal_wheels_drive_straight_on_and_only_counting_is_left():
    scenario = scene("robot_line", "equal")
    found = measured(scenario, truth_of(scenario))
    mark = 2 * math.pi * 0.0325 / 576
    assert abs(found["odometry_across"]) < 1e-12
    assert 0 <= -found["odometry_along"] < mark  # a mark that is not reached does not count


def test_on_a_line_odometry_strays_as_the_closed_forms_say():
    scenario = scene("robot_line", marks=1_000)
    found = measured(scenario, truth_of(scenario))
    larger, track, mark = 0.005, 0.12, 2 * math.pi * 0.0325 / 1_000
    bend = larger / track
    assert found["odometry_turn"] == pytest.approx(-bend, abs=mark / track)
    # along: half of the part, less what an arc is shorter than its length, and up to a mark
    assert found["odometry_along"] == pytest.approx(-larger / 2 + bend**2 / 6, abs=1.1 * mark)
    # across: ½·v·ω_b·t², to the order of the scale
    assert found["odometry_across"] == pytest.approx(-bend / 2, abs=0.005 * bend)
    assert found["odometry_drift"] == pytest.approx(found["odometry_error"] / 1.0025, rel=1e-4)


@pytest.mark.parametrize(("preset", "way"), [(None, 1), ("clockwise", -1)])
def test_a_square_ends_where_both_errors_put_it(preset, way):
    scenario = scene("robot_square", preset)
    end = truth_of(scenario).signals["mark.position_m"][-1, :2]
    bend = 0.005 * 0.5 / 0.12
    beyond = math.pi / 2 * (1.0025 * 0.1188 / 0.12 - 1)
    expected = np.array([2 * 0.5 * (beyond + way * bend) * way] * 2) * (1, -way)
    if way < 0:
        expected = np.array([-2 * 0.5 * (bend - beyond)] * 2)
    # the next order is (4·(α + β))² of the side, and the shift in each turn is 0.2 mm
    np.testing.assert_allclose(end, expected, atol=0.003)


def course(scenario, trajectory):
    signals = trajectory.signals
    counts = signals["left_encoder.marks"], signals["right_encoder.marks"]
    return Course(trajectory.time_s, counts, tuple(signals["mark.position_m"][-1, :2]))


def test_an_engines_squares_tell_the_wheels_that_it_was_given():
    believed = Wheels(0.0325, 0.0325, 0.1188, 1e-4, 1e-4, 1e-3, correlation=1.0)
    courses, errors = [], []
    for preset in (None, "clockwise"):
        scenario = scene("robot_square", preset)
        run = engines.get("pybullet").simulate(scenario, Settings(contact="tuned"))
        courses.append(course(scenario, run))
        errors.append(np.array([courses[-1].end_m]))  # odometry believes to be at its start
    found = separate(courses, 576, believed, 0.001)
    assert found.diameters == pytest.approx(1.005, abs=2 * found.u_diameters)
    # the mean radius is 0.25 % larger than believed, and on a closed course that is in the track
    assert found.track == pytest.approx(0.12 / 0.1188 / 1.0025, abs=2 * found.u_track)
    assert found.before_m > 0.03
    assert found.after_m < 0.001
    diameters, track = by_formula(0.5, 0.1188, errors[1], errors[0])
    assert diameters == pytest.approx(found.diameters, abs=0.0005)
    assert track == pytest.approx(found.track, abs=0.0015)


# --- the measure --------------------------------------------------------------------------------


def request(count=5):
    def see(name, component=None):
        return Probe(observe=name, component=component, label=name, unit="1")

    return Request(
        see("p", 0),
        {
            "side": see("p", 1), "orientation": see("q", 3),
            "left_marks": see("l"), "right_marks": see("r"),
        },
        {"radius_m": 0.1, "track_m": 0.5, "marks": 100, "count": count},
    )  # fmt: skip


def quarter(turned_rad, place):
    """A robot that starts at (1, 2) along y, and marks of a quarter circle to the left."""
    radius, count = 2.0, 9
    share = np.linspace(0, 1, count)
    half = 0.25
    marks = [share * math.pi / 2 * (radius + s * half) / 0.1 * 100 / (2 * math.pi) for s in (-1, 1)]
    yaw = math.pi / 2 + share * turned_rad
    q = np.column_stack((np.cos(yaw / 2), 0 * yaw, 0 * yaw, np.sin(yaw / 2)))
    way = np.array([1.0, 2.0]) + share[:, None] * (np.asarray(place) - (1.0, 2.0))
    signals = {"p": np.column_stack((way, 0 * share)), "q": q, "l": marks[0], "r": marks[1]}
    return Trajectory("made", share, signals)


def test_dead_reckoning_starts_where_the_robot_does_and_is_held_against_it():
    # odometry ends at (-1, 4), heading along -x; the robot 0.3 ahead of it and 0.1 to its right
    found = dead_reckoning.measure(quarter(math.pi / 2 + 0.02, (-1.3, 4.1)), request())
    assert found.values["odometry_along"] == pytest.approx(-0.3)
    assert found.values["odometry_across"] == pytest.approx(0.1)
    assert found.values["odometry_turn"] == pytest.approx(-0.02)
    assert found.values["odometry_error"] == pytest.approx(math.hypot(0.3, 0.1))
    length = math.hypot(2.3, 2.1)
    assert found.values["odometry_drift"] == pytest.approx(math.hypot(0.3, 0.1) / length)
    assert found.series["reckoned_x"][-1] == pytest.approx(-1.0)
    assert found.series["reckoned_y"][-1] == pytest.approx(4.0)
    assert len(found.series["reckoned_time"]) == 5


def test_a_robot_that_stands_has_no_drift():
    still = quarter(0.0, (1.0, 2.0))
    assert dead_reckoning.measure(still, request()).values["odometry_drift"] is None
