"""Inputs as signals of time: each is what its docstring says at, between and beyond its points."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError

from simcompare.model.signals import Chirp, Signal, Sine, SineSteps, Table


def at(when, **fields):
    return TypeAdapter(Signal).validate_python(fields).at(np.array(when, float))


def test_a_step_has_its_new_value_from_its_time_on():
    np.testing.assert_array_equal(
        at([0, 0.999, 1.0, 5], signal="step", before=2, after=3, time_s=1), [2, 2, 3, 3]
    )


def test_a_ramp_is_straight_and_constant_outside():
    found = at([0, 1, 2, 3, 9], signal="ramp", start=1, end=5, start_s=1, end_s=3)
    np.testing.assert_allclose(found, [1, 1, 3, 5, 5])


def test_a_table_has_straight_lines_between_its_times():
    np.testing.assert_allclose(
        at([-1, 0.5, 3, 9], signal="table", time_s=[0, 1, 5], value=[0, 2, 4]), [0, 1, 3, 4]
    )


@pytest.mark.parametrize("times", [[0, 1, 1], [0, 2, 1]])
def test_a_table_of_unsorted_times_names_the_first_wrong_one(times):
    with pytest.raises(ValidationError, match=r"time_s\[2\] = 1.0 is not later than the one befor"):
        Table(signal="table", time_s=times, value=[0, 0, 0])


@given(st.floats(0.1, 50), st.floats(-3, 3))
def test_a_sine_repeats_after_its_period(frequency, phase):
    t = np.linspace(0, 1, 7)
    sine = Sine(signal="sine", amplitude=2, frequency_Hz=frequency, phase_rad=phase, offset=1)
    np.testing.assert_allclose(sine.at(t), sine.at(t + 1 / frequency), atol=1e-9)


def test_every_sine_step_begins_at_its_maximum_and_the_last_is_followed_by_nothing():
    steps = SineSteps(signal="sine_steps", amplitude=3, frequencies_Hz=(1.5, 7, 40), dwell_s=0.1)
    np.testing.assert_allclose(steps.at(np.array([0, 0.1, 0.2, 0.3, 1.0])), [3, 3, 3, 0, 0])
    inside = steps.at(np.array([0.1 + 0.03, 0.2 + 1 / 40]))
    np.testing.assert_allclose(inside, [3 * math.cos(2 * math.pi * 7 * 0.03), 3])


def test_a_chirp_has_its_frequencies_at_its_ends():
    chirp = Chirp(signal="chirp", amplitude=1, start_Hz=2, end_Hz=50, duration_s=4)
    h = 1e-6
    for time_s, frequency in ((0.5, 2 * 25 ** (1 / 8)), (3.999, 2 * 25 ** (3.999 / 4))):
        phase = np.arccos(np.clip(chirp.at(np.array([time_s - h, time_s, time_s + h])), -1, 1))
        assert abs(phase[2] - phase[0]) / (2 * h) == pytest.approx(2 * math.pi * frequency, 1e-3)


def test_a_chirp_of_one_frequency_is_a_cosine():
    chirp = Chirp(signal="chirp", amplitude=1, start_Hz=3, end_Hz=3, duration_s=4)
    t = np.linspace(0, 1, 20)
    np.testing.assert_allclose(chirp.at(t), np.cos(6 * math.pi * t), atol=1e-12)
