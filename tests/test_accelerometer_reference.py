"""The accelerometers' closed forms against independent integrations, formulas and matrices."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from simcompare import measures
from simcompare.engine.drives import input_values
from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.accelerometer import reference as seismic
from simcompare.scenarios.accelerometer_chirp import reference as swept
from simcompare.scenarios.accelerometer_fall import reference as falling
from simcompare.scenarios.accelerometer_force import reference as rigid
from simcompare.scenarios.accelerometer_tilt import reference as tilted
from simcompare.scenarios.robot_accelerometer import reference as driving

G = 9.80665
CHANGES = [
    {},
    {"damping_ratio": 0.3},
    {"damping_ratio": 1.0},
    {"base_mass_kg": 0.01},
    {"base_mass_kg": 0.01, "damping_ratio": 1 / math.sqrt(2)},  # critically damped with its base
    {"natural_frequency_Hz": 3.0, "acceleration_m_s2": 0.2},
]


def scene(name, changes=None, **more):
    return catalogue.load(name).resolve(changes or {}, **more)


def truth_of(scenario, reference):
    times = sample_times(scenario)
    return Trajectory("closed form", times, reference(scenario.parameters, times))


def integrated(scenario, force, edges_s, time_s):
    """Positions of both masses by DOP853, each with its own Newton's law, in the world's frame."""
    base, mass = scenario.bodies["base"].mass_kg, scenario.bodies["mass"].mass_kg
    spring = scenario.joints["spring"]

    def motion(t, state):
        y, z, v, w = state
        pull = spring.stiffness * (z - y) + spring.damping * (w - v)
        return [v, w, (force(t) + pull) / base, -pull / mass]

    state, found = np.zeros(4), np.zeros((4, len(time_s)))
    for start, end in pairwise(edges_s):
        solved = solve_ivp(
            motion, (start, end), state, "DOP853", rtol=1e-13, atol=1e-18, dense_output=True
        )
        inside = (time_s >= start) & (time_s <= end)
        found[:, inside] = solved.sol(time_s[inside])
        state = solved.y[:, -1]
    return found


def assert_moves_like(found, wanted):
    y, z, v, w = wanted
    for part, expected in (
        ("slide.position_m", y),
        ("slide.velocity_m_s", v),
        ("spring.position_m", z - y),
        ("spring.velocity_m_s", w - v),
    ):
        scale = np.abs(expected).max()
        np.testing.assert_allclose(found[part] / scale, expected / scale, atol=1e-9, err_msg=part)


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_dwells_agree_with_an_integration_of_both_masses(changes):
    scenario = scene("accelerometer", changes)
    shaking = scenario.inputs["shaking"]
    edges = np.arange(5) * shaking.dwell_s
    times = np.linspace(0, edges[-1], 997)
    forces = []
    for frequency, start in zip(shaking.frequencies_Hz, edges, strict=False):
        forces.append((start, 2 * math.pi * frequency))

    def force(t):
        # the integration ends at every edge, so which dwell holds the edge itself does not matter
        start, omega = forces[min(int(t / shaking.dwell_s), 3)]
        return shaking.amplitude * math.cos(omega * (t - start))

    wanted = integrated(scenario, force, edges, times)
    assert_moves_like(seismic.reference(scenario.parameters, times), wanted)


@pytest.mark.parametrize("changes", CHANGES[:4], ids=str)
def test_sweep_agrees_with_an_integration_of_both_masses(changes):
    scenario = scene("accelerometer_chirp", {"sweep_periods": 40, **changes})
    sweep = scenario.inputs["sweep"]
    growth = math.log(sweep.end_Hz / sweep.start_Hz) / sweep.duration_s

    def force(t):
        turns = sweep.start_Hz * math.expm1(growth * t) / growth
        return sweep.amplitude * math.cos(2 * math.pi * turns)

    times = np.linspace(0, sweep.duration_s, 997)
    wanted = integrated(scenario, force, (0, sweep.duration_s), times)
    assert_moves_like(swept.reference(scenario.parameters, times), wanted)


def test_motion_does_not_depend_on_where_it_is_sampled():
    parameters = scene("accelerometer").parameters
    fine = np.arange(2001) * 5e-4
    # times that no step reaches, one of them within rounding of the end of a dwell
    coarse = np.array([0.0, 0.0123, 0.25 + 1e-13, 0.3333, 1.0])
    found = seismic.reference(parameters, coarse)["spring.position_m"]
    whole = seismic.reference(parameters, np.union1d(fine, coarse))["spring.position_m"]
    np.testing.assert_allclose(
        found, whole[np.searchsorted(np.union1d(fine, coarse), coarse)], atol=1e-17
    )


@given(ratio=st.floats(0.01, 10), damping=st.floats(0.05, 2))
def test_response_is_the_textbook_formula(ratio, damping):
    parameters = {"natural_frequency_Hz": 40.0, "damping_ratio": damping}
    found = seismic.response(parameters, np.array([ratio * 40]))[0]
    size = 1 / math.sqrt((1 - ratio**2) ** 2 + (2 * damping * ratio) ** 2)
    assert abs(found) == pytest.approx(size, rel=1e-12)
    phase = -math.atan2(2 * damping * ratio, 1 - ratio**2)
    assert np.angle(found) == pytest.approx(phase, rel=1e-12)


@pytest.mark.parametrize(("damping", "ratio"), [(0.5, 1.272), (math.sqrt(0.5), 1.0), (1, 0.6436)])
def test_response_falls_to_half_the_power_where_the_formula_says(damping, ratio):
    parameters = {"natural_frequency_Hz": 1.0, "damping_ratio": damping}

    def above(u):
        return abs(seismic.response(parameters, np.array([u]))[0]) - math.sqrt(0.5)

    found = brentq(above, 0.2, 2)
    term = 2 * damping**2
    assert found == pytest.approx(math.sqrt(1 - term + math.sqrt(term**2 - 2 * term + 2)))
    assert found == pytest.approx(ratio, abs=5e-4)


@pytest.mark.parametrize("damping", [0.3, 0.7, 1.0])
def test_noise_bandwidth_of_the_response_is_that_of_the_formula(damping):
    parameters = {"natural_frequency_Hz": 1.0, "damping_ratio": damping}

    def power(f):
        return abs(seismic.response(parameters, np.array([f]))[0]) ** 2

    found = quad(power, 0, 3, epsabs=1e-12)[0] + quad(power, 3, math.inf, epsabs=1e-12)[0]
    assert found == pytest.approx(math.pi / (4 * damping), rel=1e-8)


@pytest.mark.parametrize("changes", CHANGES[:1] + CHANGES[3:], ids=str)
def test_dwells_measure_the_textbook_response_to_a_millionth(changes):
    scenario = scene("accelerometer", changes)
    found = measures.take(scenario.measures[0], scenario, truth_of(scenario, seismic.reference))
    wanted = seismic.response(scenario.parameters, found.series["frequency"])
    assert found.series["frequency"] == pytest.approx(scenario.inputs["shaking"].frequencies_Hz)
    np.testing.assert_allclose(found.series["amplitude"], np.abs(wanted), rtol=1e-6)
    np.testing.assert_allclose(found.series["phase"], np.degrees(np.angle(wanted)), atol=5e-5)


@pytest.mark.parametrize("changes", CHANGES[:4], ids=str)
def test_sweep_measures_the_textbook_response(changes):
    scenario = scene("accelerometer_chirp", changes)
    found = measures.take(scenario.measures[0], scenario, truth_of(scenario, swept.reference))
    frequency = found.series["frequency"]
    wanted = seismic.response(scenario.parameters, frequency)
    ratio = found.series["amplitude"] * np.exp(1j * np.radians(found.series["phase"])) / wanted
    judged = frequency <= scenario.measures[0].options["judged_up_to_Hz"]
    assert np.abs(ratio - 1)[judged].max() < 1e-6
    # close to where the fading begins, which the scenario does not judge
    assert np.abs(ratio - 1).max() < 5e-4


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_scenarios_are_built_of_what_their_references_compute(changes):
    scenario = scene("accelerometer", changes)
    parameters, shaking = scenario.parameters, scenario.inputs["shaking"]
    natural = parameters["natural_frequency_Hz"]
    assert shaking.frequencies_Hz == pytest.approx([r * natural for r in seismic.RATIOS])
    assert shaking.dwell_s == pytest.approx(parameters["dwell_periods"] / natural)
    assert shaking.amplitude == pytest.approx(seismic.force_amplitude(parameters))
    assert scenario.world.duration_s == pytest.approx(len(seismic.RATIOS) * shaking.dwell_s)
    spring, mass = scenario.joints["spring"], parameters["seismic_mass_kg"]
    rate = math.sqrt(spring.stiffness / mass)
    assert rate == pytest.approx(2 * math.pi * natural)
    assert spring.damping / (2 * math.sqrt(spring.stiffness * mass)) == pytest.approx(
        parameters["damping_ratio"]
    )
    assert scenario.measures[0].options["gain"] == pytest.approx(-(rate**2))
    sweep = scene("accelerometer_chirp", changes).inputs["sweep"]
    assert sweep.start_Hz == pytest.approx(swept.START * natural)
    assert sweep.end_Hz == pytest.approx(swept.END * natural)
    assert sweep.duration_s == pytest.approx(100 / natural)
    assert sweep.amplitude == pytest.approx(seismic.force_amplitude(parameters))


# --- a mass held by a force sensor ------------------------------------------------------------


def test_rigid_sensor_agrees_with_an_integration_and_with_newton():
    scenario = scene("accelerometer_force", {"base_mass_kg": 0.3, "acceleration_m_s2": 3})
    total = 0.3 + scenario.parameters["seismic_mass_kg"]
    shaking, push = scenario.inputs["shaking"], scenario.inputs["push"]
    times = sample_times(scenario)
    found = rigid.reference(scenario.parameters, times)
    # what the inputs themselves push with, over all that moves
    wanted = (shaking.at(times) + push.at(times)) / total
    mass = scenario.parameters["seismic_mass_kg"]
    np.testing.assert_allclose(found["cell.force_N"][:, 0], mass * wanted, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(found["cell.force_N"][:, 1], 0)
    np.testing.assert_allclose(found["cell.force_N"][:, 2], mass * G)

    state = np.zeros(2)
    for start in (0.0, 0.1, 0.2, 0.3):
        end = start + 0.1 if start < 0.3 else 0.5
        inside = (times >= start) & (times <= end)

        def motion(t, state, middle=(start + end) / 2, start=start):
            # cosines go on where the dwell ends; the time of the middle tells which dwell it is
            place = min(int(middle / shaking.dwell_s), 3)
            if place == 3:
                return [state[1], push.after / total]
            omega = 2 * math.pi * shaking.frequencies_Hz[place]
            return [state[1], shaking.amplitude / total * math.cos(omega * (t - start))]

        solved = solve_ivp(
            motion, (start, end), state, "DOP853", rtol=1e-13, atol=1e-16, dense_output=True
        )
        position, velocity = solved.sol(times[inside])
        np.testing.assert_allclose(found["slide.position_m"][inside], position, atol=1e-11)
        np.testing.assert_allclose(found["slide.velocity_m_s"][inside], velocity, atol=1e-11)
        state = solved.y[:, -1]


def test_rigid_sensor_measures_one_at_every_frequency():
    scenario = scene("accelerometer_force")
    truth = truth_of(scenario, rigid.reference)
    pushed, weight, found = (measures.take(m, scenario, truth) for m in scenario.measures)
    np.testing.assert_allclose(found.series["frequency"], rigid.FREQUENCIES_HZ)
    np.testing.assert_allclose(found.series["amplitude"], 1, rtol=1e-9)
    np.testing.assert_allclose(found.series["phase"], 0, atol=1e-7)
    mass = scenario.parameters["seismic_mass_kg"]
    assert pushed.values["mean"] == pytest.approx(mass * 2.0, rel=1e-12)
    assert weight.values["mean"] == pytest.approx(mass * G, rel=1e-12)


# --- tilt and fall ------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [-1.5, -0.7, 0.0, 1e-6, 0.3, 1.2])
def test_tilted_reading_is_gravity_in_the_frame_of_the_base(angle):
    scenario = scene("accelerometer_tilt", {"tilt_rad": angle})
    w, x, y, z = scenario.bodies["base"].orientation_wxyz
    to_world = Rotation.from_quat((x, y, z, w))
    np.testing.assert_allclose(to_world.as_rotvec(), (0, angle, 0), atol=1e-12)
    weight = scenario.parameters["seismic_mass_kg"] * np.array((0, 0, G))
    found = tilted.reference(scenario.parameters, np.zeros(3))["cell.force_N"]
    np.testing.assert_allclose(found, np.tile(to_world.inv().apply(weight), (3, 1)), atol=1e-15)
    assert scenario.bodies["mass"].orientation_wxyz == scenario.bodies["base"].orientation_wxyz


def test_a_base_whose_front_goes_down_reads_backward():
    scenario = scene("accelerometer_tilt", {"tilt_rad": math.pi / 6})
    force = tilted.reference(scenario.parameters, np.zeros(1))["cell.force_N"][0]
    mass = scenario.parameters["seismic_mass_kg"]
    np.testing.assert_allclose(force / mass, (-G / 2, 0, G * math.sqrt(3) / 2), rtol=1e-12)


@pytest.mark.parametrize("angle", [-1.5, -0.7, 0.0, 1e-6, 0.3, 1.2])
def test_the_tilt_follows_from_the_reading(angle):
    scenario = scene("accelerometer_tilt", {"tilt_rad": angle})
    truth = truth_of(scenario, tilted.reference)
    found = measures.take(scenario.measures[2], scenario, truth)
    assert found.values["pitch"] == pytest.approx(angle, abs=1e-12)
    assert found.values["roll"] == pytest.approx(0, abs=1e-12)


def test_what_falls_freely_reads_nothing_though_it_accelerates():
    scenario = scene("accelerometer_fall")
    truth = truth_of(scenario, falling.reference)
    signals = dict(truth.signals)
    complete(scenario, truth.time_s, signals, {})
    # differences of positions of some decimetres, over a millisecond squared
    np.testing.assert_allclose(signals["ideal.specific_force_m_s2"], 0, atol=1e-8)
    np.testing.assert_allclose(signals["cell.force_N"], 0)
    start = scenario.bodies["base"]
    np.testing.assert_allclose(signals["base.position_m"][0], start.position_m)
    np.testing.assert_allclose(signals["base.velocity_m_s"][0], start.velocity_m_s)
    speed = np.gradient(signals["base.position_m"][:, 2], truth.time_s)
    np.testing.assert_allclose(speed[1:-1], signals["base.velocity_m_s"][1:-1, 2], atol=1e-9)


# --- on the robot -------------------------------------------------------------------------------


@pytest.mark.parametrize("torque", [0.02, 0.03, 0.06], ids=["rolls", "rolls faster", "slides"])
def test_on_the_robot_it_reads_what_follows_from_the_robots_positions(torque):
    scenario = scene("robot_accelerometer", {"torque_N_m": torque})
    truth = truth_of(scenario, driving.reference)
    signals = dict(truth.signals)
    complete(scenario, truth.time_s, signals, input_values(scenario, truth.time_s))
    mass = scenario.parameters["seismic_mass_kg"]
    # second differences of positions of some metres, over a millisecond squared
    reading = signals["cell.force_N"] / mass
    np.testing.assert_allclose(signals["ideal.specific_force_m_s2"], reading, atol=1e-8)
    # the mass itself goes where the body's centre of mass goes
    np.testing.assert_allclose(signals["mass.position_m"], signals["chassis.position_m"])


def test_on_the_robot_it_reads_the_known_acceleration():
    scenario = scene("robot_accelerometer")
    force = driving.reference(scenario.parameters, np.zeros(1))["cell.force_N"][0]
    mass = scenario.parameters["seismic_mass_kg"]
    np.testing.assert_allclose(force / mass, (1.953602, 0, G), rtol=1e-6)


@pytest.mark.parametrize("mass", [0.001, 0.01, 0.04])
def test_the_seismic_mass_is_a_part_of_the_robots_body(mass):
    scenario = scene("robot_accelerometer", {"seismic_mass_kg": mass})
    chassis, seismic_mass = scenario.bodies["chassis"], scenario.bodies["mass"]
    whole = chassis.mass_kg + seismic_mass.mass_kg
    assert whole == pytest.approx(scene("robot").bodies["chassis"].mass_kg)
    assert seismic_mass.position_m == chassis.position_m


@pytest.mark.parametrize("damping", [0.3, 0.5, 0.7, 0.9, 1.0])
def test_the_cutoff_of_the_truth_is_that_of_the_formula(damping):
    scenario = scene("accelerometer", {"damping_ratio": damping})
    (response,) = scenario.measures
    spread = 1 - 2 * damping**2
    formula = 40 * math.sqrt(spread + math.sqrt(spread**2 + 1))
    found = measures.take(response, scenario, truth_of(scenario, seismic.reference))
    # 1e-5: what is left of the transient after a dwell has settled, exp(-11) or less
    assert found.values["cutoff_frequency"] == pytest.approx(formula, rel=1e-5)
