"""Level, last value and history of any probe, found in signals that are known by construction."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare import measures
from simcompare.measures import Request, final, history, level, side_by_side
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory

PROBE = Probe(observe="cart.position_m", component=0, offset=-1.0, label="way", unit="m")


def made(values, step_s=0.01):
    """A trajectory whose probe sees ``values``: the offset of -1 is added here before."""
    x = np.asarray(values, dtype=float) + 1
    zero = np.zeros(len(x))
    signals = {"cart.position_m": np.column_stack((x, zero, zero))}
    return Trajectory("made", np.arange(len(x)) * step_s, signals)


def asked(**options):
    return Request(PROBE, {}, options)


@pytest.mark.parametrize("name", measures.FUNCTIONS)
def test_every_measure_declares_units_and_axes_of_its_series(name):
    function = measures.load(name)
    assert set(function.series) <= set(function.units)
    assert set(function.axes) <= set(function.series)
    assert set(function.axes.values()) <= set(function.series)


def test_level_is_the_mean_of_the_window_with_both_its_edges():
    ramp = made(np.arange(101))
    found = level.measure(ramp, asked(start_s=0.3, end_s=0.7))
    assert found.values["mean"] == pytest.approx(50)
    # one sample more on one side moves the mean by half a sample
    found = level.measure(ramp, asked(start_s=0.3, end_s=0.71))
    assert found.values["mean"] == pytest.approx(50.5)


@given(first=st.integers(0, 99), count=st.integers(0, 200))
def test_level_includes_edges_that_rounding_puts_off_a_sample(first, count):
    # 0.1 + 0.2 is above 0.3 for a computer
    values = np.arange(400)
    window = asked(start_s=first / 100, end_s=(first + count) / 100)
    found = level.measure(made(values), window)
    assert found.values["mean"] == pytest.approx(first + count / 2)


def test_level_of_a_window_without_samples_is_unknown():
    found = level.measure(made(np.ones(10)), asked(start_s=5.0, end_s=6.0))
    assert found.values["mean"] is None
    truth = level.measure(made(np.ones(1000)), asked(start_s=5.0, end_s=6.0))
    assert side_by_side(found, truth) == {"mean": (None, 1.0)}
    assert side_by_side(truth, found) == {}


def test_final_is_the_last_sample_beside_the_true_one():
    found = final.measure(made([1, 2, 7]), asked())
    truth = final.measure(made([1, 2, 8]), asked())
    assert side_by_side(found, truth) == {"final": (7.0, 8.0)}


def test_history_keeps_the_first_and_the_last_sample():
    found = history.measure(made(np.arange(101) ** 2), asked(count=5))
    np.testing.assert_allclose(found.series["time"], [0, 0.25, 0.5, 0.75, 1.0])
    np.testing.assert_allclose(found.series["history"], [0, 625, 2500, 5625, 10000])


@given(samples=st.integers(1, 50), count=st.integers(1, 80))
def test_history_takes_no_sample_twice(samples, count):
    found = history.measure(made(np.arange(samples)), asked(count=count))
    assert len(found.series["time"]) == min(samples, count)
    assert len(set(found.series["time"])) == len(found.series["time"])


def test_history_error_is_the_largest_deviation_of_either_sign():
    t = np.linspace(0, 1, 11)
    truth = history.measure(made(t), asked(count=11))
    strayed = t.copy()
    strayed[3] += 0.01
    strayed[7] -= 0.04
    found = history.measure(made(strayed), asked(count=11))
    value, true = history.against(found, truth)["history_error"]
    assert value == pytest.approx(0.04)
    assert true == 0


def test_history_error_is_unknown_where_the_times_differ():
    truth = history.measure(made(np.ones(11)), asked(count=11))
    for other in (made(np.ones(9)), made(np.ones(11), step_s=0.02)):
        found = history.measure(other, asked(count=11))
        assert history.against(found, truth) == {"history_error": (None, 0.0)}
