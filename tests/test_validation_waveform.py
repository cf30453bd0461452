"""Deviations between waveforms, and the simulation at the instants of the measurement."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from simcompare.comparison.waveform import waveform
from simcompare.errors import InputError
from simcompare.model.resampling import interpolated, near_events

NUMBERS = st.floats(-1e3, 1e3).map(lambda x: round(x, 3))
PAIRS = st.integers(3, 30).flatmap(
    lambda n: st.tuples(arrays(float, n, elements=NUMBERS), arrays(float, n, elements=NUMBERS))
)


def test_the_measures_of_a_known_deviation():
    found = waveform([0.0, 1.0, 2.0, 3.0], [0.0, 2.0, 2.0, 1.0])
    assert found.n == 4
    assert found.bias == pytest.approx(-0.25)
    assert found.rmse == pytest.approx(math.sqrt(5 / 4))
    assert found.mae == pytest.approx(0.75)
    assert (found.max_abs, found.at) == (2.0, 3)
    assert found.nrmse == pytest.approx(math.sqrt(5 / 4) / 3)
    assert found.normaliser == "range of the measurement"
    assert found.fit_percent == pytest.approx(100 * (1 - math.sqrt(5) / math.sqrt(5)))


def test_a_larger_amplitude_is_a_magnitude_error_and_no_phase_error():
    t = np.linspace(0, 1, 1000, endpoint=False)
    found = waveform(np.sin(2 * np.pi * t), 1.1 * np.sin(2 * np.pi * t))
    assert found.magnitude == pytest.approx(0.1, abs=1e-12)
    assert found.phase == pytest.approx(0.0, abs=1e-7)
    assert found.combined == pytest.approx(0.1, abs=1e-7)


@pytest.mark.parametrize("turn", [0.1, 0.5, 1.0])
def test_a_shift_is_a_phase_error_of_its_share_of_half_a_period(turn):
    t = np.linspace(0, 1, 1000, endpoint=False)
    found = waveform(np.sin(2 * np.pi * t), np.sin(2 * np.pi * t - turn * np.pi))
    assert found.phase == pytest.approx(turn, abs=1e-9)
    assert found.magnitude == pytest.approx(0.0, abs=1e-12)


def test_missing_samples_are_left_out_and_counted_and_the_index_is_the_original_one():
    found = waveform([np.nan, 1.0, 2.0, 3.0], [0.0, 1.0, np.nan, 5.0])
    assert (found.n, found.masked, found.at) == (2, 2, 3)
    assert found.bias == 1.0


def test_a_constant_measurement_has_neither_normaliser_nor_fit():
    found = waveform([2.0, 2.0], [2.0, 3.0])
    assert found.nrmse is None
    assert found.fit_percent is None


def test_an_uncertainty_tells_how_many_samples_are_within_it():
    found = waveform(np.zeros(4), [0.0, 1.0, 2.0, 3.0], u=1.0)
    assert found.within == 0.75
    assert found.rms_over_u == pytest.approx(math.sqrt(14 / 4))
    assert waveform(np.zeros(4), np.ones(4)).within is None
    assert waveform(np.zeros(4), np.ones(4), u=0.0).within is None


@pytest.mark.parametrize(
    ("measured", "simulated", "u", "says"),
    [
        ([1.0], [1.0, 2.0], None, "1 measured and 2 simulated"),
        ([np.nan, 1.0], [1.0, np.nan], None, "no sample"),
        ([1.0, 2.0], [1.0, 2.0], -1.0, "negative"),
    ],
)
def test_what_cannot_be_compared_is_refused(measured, simulated, u, says):
    with pytest.raises(InputError, match=says):
        waveform(measured, simulated, u=u)


@given(PAIRS, st.floats(-100, 100), st.floats(0.1, 10))
@settings(max_examples=60)
def test_shift_and_scale_of_both_change_only_what_has_a_unit(pair, shift, scale):
    m, c = pair
    was, moved = waveform(m, c), waveform(scale * m + shift, scale * c + shift)
    assert moved.rmse == pytest.approx(scale * was.rmse, rel=1e-6, abs=1e-9)
    assert moved.bias == pytest.approx(scale * was.bias, rel=1e-6, abs=1e-9)
    if was.nrmse is not None and np.ptp(m) > 1e-2:
        assert moved.nrmse == pytest.approx(was.nrmse, rel=1e-6, abs=1e-9)
        assert moved.fit_percent == pytest.approx(was.fit_percent, rel=1e-6, abs=1e-6)


@given(PAIRS, st.randoms(use_true_random=False))
@settings(max_examples=60)
def test_the_order_of_the_samples_does_not_matter(pair, chance):
    m, c = pair
    order = list(range(len(m)))
    chance.shuffle(order)
    was, mixed = waveform(m, c), waveform(m[order], c[order])
    for name in ("bias", "rmse", "mae", "max_abs"):
        assert getattr(mixed, name) == pytest.approx(getattr(was, name), rel=1e-9, abs=1e-9)


@given(PAIRS)
@settings(max_examples=60)
def test_exchanging_the_two_changes_the_sign_of_the_bias_and_nothing_of_the_size(pair):
    one, other = waveform(*pair), waveform(*pair[::-1])
    assert other.bias == pytest.approx(-one.bias, abs=1e-12)
    assert other.rmse == pytest.approx(one.rmse)
    assert one.mae <= one.rmse * (1 + 1e-12) <= one.max_abs * (1 + 1e-9)


def test_interpolation_between_samples_is_of_third_order_or_better():
    errors = []
    for n in (40, 80):
        t = np.linspace(0, 1, n + 1)
        at = np.linspace(0.01, 0.99, 333)
        errors.append(np.max(np.abs(interpolated(t, np.sin(6 * t), at) - np.sin(6 * at))))
    assert errors[0] < 2.5e-4
    assert errors[0] / errors[1] > 6


def test_given_rates_make_the_interpolation_of_fourth_order():
    t, at = np.linspace(0, 1, 41), np.linspace(0.01, 0.99, 333)
    found = interpolated(t, np.sin(6 * t), at, rates=6 * np.cos(6 * t))
    assert np.max(np.abs(found - np.sin(6 * at))) < 1.5e-6


def test_outside_of_the_simulation_there_is_nothing():
    found = interpolated([0.0, 1.0, 2.0], [0.0, 1.0, 4.0], [-0.1, 0.0, 2.0, 2.1])
    assert np.isnan(found[[0, 3]]).all()
    assert found[1:3].tolist() == [0.0, 4.0]


def test_nothing_is_interpolated_across_an_impact():
    # a ball that falls with 1 m/s and leaves with 0.5 m/s at 1.003 s
    t = np.arange(0, 2, 0.01)
    hit = 1.003
    height = np.where(t < hit, hit - t, 0.5 * (t - hit))
    at = np.arange(0.0055, 1.98, 0.02)
    found = interpolated(t, height, at, events_s=[hit])
    known = np.isfinite(found)
    assert np.flatnonzero(~known).tolist() == np.flatnonzero(np.abs(at - hit) < 0.02).tolist()
    exact = np.where(at < hit, hit - at, 0.5 * (at - hit))
    assert np.max(np.abs(found - exact)[known]) < 1e-12
    assert np.isfinite(interpolated(t, height, at)).all()


def test_the_samples_on_both_sides_of_an_event_are_left_out():
    at = np.arange(5.0)
    assert near_events(at, [2.5]).tolist() == [False, False, True, True, False]
    assert near_events(at, [2.0]).tolist() == [False, True, True, True, False]
    assert not near_events(at, [7.0, -1.0]).any()


def test_missing_simulated_samples_are_bridged_only_up_to_the_given_gap():
    t, y = np.arange(10.0), np.arange(10.0)
    y[4:7] = np.nan
    assert interpolated(t, y, [5.0])[0] == pytest.approx(5.0)
    assert np.isnan(interpolated(t, y, [5.0], gap_s=2.0)[0])


def test_times_that_do_not_increase_are_refused():
    with pytest.raises(InputError, match="does not come after"):
        interpolated([0.0, 1.0, 1.0], [0.0, 1.0, 2.0], [0.5])
