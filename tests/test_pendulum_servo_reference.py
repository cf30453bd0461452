"""The pendulum on a servo: its reference against other integrations and closed forms, and logs."""

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare.engine.drives import laws_of
from simcompare.engine.simulation import sample_times
from simcompare.model.signals import Constant, Step, Table
from simcompare.scenarios import catalogue
from simcompare.scenarios.pendulum_servo import reference as servo

#: duty cycle for one radian and one unit of the firmware's gain: 4096 marks a turn, the gain is
#: divided by 256, full duty is 885
DUTY_RAD = 4096 / (2 * math.pi) / (256 * 885)


def scene(**changes):
    return catalogue.load("pendulum_servo").resolve(changes)


def moved(scenario, times=None, **inputs):
    times = sample_times(scenario) if times is None else times
    found = servo.reference(scenario.parameters, times, {**scenario.inputs, **inputs})
    start = scenario.parameters["start_angle_rad"]
    return times, found["hinge.angle_rad"] + start, found["hinge.rate_rad_s"]


@pytest.mark.parametrize(
    "changes",
    [{}, {"start_angle_rad": 0.5, "start_rate_rad_s": -1, "zero_rad": 0.02, "gain_V_rad": 17.0}],
    ids=["default", "from aside"],
)
def test_agrees_with_an_integration_of_the_scene(changes):
    scenario = scene(friction_N_m=0, **changes)
    times, angle, rate = moved(scenario)
    law, arm = laws_of(scenario)["hinge"], scenario.bodies["arm"]
    at = np.array(arm.position_m)
    inertia = arm.mass_kg * (at @ at) + arm.inertia_kg_m2[1] + law.armature
    first = math.atan2(-at[0], -at[2])
    gravity = -scenario.world.gravity_m_s2[2]
    sine = scenario.inputs["goal"]

    def change(t, y):
        goal = sine.amplitude * math.sin(2 * math.pi * sine.frequency_Hz * t)
        lean = first + y[0]
        # the weight acts at the centre of mass, which is at x = -l·sin θ
        torque = arm.mass_kg * gravity * -math.hypot(*at) * math.sin(lean)
        torque += law.gains["goal"] * goal - law.stiffness * (y[0] - law.rest)
        return [y[1], (torque - law.damping * y[1]) / inertia]

    solved = solve_ivp(
        change, (0, times[-1]), [0.0, scenario.joints["hinge"].rate], "DOP853",
        dense_output=True, rtol=1e-13, atol=1e-13, max_step=0.01,
    )  # fmt: skip
    expected = solved.sol(times)
    start = scenario.parameters["start_angle_rad"]
    np.testing.assert_allclose(angle, expected[0] + start, rtol=0, atol=1e-9)
    np.testing.assert_allclose(rate, expected[1], rtol=0, atol=2e-8)


def test_the_law_is_that_of_motor_and_gain():
    scenario = scene(torque_constant_N_m_A=0.3, resistance_Ohm=3.0, gain_V_rad=5.0)
    law = laws_of(scenario)["hinge"]
    # 5 V for one radian are 5/3 A, 0.5 N·m; 1 rad/s induces 0.3 V
    assert law.gains["goal"] == pytest.approx(0.5)
    assert law.stiffness == pytest.approx(0.5)
    assert law.damping == pytest.approx(0.3 * 0.3 / 3.0 + 0.005)


def test_it_stops_where_friction_makes_up_for_what_goal_and_weight_leave():
    scenario = scene(duration_s=8)
    p = scenario.parameters
    stiffness = p["torque_constant_N_m_A"] * p["gain_V_rad"] / p["resistance_Ohm"]
    weight = p["mass_kg"] * p["length_m"] * p["gravity_m_s2"]
    for goal in (0.5, 1.0, -1.3):
        _, angle, rate = moved(scenario, goal=Constant(signal="constant", value=goal))
        assert rate[-1] == 0
        left = stiffness * (goal - angle[-1]) - weight * math.sin(angle[-1])
        assert abs(left) <= p["friction_N_m"]
        # friction/K to either side of where it would stop without friction
        assert abs(goal - angle[-1] - weight / stiffness * math.sin(angle[-1])) <= (
            p["friction_N_m"] / stiffness
        )


def test_a_goal_within_the_friction_does_not_move_it():
    scenario = scene()
    p = scenario.parameters
    stiffness = p["torque_constant_N_m_A"] * p["gain_V_rad"] / p["resistance_Ohm"]
    held = p["friction_N_m"] / stiffness
    for part, moves in ((0.999, False), (1.001, True)):
        goal = Step(signal="step", after=part * held, time_s=0.5)
        _, angle, _ = moved(scenario, goal=goal)
        assert bool(np.any(angle)) is moves


