"""Two clocks brought together: by events, by correlation and by least squares."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simcompare.alignment.event_alignment import by_events
from simcompare.alignment.matching import match
from simcompare.alignment.wave_alignment import by_waveform, sandwich, smoothing
from simcompare.errors import InputError

PPM = 1e-6


def bounces(count=10, span_s=4.0, e=0.9):
    times = np.cumsum(np.concatenate(([0.45], 0.75 * e ** np.arange(count - 1))))
    return times / times[-1] * span_s


def chirp(t):
    return np.sin(2 * np.pi * (0.3 * t + 0.014 * t**2))


def swing(t):
    late = np.maximum(np.asarray(t) - 2, 0)
    return np.exp(-late / 25) * np.cos(2 * np.pi * 0.8 * late)


def steps(t):
    t = np.asarray(t)
    when = [3, 7, 13, 19, 22, 27, 31, 37, 42, 48, 52, 55, 61, 66]
    signs = np.array([1, -0.6, 0.8, -1.1, 0.7, -0.9, 1, -0.5, 0.9, -1, 0.8, -0.7, 0.6, -0.9])
    rises = [h * np.clip((t - t0) / 0.06, 0, 1) for t0, h in zip(when, signs, strict=True)]
    smooth = [r**2 * (3 - 2 * r / h) / h for r, h in zip(rises, signs, strict=True)]
    return np.sum(smooth, axis=0)


def logged(f, seed, *, span_s=70.0, rate_Hz=100.0, noise=0.015, jitter=0.0, early_s=4.0):
    """A log of a signal, on a clock with an offset and a skew that are told with it."""
    chance = np.random.default_rng(seed)
    offset_s, skew = chance.uniform(-1.5, 1.5), chance.normal(0, 50 * PPM)
    t = np.arange(offset_s - early_s, offset_s + span_s + early_s, 1 / rate_Hz)
    t = np.sort(t + (chance.uniform(0, 1) + chance.uniform(-jitter, jitter, len(t))) / rate_Hz)
    y = f((t - offset_s) / (1 + skew)) + noise * chance.normal(size=len(t))
    return t, y, offset_s, skew


def on_reference(span_s=70.0, rate_Hz=100.0, f=chirp):
    t = np.arange(0, span_s, 1 / rate_Hz)
    return t, f(t)


def u_at(found, time_s):
    """Standard uncertainty of the log's clock at a time of the reference (JCGM 100, eq. 13) [s]."""
    reach = time_s * found.u_skew
    return np.sqrt(
        found.u_offset_s**2 + reach**2 + 2 * found.correlation * found.u_offset_s * reach
    )


# matching


def test_events_are_matched_in_order_and_the_rest_is_counted():
    found = match([1.0, 2.0, 3.0, 4.0], [1.01, 2.5, 3.02, 4.0], 0.1)
    assert found.pairs == ((0, 0), (2, 2), (3, 3))
    assert (found.missed, found.extra) == ((1,), (1,))
    assert found.errors_s == pytest.approx([0.01, 0.02, 0.0])


def test_a_series_is_not_shifted_by_one_event_to_save_a_missing_one():
    found = match([0.0, 1.0, 2.0, 3.0], [1.0, 2.0, 3.0, 4.0], 1.0)
    assert found.pairs == ((1, 0), (2, 1), (3, 2))


def test_without_events_nothing_is_matched():
    found = match([], [1.0, 2.0], 0.1)
    assert (found.pairs, found.missed, found.extra) == ((), (), (0, 1))


@pytest.mark.parametrize(
    ("reference", "log", "tolerance", "says"),
    [
        ([2.0, 1.0], [1.0], 0.1, "sort them"),
        ([1.0], [np.nan], 0.1, "time 1 of the log is nan"),
        ([1.0], [1.0], 0.0, "must be positive"),
    ],
)
def test_impossible_events_are_refused(reference, log, tolerance, says):
    with pytest.raises(InputError, match=says):
        match(reference, log, tolerance)


TIMES = st.lists(st.integers(0, 60), max_size=12).map(lambda x: np.sort(np.array(x, dtype=float)))


