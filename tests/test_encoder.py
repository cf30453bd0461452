"""Resolution of an encoder and drift of odometry, against random phases and a driven circle."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare.hardware.sensors import encoder


def test_numbers_of_twenty_marks():
    assert encoder.gate_resolution(20, 0.05) == pytest.approx(6.283, abs=5e-4)
    # 1 µs of clock: 6e-6 to 6e-5 of the speed from 2 to 20 rad/s
    for rate, part in ((2.0, 6.4e-6), (20.0, 6.4e-5)):
        assert encoder.period_resolution(20, 1e-6, rate) / rate == pytest.approx(part, rel=0.01)


def test_counting_at_random_phase_has_a_triangular_error():
    random = np.random.default_rng(1)
    marks, gate = 20, 0.05
    # many speeds, so that the part of a mark that is left over takes every value
    rates = random.uniform(100, 200, 100_000)
    phase = random.uniform(0, 1, len(rates))
    turns = marks * gate * rates / (2 * math.pi)
    counts = np.floor(phase + turns) - np.floor(phase)
    errors = counts * encoder.gate_resolution(marks, gate) - rates
    assert errors.std() == pytest.approx(encoder.gate_uncertainty(marks, gate), rel=0.01)
    assert np.abs(errors).max() < encoder.gate_resolution(marks, gate)
    assert abs(errors.mean()) < 0.03


@given(st.integers(1, 1000), st.floats(1e-3, 1), st.floats(1e-8, 1e-5))
def test_counting_and_timing_meet_at_one_speed(marks, gate, tick):
    rate = encoder.equal_speed(marks, gate, tick)
    timed = encoder.period_resolution(marks, tick, rate)
    assert timed == pytest.approx(encoder.gate_resolution(marks, gate), rel=1e-9)
    # timing is the better one below, counting above
    assert encoder.period_resolution(marks, tick, rate / 2) < timed
    assert encoder.period_resolution(marks, tick, rate * 2) > timed


@given(st.floats(1.0, 500.0), st.floats(0.0, 1.0))
def test_timing_is_off_by_at_most_its_resolution(rate, start):
    marks, tick = 20, 1e-6
    period = 2 * math.pi / (marks * rate)
    found = encoder.timed_speed((start, start + period), marks, tick)
    # the clock may see one tick less, and that shorter period is the larger step of speed
    slack = encoder.period_resolution(marks, tick, rate) / (1 - tick / period)
    assert abs(found - rate) <= slack * 1.01


def test_two_marks_in_one_tick_have_no_speed():
    assert encoder.timed_speed((0.01, 0.01 + 1e-8), 20, 1e-6) is None


def test_counts_become_mean_speeds():
    np.testing.assert_allclose(
        encoder.counted_speeds(np.array([0.0, 10, 25]), 20, 0.05),
        [10 * 2 * math.pi, 15 * 2 * math.pi],
    )


def test_uneven_marks_cancel_over_a_whole_turn():
    marks, rate = 20, 50.0
    uneven = 0.02 * np.sin(2 * math.pi * np.arange(marks) / marks + 0.3)
    numbers = np.arange(5 * marks)
    passed = (numbers * 2 * math.pi / marks + uneven[numbers % marks]) / rate
    single = 2 * math.pi / marks / np.diff(passed)
    assert np.abs(single - rate).max() > 0.5
    np.testing.assert_allclose(encoder.whole_turn_speed(passed, marks), rate, rtol=1e-12)


def test_passing_times_are_those_of_the_marks():
    t = np.linspace(0, 1, 1001)
    angle = 30 * t + 20 * t**2
    numbers = np.array([1.0, 40.0, 150.0])
    found = encoder.passing_times(angle, t, 20, numbers)
    exact = [(-30 + math.sqrt(900 + 80 * m * 2 * math.pi / 20)) / 40 for m in numbers]
    np.testing.assert_allclose(found, exact, atol=2e-7)


def test_odometry_strays_linearly_along_and_quadratically_across():
    speed, bias, t = 0.3, 1e-3, 10.0
    # a robot that turns slowly while it takes itself to drive straight moves on a circle
    across = speed / bias * (1 - math.cos(bias * t))
    assert encoder.lateral_error(speed, bias, t) == pytest.approx(across, rel=1e-4)
    assert encoder.lateral_error(speed, bias, 2 * t) == 4 * encoder.lateral_error(speed, bias, t)
    assert encoder.distance_error(0.01, 2 * 3.0) == 2 * encoder.distance_error(0.01, 3.0)
