"""Sensors that follow from the motion, and bodies that follow from joints."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare.engine import sensing
from simcompare.engine.kinematics import add_children, in_order
from simcompare.model.rotations import (
    conjugate,
    multiply,
    quaternions_of,
    rotate,
    rotation_vector_of,
    rotation_vectors_of,
)
from simcompare.model.scenario import Scenario

ANGLES = st.floats(-3.0, 3.0)


def two_links(**more):
    """A link that turns about -y on a post, and on it a slider along its own tilted x axis."""
    tree = {
        "name": "links", "title": "Links", "question": "Where are they?",
        "world": {"duration_s": 1.0},
        "bodies": {
            "post": {"fixed": True, "position_m": [1, 2, 3]},
            "arm": {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "position_m": [1.5, 2, 3],
                    "orientation_wxyz": [math.cos(0.3), 0, math.sin(0.3), 0]},
            "cart": {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "position_m": [2.0, 2, 3.1]},
        },
        "joints": {
            "rail": {"type": "slider", "parent": "arm", "child": "cart", "axis": [2, 0, 0]},
            "shoulder": {"type": "hinge", "parent": "post", "child": "arm", "axis": [0, -1, 0]},
        },
        **more,
    }  # fmt: skip
    return Scenario.model_validate(tree)


def moved(scenario, angle, shift):
    t = np.linspace(0, 1, 201)
    signals = {
        "shoulder.angle_rad": angle(t), "shoulder.rate_rad_s": np.gradient(angle(t), t),
        "rail.position_m": shift(t), "rail.velocity_m_s": np.gradient(shift(t), t),
    }  # fmt: skip
    add_children(scenario, signals, len(t))
    return t, signals


def test_joints_come_after_those_that_carry_them():
    assert list(in_order(two_links())) == ["shoulder", "rail"]


def test_bodies_are_where_they_are_drawn_when_the_coordinates_are_zero():
    scenario = two_links()
    _, signals = moved(scenario, np.zeros_like, np.zeros_like)
    for name in ("arm", "cart"):
        body = scenario.bodies[name]
        np.testing.assert_allclose(signals[f"{name}.position_m"][7], body.position_m, atol=1e-12)
        np.testing.assert_allclose(
            signals[f"{name}.orientation_wxyz"][7], body.orientation_wxyz, atol=1e-12
        )


def test_a_turn_about_minus_y_lifts_the_arm_and_a_shift_follows_its_axis():
    _, signals = moved(two_links(), lambda t: 0 * t + math.pi / 2, lambda t: 0 * t + 0.2)
    # half a metre in front of the post becomes half a metre above it
    np.testing.assert_allclose(signals["arm.position_m"][0], [1, 2, 3.5], atol=1e-12)
    # the cart was half a metre further on and 0.1 m up; the slider's axis is the arm's own x
    axis = np.array([math.cos(0.6 - math.pi / 2), 0, -math.sin(0.6 - math.pi / 2)])
    np.testing.assert_allclose(
        signals["cart.position_m"][0], np.array([0.9, 2, 4.0]) + 0.2 * axis, atol=1e-12
    )


def test_velocities_are_the_derivatives_of_the_positions():
    t, signals = moved(two_links(), lambda t: 2 * t**2, lambda t: np.sin(3 * t))
    for name in ("arm", "cart"):
        numeric = np.gradient(signals[f"{name}.position_m"], t, axis=0)
        np.testing.assert_allclose(signals[f"{name}.velocity_m_s"][5:-5], numeric[5:-5], atol=2e-3)
        np.testing.assert_allclose(signals[f"{name}.rate_rad_s"][100], [0, -4 * t[100], 0], 1e-9)


@given(*[st.tuples(ANGLES, ANGLES, ANGLES)] * 2)
def test_products_turn_like_one_after_the_other(first, second):
    a, b = (quaternions_of(np.array([v])) for v in (first, second))
    vector = np.array([[0.3, -1.2, 2.0]])
    np.testing.assert_allclose(
        rotate(multiply(a, b), vector), rotate(a, rotate(b, vector)), atol=1e-12
    )
    np.testing.assert_allclose(rotate(conjugate(a), rotate(a, vector)), vector, atol=1e-12)
    if math.hypot(*first) < 3:
        np.testing.assert_allclose(rotation_vectors_of(a)[0], first, atol=1e-9)
        np.testing.assert_allclose(rotation_vectors_of(-a)[0], rotation_vector_of(a[0]), atol=1e-9)


def still(**sensors):
    return two_links(sensors=sensors)


def test_an_accelerometer_at_rest_reads_plus_g_upwards_in_its_own_frame():
    scenario = still(
        flat={"type": "accelerometer", "body": "cart"},
        tilted={"type": "accelerometer", "body": "arm"},
    )
    t, signals = moved(scenario, np.zeros_like, np.zeros_like)
    sensing.complete(scenario, t, signals, {})
    g = 9.80665
    np.testing.assert_allclose(signals["flat.specific_force_m_s2"][50], [0, 0, g], atol=1e-9)
    # the arm is turned by 0.6 rad about +y: its x axis points down, so its nose feels -g·sin
    np.testing.assert_allclose(
        signals["tilted.specific_force_m_s2"][50],
        [-g * math.sin(0.6), 0, g * math.cos(0.6)],
        atol=1e-9,
    )


def test_an_accelerometer_off_the_axis_feels_turning_and_its_change():
    scenario = two_links(
        world={"duration_s": 1.0, "gravity_m_s2": [0, 0, 0]},
        sensors={"tip": {"type": "accelerometer", "body": "arm", "position_m": [0.5, 0, 0]},
                 "gyro": {"type": "gyroscope", "body": "arm"}},
    )  # fmt: skip
    t, signals = moved(scenario, lambda t: 2 * t**2, np.zeros_like)
    sensing.complete(scenario, t, signals, {})
    rate, change = 4 * t, 4.0
    # the tip relative to the post, in the arm's frame: along the world's x at the start
    arm = np.array([0.5 * math.cos(0.6) + 0.5, 0, 0.5 * math.sin(0.6)])
    tangent = np.array([-arm[2], 0, arm[0]])  # -y x arm
    wanted = change * tangent - rate[:, None] ** 2 * arm
    found = signals["tip.specific_force_m_s2"]
    np.testing.assert_allclose(found[1:-1], wanted[1:-1], atol=5e-3)
    np.testing.assert_allclose(found[[0, -1]], wanted[[0, -1]], atol=5e-2)
    np.testing.assert_allclose(signals["gyro.rate_rad_s"][:, 1], -rate, atol=1e-9)


def test_pressure_falls_by_an_eighth_of_a_hectopascal_a_metre_at_sea_level():
    low, high = sensing.pressure_at(np.array([0.0, 1.0]))
    assert low == 101325.0
    # dh/dp = -0.083244 m/Pa there
    assert (high - low) == pytest.approx(-1 / 0.083244, rel=1e-3)


def test_an_encoder_counts_whole_marks_also_backwards():
    scenario = still(code={"type": "encoder", "joint": "shoulder", "marks": 4})
    t, signals = moved(scenario, lambda t: (t - 0.5) * 2 * math.pi, np.zeros_like)
    sensing.complete(scenario, t, signals, {})
    marks = signals["code.marks"]
    assert marks[0] == -2
    assert marks[-1] == 2
    assert marks[100] == 0
    np.testing.assert_array_equal(marks, np.round(marks))


def test_what_a_source_did_not_record_gives_no_reading():
    scenario = still(flat={"type": "accelerometer", "body": "cart"})
    t, signals = np.linspace(0, 1, 5), {}
    sensing.complete(scenario, t, signals, {})
    assert signals == {}


def test_an_imu_reads_what_an_accelerometer_and_a_gyroscope_in_its_place_read():
    place = {"body": "arm", "position_m": [0.5, 0, 0], "orientation_wxyz": [0.8, 0, 0.6, 0]}
    scenario = still(
        imu={"type": "imu", **place},
        tip={"type": "accelerometer", **place},
        gyro={"type": "gyroscope", **place},
    )
    assert scenario.signals_of("imu") == {"specific_force_m_s2": 3, "rate_rad_s": 3}
    t, signals = moved(scenario, lambda t: 2 * t**2, np.zeros_like)
    sensing.complete(scenario, t, signals, {})
    for part, alone in (("specific_force_m_s2", "tip"), ("rate_rad_s", "gyro")):
        np.testing.assert_array_equal(signals[f"imu.{part}"], signals[f"{alone}.{part}"])