def cost_of(found):
    lost = len(found.missed) + len(found.extra)
    return np.abs(found.errors_s).sum() + lost * found.tolerance_s / 2


def cheapest(reference, log, tolerance):
    """The same matching by trying everything."""
    if not len(reference) or not len(log):
        return (len(reference) + len(log)) * tolerance / 2
    skip = tolerance / 2
    costs = [
        cheapest(reference[1:], log, tolerance) + skip,
        cheapest(reference, log[1:], tolerance) + skip,
    ]
    error = abs(reference[0] - log[0])
    if error <= tolerance:
        costs.append(cheapest(reference[1:], log[1:], tolerance) + error)
    return min(costs)


@given(TIMES.map(lambda t: t[:5]), TIMES.map(lambda t: t[:5]), st.sampled_from([1.0, 3.0, 10.0]))
@settings(max_examples=80)
def test_no_matching_is_better(reference, log, tolerance):
    found = match(reference, log, tolerance)
    assert cost_of(found) == pytest.approx(cheapest(reference, log, tolerance))


@given(TIMES, TIMES, st.sampled_from([0.5, 2.0, 7.0]), st.floats(-1e3, 1e3).map(round))
@settings(max_examples=80)
def test_matching_is_symmetric_monotone_and_blind_to_a_common_shift(reference, log, tolerance, by):
    found = match(reference, log, tolerance)
    back, moved = match(log, reference, tolerance), match(reference + by, log + by, tolerance)
    assert cost_of(back) == pytest.approx(cost_of(found))
    assert moved.pairs == found.pairs
    assert np.all(np.abs(found.errors_s) <= tolerance)
    pairs = np.array(found.pairs).reshape(-1, 2)
    assert np.all(np.diff(pairs, axis=0) > 0)
    assert len(pairs) + len(found.missed) == len(reference)
    assert len(pairs) + len(found.extra) == len(log)


# events


def test_ten_bounces_within_four_seconds_tell_offset_and_skew():
    found = by_events(bounces(), bounces() * (1 + 30 * PPM) + 1.25, 1e-4)
    assert found.method == "events"
    assert found.offset_s == pytest.approx(1.25, abs=1e-4)
    assert 0.05e-3 < found.u_offset_s < 0.09e-3
    assert 20 * PPM < found.u_skew < 30 * PPM
    assert len(found.matched) == 10
    assert (found.missed, found.extra, found.ambiguous) == ((), (), False)
    # a short log shrinks the skew towards what is known of clocks, and says so
    assert 0 < found.skew < 30 * PPM
    assert "0 ± 50 ppm" in found.text


def drawn(times, seed, *, sigma=1e-4, lost=0, added=0):
    chance = np.random.default_rng(seed)
    offset_s, skew = chance.normal(0, 3), chance.normal(0, 50 * PPM)
    log = offset_s + (1 + skew) * times + chance.normal(0, sigma, len(times))
    log = np.delete(log, chance.choice(len(log), lost, replace=False))
    return np.sort(np.append(log, chance.uniform(log[0], log[-1], added))), offset_s, skew


@pytest.mark.parametrize(
    ("times", "options"),
    [
        (bounces(), {}),
        (bounces(), {"lost": 2, "added": 3}),
        (np.linspace(0, 4, 10) ** 1.1, {}),
        (
            np.sort(np.random.default_rng(1).uniform(0, 90, 40)),
            {"sigma": 5e-4, "lost": 4, "added": 6},
        ),
    ],
)
def test_uncertainties_of_offset_and_skew_are_right(times, options):
    pulls = []
    for seed in range(200):
        log, offset_s, skew = drawn(times, seed, **options)
        found = by_events(times, log, options.get("sigma", 1e-4))
        pulls.append(
            [(found.offset_s - offset_s) / found.u_offset_s, (found.skew - skew) / found.u_skew]
        )
    pulls = np.array(pulls)
    assert np.all(pulls.std(axis=0) > 0.88)
    assert np.all(pulls.std(axis=0) < 1.12)
    covered = np.mean(np.abs(pulls) <= 2, axis=0)
    assert np.all((covered >= 0.9) & (covered <= 0.98))


