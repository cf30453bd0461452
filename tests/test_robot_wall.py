"""The robot that nears a wall: its truth, and the pose filter with range, current and wheels."""

from __future__ import annotations

import numpy as np
import pytest

import simcompare
from simcompare.engine.sensing import complete
from simcompare.estimation import measuring
from simcompare.estimation.observing import observed
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.robot_motor import reference as motor
from simcompare.scenarios.robot_turn import reference as turn
from simcompare.scenarios.robot_wall import reference as wall
from simcompare.verbs import estimate_request

TIMES = np.linspace(0, 1.5, 16)


def defaults(name, **changes):
    return {**catalogue.load(name).resolve().parameters, **changes}


def test_at_equal_voltages_it_is_the_closed_form_of_the_robot_that_drives_straight():
    ours = wall.integrated(defaults("robot_wall", left_voltage_V=2.4, right_voltage_V=2.4), TIMES)
    known = motor.motion_at(defaults("robot_motor", voltage_V=2.4), TIMES)
    assert ours[0] == pytest.approx(known.distance_m, abs=1e-10)
    assert ours[3] == pytest.approx(known.speed_m_s, abs=1e-10)
    assert ours[1] == pytest.approx(np.zeros(16), abs=1e-12)


def test_motors_that_give_the_same_torque_at_any_rate_make_the_curve_of_given_torques():
    # N = η = 1 and k = R = 1e-9: a volt is a newton metre, and the back-EMF 1e-9 of it
    plain = {
        "torque_constant_N_m_A": 1e-9, "resistance_Ohm": 1e-9, "gear_ratio": 1.0, "efficiency": 1.0,
        "rotor_friction_N_m": 0.0, "rotor_damping_N_m_s_rad": 0.0, "rotor_inertia_kg_m2": 0.0,
        "rolling_resistance": 0.0, "left_voltage_V": 0.010, "right_voltage_V": 0.011,
    }  # fmt: skip
    times = TIMES[TIMES <= 0.8]
    ours = wall.integrated(defaults("robot_wall", **plain), times)
    # the damping of 1e-9 N·m·s turns 11 rad less by a part of 1e-6
    assert ours == pytest.approx(turn.integrated(defaults("robot_turn"), times), rel=5e-6, abs=1e-9)


def test_the_range_sensor_sees_the_wall_where_geometry_says():
    scene = catalogue.load("robot_wall").resolve()
    signals = wall.reference(scene.parameters, TIMES)
    inputs = {f"{s}_drive": signals[f"{s}_motor.voltage_V"] for s in ("left", "right")}
    complete(scene, TIMES, signals, inputs)
    seen = signals["ranger.range_m"][:, 27]
    x, y, heading = wall.integrated(scene.parameters, TIMES)[:3]
    along = (1.0 - x) / np.cos(heading) - 0.05
    zone = np.radians(2.8125)
    told = along * np.cos(heading) / (np.cos(heading) - np.tan(zone) * np.sin(heading))
    assert seen == pytest.approx(told, abs=1e-9)
    assert abs(y[-1]) > 0.03


def test_a_zone_of_a_range_sensor_and_a_motors_current_are_measured_by_their_sheets():
    scene = catalogue.load("robot_wall").resolve()
    estimator, plan = estimate_request.plan_of(scene, "pose_filter")
    assert observed("ranger.range_m.27", scene).component == 27
    time_s = np.arange(0.0, 1.0, 0.001)
    shapes = {name: (1000, width)[: min(width, 2)] for name, width in scene.signals().items()}
    still = Trajectory("still", time_s, {name: np.full(one, 0.5) for name, one in shapes.items()})
    given = measuring.given_of(scene, plan, still, measuring.devices_of(scene, plan, 0), 0)
    seen, current = given.signals["wall_range"], given.signals["left_current"]
    # 15 in a second, the first one before it is measured, at 20 ms
    assert len(seen.time_s) == 14
    # 1 % of about 0.5 m and a count of 1 mm, an rms of readings that are off by 5 % at most
    assert seen.u == pytest.approx(np.hypot(0.005, 0.001 / np.sqrt(12)), rel=0.06)
    # whole counts of 0.1 mA
    assert current.u == pytest.approx(1e-4 / np.sqrt(12))
    assert current.values / 1e-4 == pytest.approx(np.round(current.values / 1e-4), abs=1e-6)
    told = [estimator.as_told(plan.options, seed)["start_y_m"] for seed in range(400)]
    # 400 draws: 3.5 % of their spread
    assert np.std(told) == pytest.approx(plan.options["u_start_m"], rel=0.12)


@pytest.mark.engines("mujoco")
def test_the_filter_knows_its_error_of_pose_speeds_and_accelerations():
    found = simcompare.estimate("robot_wall", engine="mujoco", draws=12)
    (one,) = found.done
    assert one.nees.degrees_of_freedom == 7
    assert one.nees.outcome == "consistent", one.nees
    # 5 to 10 %: at a steady speed counting errors repeat, and are not white
    assert one.nis.value == pytest.approx((one.nis.low + one.nis.high) / 2, rel=0.1)
    alone, filtered = (
        one.error_of(way, "rate_rad_s").rms_error for way in ("wheels alone", "filtered")
    )
    assert filtered < alone / 5
    assert not any(reading.refused > 1 for reading in one.readings)