def test_a_small_step_is_answered_as_by_a_system_of_second_order():
    scenario = scene(friction_N_m=0, torque_constant_N_m_A=0.2)
    body = servo.pendulum_of(scenario.parameters)
    times, angle, _ = moved(scenario, goal=Step(signal="step", after=1e-4, time_s=0))
    stiff = body.stiffness + body.weight
    omega = math.sqrt(stiff / body.inertia)
    zeta = body.damping / (2 * math.sqrt(stiff * body.inertia))
    damped = omega * math.sqrt(1 - zeta**2)
    phase = damped * times
    fading = np.exp(-zeta * omega * times)
    answer = 1 - fading * (np.cos(phase) + zeta / math.sqrt(1 - zeta**2) * np.sin(phase))
    final = 1e-4 * body.stiffness / stiff
    np.testing.assert_allclose(angle, final * answer, rtol=0, atol=1e-7 * final)


def test_the_servo_holds_what_its_sensor_reads():
    # without weight it goes where the sensor reads the goal, whatever the sensor's zero is
    scenario = scene(friction_N_m=0, gravity_m_s2=0, zero_rad=0.1, duration_s=10)
    _, angle, _ = moved(scenario, goal=Constant(signal="constant", value=0.3))
    assert angle[-1] == pytest.approx(0.3, abs=1e-9)
    # with weight it hangs lower than the goal; the lean is counted from hanging
    scenario = scene(friction_N_m=0, zero_rad=0.1, duration_s=10)
    _, angle, _ = moved(scenario, goal=Constant(signal="constant", value=0.3))
    body = servo.pendulum_of(scenario.parameters)
    assert body.stiffness * (0.3 - angle[-1]) == pytest.approx(
        body.weight * math.sin(angle[-1] - 0.1), abs=1e-9
    )


# --- logs of a real one -------------------------------------------------------------------------


def log_of(stamp):
    folder = os.environ.get("SIMCOMPARE_DATA")
    if not folder:
        pytest.skip("SIMCOMPARE_DATA does not name a folder with the recordings")
    path = Path(folder) / "servo_pendulum_xl330" / "xl330_raw" / f"2026-01-15_{stamp}.json"
    if not path.is_file():
        pytest.skip(f"{path} is not here")
    found = json.loads(path.read_text(encoding="utf-8"))
    columns = ("timestamp", "goal_position", "position", "load")
    return found["kp"], np.array([[entry[c] for c in columns] for entry in found["entries"]])


RUNS = [
    ("10h28m10", 0.0), ("10h28m24", 0.0), ("10h28m32", 0.0), ("10h28m42", 0.0), ("10h28m57", 0.0),
    ("10h29m04", 0.0), ("10h29m14", 0.026), ("10h29m37", 0.038), ("10h29m47", 0.257),
    ("10h30m02", 0.486),
]  # fmt: skip


@pytest.mark.parametrize(("stamp", "limited"), RUNS)
def test_the_log_itself_tells_the_gain_and_where_the_voltage_is_limited(stamp, limited):
    gain, log = log_of(stamp)
    # what is called load is the duty cycle, in 16 bits with a sign
    duty = np.where(log[:, 3] > 32767, log[:, 3] - 65536, log[:, 3]) / 885
    free = np.abs(duty) < 0.995
    asked = gain * DUTY_RAD * (log[:, 1] - log[:, 2])
    slope = duty[free] @ asked[free] / (asked[free] @ asked[free])
    # goal and position are read some ms apart, which fast goals show
    assert slope == pytest.approx(1, abs=0.025)
    assert np.mean(~free) == pytest.approx(limited, abs=0.003)


def missed(stamp, **parameters):
    gain, log = log_of(stamp)
    times = log[:, 0] - log[0, 0]
    changes = {"gain_V_rad": gain * DUTY_RAD * 7.3, "start_angle_rad": log[0, 2], **parameters}
    scenario = scene(duration_s=6, **changes)
    goal = Table(signal="table", time_s=tuple(times), value=tuple(log[:, 1]))
    _, angle, _ = moved(scenario, times, goal=goal)
    return float(np.sqrt(np.mean((angle - log[:, 2]) ** 2)))


def test_a_fast_goal_is_followed_as_in_the_log_and_a_slow_one_is_not():
    # fitted to the first; the second has twice the gain
    fitted = {"torque_constant_N_m_A": 0.377, "friction_N_m": 0.024, "rotor_inertia_kg_m2": 0.0019}
    assert missed("10h28m32", **fitted, zero_rad=-0.02) < 0.025
    assert missed("10h29m04", **fitted) < 0.06
    # where the arm is held aside the gear's friction grows with the load, which a constant cannot
    assert missed("10h28m57", **fitted) > 0.15
