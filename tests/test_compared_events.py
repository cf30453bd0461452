"""Simulated events held against measured ones."""

import numpy as np
import pytest

from simcompare.comparison.events import EventUncertainty, compare_events

UNKNOWN = EventUncertainty(None, None, None)


def compared(simulated_s, measured_s, u=UNKNOWN, recorded_s=None):
    measured_s = np.array(measured_s)
    recorded = measured_s if recorded_s is None else np.array(recorded_s)
    return compare_events(np.array(simulated_s), measured_s, recorded, u)


def test_errors_are_simulated_minus_measured():
    found = compared([0.0, 1.1, 2.0], [0.1, 1.0, 2.0])
    assert (found.matched, found.missed, found.extra) == (3, 0, 0)
    assert found.bias_s == pytest.approx(0.0)
    assert found.rmse_s == pytest.approx(np.sqrt(0.02 / 3))
    assert found.max_abs_s == pytest.approx(0.1)
    assert [one.simulated_s for one in found.intervals] == pytest.approx([1.1, 0.9])
    assert [one.measured_s for one in found.intervals] == pytest.approx([0.9, 1.0])


def test_events_without_a_partner_are_counted_and_have_no_interval():
    found = compared([0.0, 1.0, 2.0, 3.0], [0.0, 2.0, 3.0, 4.5])
    assert (found.matched, found.missed, found.extra) == (3, 1, 1)
    (one,) = found.intervals
    assert (one.number, one.simulated_s, one.measured_s) == (1, 1.0, 1.0)


def test_without_any_pair_there_is_no_error():
    found = compared([0.0, 1.0], [])
    assert (found.matched, found.missed, found.extra) == (0, 0, 2)
    assert (found.bias_s, found.rmse_s, found.max_abs_s) == (None, None, None)
    assert found.intervals == ()


def test_an_interval_is_judged_where_its_whole_uncertainty_is_known():
    times = [0.0, 1.0, 2.0]
    known = EventUncertainty(np.full(3, 0.003), 0.004, np.array([0.0, 0.001]))
    found = compared([0.0, 1.01, 2.0], times, known)
    first, second = found.intervals
    u = np.sqrt(2) * 0.005
    assert first.e_n == pytest.approx(0.01 / (2 * u))
    assert second.e_n == pytest.approx(-0.01 / (2 * np.hypot(u, 0.001)))
    assert second.u_input_s == 0.001
    short = EventUncertainty(np.full(3, 0.003), 0.004, np.array([0.0]))
    assert compared(times, times, short).intervals[1].e_n is None
    assert all(one.e_n is None for one in compared(times, times).intervals)


def test_intervals_are_those_of_the_clock_of_the_log():
    found = compared([0.0, 1.0], [0.0, 1.0], recorded_s=[5.0, 6.001])
    assert found.max_abs_s == 0.0
    assert found.intervals[0].measured_s == pytest.approx(1.001)
