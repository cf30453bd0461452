"""The motor bench: its closed form against an integration, and what its measures find in it."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare import measures
from simcompare.engine.drives import input_values, laws_of
from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.hardware.motors.dc_motor import Housing, Motor
from simcompare.hardware.sensors import encoder
from simcompare.measures import Request, encoder_speed, motor_curves
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.motor_bench import reference as bench

CHANGES = [
    {},
    {"damping_N_m_s_rad": 0.0},
    {"inertia_kg_m2": 3e-6, "brake_part": 0.3, "ramp_s": 0.5},
    {"voltage_V": 12.0, "resistance_Ohm": 2.0, "run_up_s": 0.05, "lever_m": 0.1},
]


def scene(**changes):
    return catalogue.load("motor_bench").resolve(changes)


def truth_of(scenario):
    times = sample_times(scenario)
    return Trajectory("closed form", times, bench.reference(scenario.parameters, times))


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_agrees_with_an_integration_of_the_scene(changes):
    scenario = scene(**changes)
    truth = truth_of(scenario)
    motor, disk = scenario.actuators["motor"], scenario.bodies["disk"]
    brake = scenario.actuators["brake"]

    def motion(t, state):
        given = {name: row[0] for name, row in input_values(scenario, np.array([t])).items()}
        k = motor.torque_constant_N_m_A
        current = (given[motor.input] - k * state[1]) / motor.resistance_Ohm
        friction = motor.rotor_friction_N_m + motor.rotor_damping_N_m_s_rad * state[1]
        torque = k * current - friction - brake.gear * given[brake.input]
        return [state[1], torque / disk.inertia_kg_m2[1]]

    state, start = np.zeros(2), 0.0
    for end in (scenario.inputs["tension"].start_s, truth.time_s[-1]):
        inside = (truth.time_s >= start) & (truth.time_s <= end)
        solved = solve_ivp(
            motion, (start, end), state, "DOP853", dense_output=True, rtol=1e-13, atol=1e-13,
            max_step=0.002,
        )  # fmt: skip
        angle, rate = solved.sol(truth.time_s[inside])
        # the angle is of some hundred radians
        np.testing.assert_allclose(truth.signals["shaft.angle_rad"][inside], angle, rtol=1e-9)
        np.testing.assert_allclose(truth.signals["shaft.rate_rad_s"][inside], rate, rtol=1e-9)
        state, start = solved.y[:, -1], end


def test_the_arm_is_in_balance():
    # torques about the axis: brake, weight of the arm at its middle, scale at its end
    scenario = scene()
    truth = truth_of(scenario)
    arm = scenario.bodies["arm"]
    tip = arm.position_m[0] + arm.shapes[0].position_m[0]
    brake = input_values(scenario, truth.time_s)["tension"]
    weight = arm.mass_kg * -scenario.world.gravity_m_s2[2] * arm.position_m[0]
    np.testing.assert_allclose(
        truth.signals["scale.normal_force_N"] * tip, brake + weight, rtol=1e-12
    )
    # it touches where it is drawn
    floor = scenario.bodies["frame"].shapes[0]
    assert floor.position_m[2] == -arm.shapes[0].radius_m
    # and stands still while the disk turns
    turned = truth.signals["shaft.angle_rad"] + truth.signals["band.angle_rad"]
    assert np.abs(turned).max() == 0


def test_the_core_reads_the_same_motor_and_encoder():
    scenario = scene()
    truth = truth_of(scenario)
    signals = {
        name: truth.signals[name]
        for joint in ("shaft", "band")
        for name in (f"{joint}.angle_rad", f"{joint}.rate_rad_s")
    }
    complete(scenario, truth.time_s, signals, input_values(scenario, truth.time_s))
    np.testing.assert_array_equal(signals["encoder.marks"], truth.signals["encoder.marks"])
    for name in ("motor.current_A", "motor.torque_N_m"):
        # differences over 1 ms where the shaft runs up within 20
        np.testing.assert_allclose(signals[name], truth.signals[name], rtol=2e-3, err_msg=name)


def test_the_law_that_engines_get_is_that_of_the_closed_form():
    scenario = scene()
    standstill, fall = bench.constants(scenario.parameters)
    law = laws_of(scenario)["shaft"]
    assert law.damping == pytest.approx(fall)
    assert law.gains["supply"] * 6.0 - law.friction == pytest.approx(standstill)
    assert law.armature == 0


@pytest.mark.parametrize("changes", [{}, {"damping_N_m_s_rad": 0.0}], ids=str)
def test_the_curves_are_those_of_the_data_sheet(changes):
    scenario = scene(**changes)
    found = measures.take(scenario.measures[0], scenario, truth_of(scenario))
    p = scenario.parameters
    motor = Motor(6.0, 5.5e-3, 4e-4, p["damping_N_m_s_rad"])
    values = found.values
    # what differences over a step and the corner of the ramp leave
    assert values["no_load_speed"] == pytest.approx(motor.speed_at(6.0, 0.0), rel=1e-5)
    assert values["no_load_current"] == pytest.approx(motor.current_at(6.0, 0.0), rel=1e-5)
    assert values["stall_torque"] == pytest.approx(motor.starting_torque(6.0), rel=1e-5)
    assert values["stall_current"] == pytest.approx(1.0, rel=1e-5)
    assert values["maximum_power"] == pytest.approx(motor.maximum_power(6.0), rel=1e-5)
    assert values["maximum_efficiency"] == pytest.approx(motor.maximum_efficiency(6.0), rel=1e-5)
    best_speed = motor.most_efficient_speed(6.0)
    best_torque = motor.starting_torque(6.0) - motor.slope * best_speed
    assert values["most_efficient_torque"] == pytest.approx(best_torque, rel=1e-5)
    assert values["most_efficient_speed"] == pytest.approx(best_speed, rel=1e-5)
    for torque, speed, current, efficiency in zip(
        *(found.series[name] for name in ("torque", "speed", "current", "efficiency")), strict=True
    ):
        assert speed == pytest.approx(motor.speed_at(6.0, torque), rel=1e-4)
        assert current == pytest.approx(motor.current_at(6.0, torque), rel=1e-4)
        assert efficiency == pytest.approx(motor.efficiency_at(6.0, torque), rel=1e-3)
    # evenly spaced once the disk slows evenly
    assert len(found.series["torque"]) == 20
    np.testing.assert_allclose(np.diff(found.series["torque"])[2:], 0.8 * 5.1e-3 / 20, rtol=0.01)


def test_published_numbers_without_viscous_friction():
    scenario = scene(damping_N_m_s_rad=0.0)
    found = measures.take(scenario.measures[0], scenario, truth_of(scenario)).values
    assert found["no_load_speed"] == pytest.approx(1011.6, abs=0.05)
    assert found["no_load_current"] == pytest.approx(72.7e-3, abs=5e-5)
    assert found["maximum_efficiency"] == pytest.approx(0.5334, abs=5e-5)
    assert found["maximum_power"] == pytest.approx(1.28975, abs=2e-5)


def test_the_heat_is_what_winding_and_friction_make():
    scenario = scene()
    found = measures.take(scenario.measures[0], scenario, truth_of(scenario)).values
    t = np.linspace(0, 1.16, 200_001)
    rate = bench.motion(scenario.parameters, t)[1]
    current = (6.0 - 5.5e-3 * rate) / 6.0
    loss = 6.0 * current**2 + 4e-4 * rate + 2e-7 * rate**2
    # steps of 1 ms are a twentieth of the time constant of running up
    assert found["heat"] == pytest.approx(np.trapezoid(loss, t), rel=2e-3)
    warm = Housing(30.0, 8.0).along(loss[::20], t[::20])
    assert found["temperature_rise"] == pytest.approx(warm[-1] - 293.15, rel=2e-3)


def test_the_slowing_disk_would_look_like_efficiency():
    # without J·ω̇ the bench credits the motor with what the disk gives back
    scenario = scene(inertia_kg_m2=5e-7)
    measure = scenario.measures[0]
    truth = truth_of(scenario)
    honest = measures.take(measure, scenario, truth).values["maximum_efficiency"]
    naive = measure.model_copy(update={"options": {**measure.options, "inertia_kg_m2": 0.0}})
    assert measures.take(naive, scenario, truth).values["maximum_efficiency"] > 1.1 * honest


def made(force, angle, t):
    n = len(t)
    signals = {"f": force, "a": angle, "i": np.full(n, 1.0), "v": np.full(n, 6.0)}
    also = {
        role: Probe(observe=name, label=role, unit="1")
        for role, name in (("angle", "a"), ("current", "i"), ("voltage", "v"))
    }
    options = {
        "lever_m": 0.03, "inertia_kg_m2": 0.0, "start_s": 0.0, "end_s": 1.0, "count": 10,
        "thermal_resistance_K_W": 30.0, "heat_capacity_J_K": 8.0,
    }  # fmt: skip
    request = Request(Probe(observe="f", label="f", unit="N"), also, options)
    return motor_curves.measure(Trajectory("made", t, signals), request)


def test_a_shaft_that_does_not_turn_has_no_curves_but_heat():
    t = np.linspace(0, 1, 1001)
    found = made(np.zeros(1001), np.zeros(1001), t)
    assert all(
        found.values[name] is None
        for name in (
            "no_load_speed",
            "stall_torque",
            "maximum_power",
            "maximum_efficiency",
            "most_efficient_torque",
            "most_efficient_speed",
        )
    )
    assert found.values["heat"] == pytest.approx(6.0)
    assert found.values["temperature_rise"] == pytest.approx(6.0 * 30 * -math.expm1(-1 / 240))


def test_the_encoder_measure_finds_its_own_resolution():
    scenario = scene()
    found = measures.take(scenario.measures[1], scenario, truth_of(scenario))
    values = found.values
    assert values["gate_resolution"] == pytest.approx(6.283, abs=5e-4)
    # the root mean square of 23 gates is no better known than to a seventh
    assert values["counting_error"] == pytest.approx(values["gate_uncertainty"], rel=0.3)
    assert values["largest_counting_error"] <= values["gate_resolution"]
    assert values["largest_timing_error"] <= 1.01 * encoder.period_resolution(20, 1e-6, 973.0)
    timed = found.series["timed_speed"]
    mean = np.interp(
        found.series["period_time"], found.series["gate_time"], found.series["mean_speed"]
    )
    # later gates, where the speed falls evenly
    np.testing.assert_allclose(timed[5:], mean[5:], atol=4.0)


def test_timing_is_the_better_one_at_low_speed():
    t = np.arange(5001) * 0.001
    angle = 5.0 * t
    marks = np.floor(angle * 20 / (2 * math.pi))
    request = Request(
        Probe(observe="m", label="m", unit="1"),
        {"angle": Probe(observe="a", label="a", unit="rad")},
        {"marks": 20, "gate_s": 0.5, "tick_s": 1e-6},
    )
    found = encoder_speed.measure(Trajectory("made", t, {"m": marks, "a": angle}), request)
    assert found.values["largest_timing_error"] < 1e-4
    assert found.values["counting_error"] > 0.05
    assert len(found.series["gate_time"]) == 10


def test_a_shaft_that_stands_still_before_it_turns_is_timed_all_the_same():
    t = np.arange(1001) * 0.001
    angle = np.maximum(0.0, 50.0 * (t - 0.002))
    request = Request(
        Probe(observe="m", label="m", unit="1"),
        {"angle": Probe(observe="a", label="a", unit="rad")},
        {"marks": 20, "gate_s": 0.1, "tick_s": 1e-6},
    )
    signals = {"m": np.floor(angle * 20 / (2 * math.pi)), "a": angle}
    found = encoder_speed.measure(Trajectory("made", t, signals), request)
    assert found.values["largest_timing_error"] <= 1.01 * encoder.period_resolution(20, 1e-6, 50.0)


def test_a_shaft_that_turns_back_cannot_be_timed():
    t = np.arange(1001) * 0.001
    angle = np.sin(10 * t)
    request = Request(
        Probe(observe="m", label="m", unit="1"),
        {"angle": Probe(observe="a", label="a", unit="rad")},
        {"marks": 20, "gate_s": 0.1, "tick_s": 1e-6},
    )
    signals = {"m": np.floor(angle * 20 / (2 * math.pi)), "a": angle}
    found = encoder_speed.measure(Trajectory("made", t, signals), request)
    assert found.values["largest_timing_error"] is None
    assert found.values["largest_counting_error"] <= found.values["gate_resolution"]