def test_unknown_uncertainties_are_taken_from_the_scatter_and_still_cover():
    inside = 0
    for seed in range(200):
        log, offset_s, _ = drawn(bounces(), seed)
        found = by_events(bounces(), log)
        inside += abs(found.offset_s - offset_s) <= 2 * found.u_offset_s
    assert 0.9 <= inside / 200 <= 0.98
    assert "taken from their scatter" in found.text


def test_an_event_that_is_far_off_is_not_matched():
    log = bounces() + 0.5
    log[4] += 3e-3
    found = by_events(bounces(), log, 1e-4)
    assert (found.missed, found.extra) == ((4,), (4,))
    assert found.offset_s == pytest.approx(0.5, abs=1e-6)


def test_scatter_beyond_the_stated_uncertainty_widens_the_result():
    log, _, _ = drawn(bounces(), 11, sigma=5e-4)
    sure = by_events(bounces(), log, 5e-4)
    told = by_events(bounces(), log, 1.5e-4)
    assert told.u_offset_s > 1.5 * by_events(bounces(), bounces(), 1.5e-4).u_offset_s
    assert told.u_offset_s < 1.3 * sure.u_offset_s
    assert "times as much as their uncertainties say" in told.text


def test_a_metronome_is_ambiguous():
    ticks = np.arange(12) * 0.5
    found = by_events(ticks, ticks[3:9] + 0.1, 1e-4)
    assert found.ambiguous
    assert "Ambiguous" in found.text
    assert abs(found.offset_s) < 0.6


def test_three_hundred_events_of_an_hour_with_a_large_skew_are_found():
    times = np.sort(np.random.default_rng(2).uniform(0, 3600, 300))
    found = by_events(times, 100 + times * (1 + 180 * PPM), 1e-3)
    assert found.skew == pytest.approx(180 * PPM, abs=0.5 * PPM)
    assert len(found.matched) == 300


def test_one_event_gives_an_offset_and_no_skew():
    found = by_events([1.0], [3.5], 1e-3)
    assert found.offset_s == pytest.approx(2.5)
    assert found.u_offset_s == pytest.approx(1e-3, rel=0.01)
    assert found.u_skew == pytest.approx(50 * PPM)


def test_events_that_cannot_be_matched_are_refused():
    with pytest.raises(InputError, match="both need one"):
        by_events([], [1.0])


@given(st.floats(-1e4, 1e4), st.floats(-100, 100))
@settings(max_examples=25)
def test_a_shift_of_the_log_shifts_the_offset_and_nothing_else(by, skew_ppm):
    log, _, _ = drawn(bounces(), 4)
    was = by_events(bounces(), log, 1e-4)
    now = by_events(bounces(), log + by, 1e-4)
    assert now.offset_s - was.offset_s == pytest.approx(by, abs=1e-8)
    assert now.skew == pytest.approx(was.skew, abs=1e-9)
    assert now.u_offset_s == pytest.approx(was.u_offset_s, rel=1e-3)


def test_the_two_directions_undo_each_other_and_the_uncertainty_grows_away_from_the_events():
    found = by_events(bounces() + 10, bounces() + 12, 1e-4)
    t = np.array([0.0, 12.0, 100.0])
    assert found.to_reference(found.to_log(t)) == pytest.approx(t, abs=1e-12)
    assert u_at(found, 0.0) == pytest.approx(found.u_offset_s)
    assert u_at(found, 12.5) < 0.15 * u_at(found, 0.0)
    assert u_at(found, 100.0) > 7 * u_at(found, 0.0)


# waveforms


@pytest.mark.parametrize("f", [chirp, swing, steps])
@pytest.mark.parametrize("noise", [0.01, 0.02])
def test_waveforms_of_a_minute_align_within_a_third_of_a_millisecond(f, noise):
    t, y = on_reference(f=f)
    for seed in range(6):
        t_log, y_log, offset_s, skew = logged(f, seed, noise=noise)
        found = by_waveform(t, y, t_log, y_log)
        # where the signal is: its events, or the middle of its movement
        middle = 20.0 if f is swing else 35.0
        assert abs(found.to_log(middle) - (offset_s + (1 + skew) * middle)) < 0.3e-3 * noise / 0.01
        assert abs(found.skew - skew) < 50 * PPM
        assert not found.ambiguous
        assert found.method == "least squares"


