"""The turntable's closed form against an integration of its scene, and against differences."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare import measures
from simcompare.engine.drives import input_values
from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.gyroscope import reference as table

CHANGES = [
    {},
    {"peak_rate_rad_s": 30.0, "flank_s": 0.05},
    {"radius_m": 0.5, "test_mass_kg": 2.0},
    {"table_inertia_kg_m2": 0.0001},
]


def scene(**changes):
    return catalogue.load("gyroscope").resolve(changes)


def truth_of(scenario):
    times = sample_times(scenario)
    return Trajectory("closed form", times, table.reference(scenario.parameters, times))


def integrated(scenario, time_s):
    """Angle and rate by DOP853 from the scene's own masses, torque and corners."""
    bodies, motor = scenario.bodies, scenario.actuators["motor"]
    away = bodies["test_mass"].position_m[0]
    inertia = bodies["table"].inertia_kg_m2[2] + bodies["test_mass"].inertia_kg_m2[2]
    inertia += bodies["test_mass"].mass_kg * away**2

    def motion(t, state):
        torque = motor.gear * input_values(scenario, np.array([t]))[motor.input][0]
        return [state[1], torque / inertia]

    state, found = np.zeros(2), np.zeros((2, len(time_s)))
    for start, end in pairwise(scenario.inputs["drive"].time_s):
        inside = (time_s >= start) & (time_s <= end)
        solved = solve_ivp(
            motion, (start, end), state, "DOP853", dense_output=True, rtol=1e-13, atol=1e-13
        )
        found[:, inside] = solved.sol(time_s[inside])
        state = solved.y[:, -1]
    return found


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_agrees_with_an_integration_of_the_scene(changes):
    scenario = scene(**changes)
    truth = truth_of(scenario)
    angle, rate = integrated(scenario, truth.time_s)
    np.testing.assert_allclose(truth.signals["axis.angle_rad"], angle, atol=1e-9)
    np.testing.assert_allclose(truth.signals["axis.rate_rad_s"], rate, atol=1e-9)
    np.testing.assert_array_equal(
        truth.signals["gyro.rate_rad_s"][:, 2], truth.signals["axis.rate_rad_s"]
    )


#: second derivative from nine values, of the eighth order
NINE = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_specific_force_is_the_change_of_the_place_seen_from_outside(changes):
    # knows nothing of rotating frames: differences of places, less free fall, turned back
    parameters = scene(**changes).parameters
    flank, radius = parameters["flank_s"], parameters["radius_m"]
    step = 0.02 / parameters["peak_rate_rad_s"]
    # inside every phase, so that no difference reaches over a corner of the torque
    middles = (np.array(table.CORNERS[1:]) + np.array(table.CORNERS[:-1])) / 2 * flank
    for middle in middles:
        times = middle + np.arange(-4, 5) * step
        found = table.reference(parameters, times)
        angle = found["axis.angle_rad"]
        places = radius * np.exp(1j * angle)
        seen = (NINE @ places) / step**2 * np.exp(-1j * angle[4])
        felt = found["accelerometer.specific_force_m_s2"][4]
        scale = parameters["peak_rate_rad_s"] ** 2 * radius
        np.testing.assert_allclose([felt[0], felt[1]], [seen.real, seen.imag], atol=1e-9 * scale)
        assert felt[2] == parameters["gravity_m_s2"]
        force = found["load_cell.force_N"][4]
        np.testing.assert_allclose(force, parameters["test_mass_kg"] * felt, rtol=1e-14)


def test_speeds_up_holds_and_reverses_as_the_file_promises():
    scenario = scene()
    rate = truth_of(scenario).signals["axis.rate_rad_s"]
    flank = 100  # samples
    np.testing.assert_allclose(rate[5 * flank : 8 * flank + 1], 10.0, rtol=1e-12)
    assert rate[-1] == pytest.approx(-7.5, rel=1e-12)
    assert rate[0] == 0


def test_the_core_reads_the_same_from_the_motion_up_to_its_differences():
    scenario = scene()
    truth = truth_of(scenario)
    signals = {name: truth.signals[name] for name in ("axis.angle_rad", "axis.rate_rad_s")}
    complete(scenario, truth.time_s, signals, input_values(scenario, truth.time_s))
    for name in ("gyro.rate_rad_s", "accelerometer.specific_force_m_s2"):
        # a step of 1 ms at 10 rad/s: (ω·step)² is 1e-4, and corners are rounded
        np.testing.assert_allclose(signals[name], truth.signals[name], atol=5e-3, err_msg=name)


def test_the_measures_find_both_terms():
    scenario = scene()
    truth = truth_of(scenario)
    found = {}
    for measure in scenario.measures:
        taken = measures.take(measure, scenario, truth)
        found.update({measure.name_of(k): v for k, v in taken.values.items()})
    # ω²ρ = 10²·0.1 and ω̇ρ = 10/0.4·0.1
    assert found["held_rate"] == pytest.approx(10.0)
    assert found["centripetal_term"] == pytest.approx(-10.0)
    assert found["lever_arm_term"] == pytest.approx(2.5)
    assert found["centripetal_force"] == pytest.approx(-0.5)
    assert found["lever_arm_force"] == pytest.approx(0.125)
    assert found["axial_force"] == pytest.approx(0.05 * 9.80665)
