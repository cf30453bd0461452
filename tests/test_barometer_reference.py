"""The climbing cart and the standard atmosphere against integrations and published numbers."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare import measures
from simcompare.engine.drives import input_values
from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.measures import Request, pressure_height
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.barometer import reference as climbing

CHANGES = [
    {},
    {"climb_m": 100.0, "slope_rad": 1.57, "climb_time_s": 60.0},
    {"altitude_m": -400.0, "mass_kg": 5.0, "gravity_m_s2": 3.7},
]


def scene(**changes):
    return catalogue.load("barometer").resolve(changes)


def truth_of(scenario):
    times = sample_times(scenario)
    return Trajectory("closed form", times, climbing.reference(scenario.parameters, times))


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_agrees_with_an_integration_of_the_scene(changes):
    scenario = scene(**changes)
    truth = truth_of(scenario)
    mass, axis = scenario.bodies["cart"].mass_kg, np.array(scenario.joints["track"].axis)
    pull = scenario.actuators["winch"]
    along = np.array(scenario.world.gravity_m_s2) @ axis

    def motion(t, state):
        force = pull.gear * input_values(scenario, np.array([t]))[pull.input][0]
        return [state[1], force / mass + along]

    solved = solve_ivp(
        motion, (0, truth.time_s[-1]), [0.0, 0.0], "DOP853", dense_output=True,
        rtol=1e-13, atol=1e-13, max_step=truth.time_s[-1] / 200,
    ).sol(truth.time_s)  # fmt: skip
    np.testing.assert_allclose(truth.signals["track.position_m"], solved[0], atol=1e-9)
    np.testing.assert_allclose(truth.signals["track.velocity_m_s"], solved[1], atol=1e-9)
    start = np.array(scenario.bodies["cart"].position_m)
    np.testing.assert_allclose(
        truth.signals["cart.position_m"], start + solved[0][:, None] * axis, atol=1e-9
    )


def test_it_ends_at_rest_where_it_was_to_go():
    scenario = scene()
    truth = truth_of(scenario)
    assert truth.signals["track.position_m"][-1] == pytest.approx(2.0, rel=1e-12)
    assert truth.signals["track.velocity_m_s"][-1] == pytest.approx(0.0, abs=1e-12)


def test_pressure_is_that_of_a_column_of_air_at_rest():
    # dp/dh = -p·g·M/(R·T), T = T_0 - L·h: knows nothing of the power law
    def column(h, p):
        return -p * 9.80665 * 0.0289644 / (8.314462618 * (288.15 - 0.0065 * h))

    heights = np.linspace(0, 9000, 50)
    solved = solve_ivp(
        column, (0, 9000), [101325.0], "DOP853", t_eval=heights, rtol=1e-13, max_step=50
    )
    np.testing.assert_allclose(climbing.pressure(heights), solved.y[0], rtol=1e-9)


def test_published_numbers():
    exponent = climbing.WEIGHT_K_M / climbing.LAPSE_K_M
    assert exponent == pytest.approx(5.255786, abs=5e-7)
    assert 1 / exponent == pytest.approx(0.1902665, abs=5e-8)
    # 8.3 cm of height are a pascal at sea level
    slope = np.diff(climbing.pressure(np.array([-0.5, 0.5])))[0]
    assert 1 / slope == pytest.approx(-0.083244, abs=5e-7)
    # ISO 2533:1975 has 89874.6 Pa at 1000 m, by its own gas constant
    assert climbing.pressure(np.array([1000.0]))[0] == pytest.approx(89874.6, abs=0.5)


def test_the_core_reads_the_same_pressure():
    scenario = scene()
    truth = truth_of(scenario)
    signals = {n: truth.signals[n] for n in ("track.position_m", "track.velocity_m_s")}
    complete(scenario, truth.time_s, signals, input_values(scenario, truth.time_s))
    np.testing.assert_allclose(
        signals["barometer.pressure_Pa"], truth.signals["barometer.pressure_Pa"], rtol=1e-12
    )


def test_the_measure_tells_the_climb_from_the_pressure():
    scenario = scene()
    measure = scenario.measures[1]
    found = measures.take(measure, scenario, truth_of(scenario))
    assert found.values["climb"] == pytest.approx(2 * math.sin(math.pi / 6), abs=1e-9)
    np.testing.assert_allclose(found.series["told_height"], found.series["true_height"], atol=1e-8)
    assert pressure_height.against(found, found)["height_error"][0] < 1e-8


def made(pressure, height):
    signals = {"p.pressure_Pa": np.asarray(pressure), "h.position_m": np.asarray(height)}
    request = Request(
        Probe(observe="p.pressure_Pa", label="p", unit="Pa"),
        {"height": Probe(observe="h.position_m", label="h", unit="m")},
        {"count": 3},
    )
    return pressure_height.measure(Trajectory("made", np.arange(3.0), signals), request)


def test_a_source_that_is_too_low_is_told_so():
    height = np.array([0.0, 1.0, 2.0])
    truth = made(climbing.pressure(height), height)
    low = made(climbing.pressure(height * 0.9), height * 0.9)
    found = pressure_height.against(low, truth)
    # held against where the truth is, not against where the source itself is
    assert found["height_error"] == (pytest.approx(0.2, abs=1e-6), 0.0)
    assert found["climb"] == (pytest.approx(1.8, abs=1e-6), pytest.approx(2.0, abs=1e-6))