def test_offsets_are_within_a_third_of_a_millisecond_at_one_percent_of_noise_typically():
    t, y = on_reference()
    errors = []
    for seed in range(20):
        t_log, y_log, offset_s, _ = logged(chirp, seed, noise=0.02)
        errors.append(by_waveform(t, y, t_log, y_log).offset_s - offset_s)
    assert np.std(errors) < 0.25e-3
    assert abs(np.mean(errors)) < 0.15e-3


@pytest.mark.parametrize(
    ("f", "options"),
    [(chirp, {}), (swing, {}), (steps, {}), (chirp, {"rate_Hz": 40.0, "jitter": 0.3})],
)
def test_uncertainties_from_waveforms_are_right(f, options):
    t, y = on_reference(20.0, f=f)
    pulls = []
    for seed in range(120):
        t_log, y_log, offset_s, skew = logged(f, seed, span_s=20.0, early_s=2.0, **options)
        found = by_waveform(t, y, t_log, y_log)
        at = 10.0
        error = float(found.to_log(at)) - (offset_s + (1 + skew) * at)
        pulls.append([error / u_at(found, at), (found.skew - skew) / found.u_skew])
    pulls = np.array(pulls)
    assert np.all(pulls.std(axis=0) > 0.84)
    assert np.all(pulls.std(axis=0) < 1.16)
    covered = np.mean(np.abs(pulls) <= 2, axis=0)
    assert np.all((covered >= 0.9) & (covered <= 0.99))


def test_noise_of_the_reference_is_in_the_uncertainty():
    pulls = []
    for seed in range(100):
        chance = np.random.default_rng(1000 + seed)
        t, y = on_reference(20.0)
        y = y + 0.015 * chance.normal(size=len(t))
        t_log, y_log, offset_s, skew = logged(chirp, seed, span_s=20.0)
        found = by_waveform(t, y, t_log, y_log)
        error = float(found.to_log(10.0)) - (offset_s + (1 + skew) * 10.0)
        pulls.append(error / u_at(found, 10.0))
    assert 0.8 < np.std(pulls) < 1.15
    assert 0.9 <= np.mean(np.abs(pulls) <= 2) <= 1


def test_residuals_that_are_correlated_widen_the_uncertainty():
    from scipy.signal import lfilter

    t, y = on_reference(30.0)
    pulls = []
    for seed in range(80):
        t_log, y_log, offset_s, skew = logged(chirp, seed, span_s=30.0, noise=0.0)
        white = np.random.default_rng(seed).normal(size=len(t_log))
        y_log = y_log + 0.02 * lfilter([np.sqrt(1 - 0.81)], [1, -0.9], white)
        found = by_waveform(t, y, t_log, y_log)
        error = float(found.to_log(15.0)) - (offset_s + (1 + skew) * 15.0)
        pulls.append(error / u_at(found, 15.0))
    assert 0.75 < np.std(pulls) < 1.25
    J, residuals = np.ones((500, 1)), np.repeat(np.random.default_rng(0).normal(size=50), 10)
    naive = 1 / 500
    assert sandwich(J, residuals, 1.0, 1.0)[0, 0] > 5 * naive
    chance = np.random.default_rng(1)
    white = [sandwich(J, chance.normal(size=500), 1.0, 1.0)[0, 0] for _ in range(40)]
    assert np.mean(white) == pytest.approx(naive, rel=0.3)


def test_gaps_and_missing_samples_do_not_move_the_offset():
    t, y = on_reference()
    t_log, y_log, offset_s, _ = logged(chirp, 3)
    y_log[1000:1600] = np.nan
    kept = np.ones(len(t_log), dtype=bool)
    kept[3000:3700] = False
    y[2500:2700] = np.nan
    found = by_waveform(t, y, t_log[kept], y_log[kept])
    assert abs(found.offset_s - offset_s) < 4 * found.u_offset_s
    assert found.u_offset_s < 0.3e-3


@pytest.mark.parametrize(("early_s", "cut"), [(20.0, slice(None)), (0.0, slice(1500, 5000))])
def test_the_log_may_be_longer_or_shorter_than_the_reference(early_s, cut):
    t, y = on_reference()
    t_log, y_log, offset_s, skew = logged(
        lambda t: np.where((t > 0) & (t < 70), chirp(t), 0.0), 5, early_s=early_s
    )
    found = by_waveform(t, y, t_log[cut], y_log[cut])
    error = float(found.to_log(35.0)) - (offset_s + (1 + skew) * 35.0)
    assert abs(error) < 0.4e-3


@pytest.mark.parametrize(("ref_Hz", "log_Hz"), [(1000.0, 50.0), (50.0, 400.0), (20_000.0, 100.0)])
def test_rates_need_not_be_equal(ref_Hz, log_Hz):
    t, y = on_reference(30.0, ref_Hz)
    t_log, y_log, offset_s, skew = logged(chirp, 8, span_s=30.0, rate_Hz=log_Hz, jitter=0.2)
    found = by_waveform(t, y, t_log, y_log)
    error = float(found.to_log(15.0)) - (offset_s + (1 + skew) * 15.0)
    assert abs(error) < 5 * u_at(found, 15.0)
    assert abs(error) < 0.8e-3


def test_a_sine_is_ambiguous_by_whole_periods():
    def sine(t):
        return np.sin(2 * np.pi * 0.5 * np.asarray(t))

    t, y = on_reference(20.0, f=sine)
    t_log, y_log, _, _ = logged(sine, 1, span_s=20.0)
    found = by_waveform(t, y, t_log, y_log)
    assert found.ambiguous
    assert "the signal repeats" in found.text


def test_a_short_log_keeps_the_skew_that_clocks_usually_have():
    t, y = on_reference(4.0)
    t_log, y_log, _, _ = logged(chirp, 2, span_s=4.0, early_s=0.5)
    found = by_waveform(t, y, t_log, y_log)
    assert 40 * PPM < found.u_skew <= 50 * PPM
    assert "0 ± 50 ppm" in found.text


@pytest.mark.parametrize(
    ("t_log", "y_log", "says"),
    [
        (np.arange(100.0), np.ones(100), "1 throughout"),
        (np.arange(5.0), np.arange(5.0), "only 5 samples"),
        (np.zeros(50), np.arange(50.0), "sort the samples"),
        (np.arange(50.0), np.full(50, np.nan), "only 0 samples"),
    ],
)
def test_logs_that_tell_nothing_are_refused(t_log, y_log, says):
    t, y = on_reference(20.0)
    with pytest.raises(InputError, match=says):
        by_waveform(t, y, t_log, y_log)


def test_waveforms_without_overlap_are_refused():
    t, y = on_reference(40.0)
    pieces = [np.isin(t // 1, when) for when in ([0, 10, 30], [0, 15, 37])]
    (t_ref, y_ref), (t_log, y_log) = ((t[kept], y[kept]) for kept in pieces)
    with pytest.raises(InputError, match="have half of the shorter one in common"):
        by_waveform(t_ref, y_ref, t_log, y_log)


@given(st.floats(-1e3, 1e3), st.floats(0.1, 100))
@settings(max_examples=8)
def test_shift_of_the_log_and_unit_of_both_do_not_matter(by, scale):
    t, y = on_reference(10.0)
    t_log, y_log, _, _ = logged(chirp, 3, span_s=10.0, early_s=1.0)
    was = by_waveform(t, y, t_log, y_log)
    now = by_waveform(t, scale * y, t_log + by, scale * y_log)
    assert now.offset_s - was.offset_s == pytest.approx(by, abs=1e-6)
    assert now.u_offset_s == pytest.approx(was.u_offset_s, rel=0.01)


def test_smoothing_leaves_a_clean_signal_and_calms_a_noisy_one():
    t = np.linspace(0, 1, 500)
    clean = np.sin(7 * t)
    assert smoothing(clean)[0] < 1e-2
    strength, kept = smoothing(clean + 0.1 * np.random.default_rng(0).normal(size=500))
    assert strength > 10
    assert kept < 0.1
