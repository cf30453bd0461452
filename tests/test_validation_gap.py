"""The split of a gap: its parts sum to the whole, and its interval covers."""

import math
from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.signal import lfilter

from simcompare.errors import InputError
from simcompare.statistics.gap import block_length, split
from simcompare.statistics.noise import measured_noise

NUMBERS = st.floats(-1e3, 1e3).map(lambda x: round(x, 3))
TRIPLES = st.integers(10, 40).flatmap(
    lambda n: st.tuples(*[arrays(float, n, elements=NUMBERS) for _ in range(3)])
)


def wandering(chance, n, size, memory=0.9):
    """A model error of a given rms that wanders with a memory of so much per sample."""
    white = chance.normal(size=n + 2000)
    return size * lfilter([math.sqrt(1 - memory**2)], [1, -memory], white)[2000:]


def made(seed, n=2000, *, model=0.05, noise=0.02, shift=0.2, memory=0.9):
    chance = np.random.default_rng(seed)
    t = 0.01 * np.arange(n)
    truth = np.sin(3 * t)
    best = truth + wandering(chance, n, model, memory)
    return truth + noise * chance.normal(size=n), best + shift * np.cos(t), best


def test_the_parts_of_a_known_gap_are_found():
    found = split(*made(1, 10_000), u_data=0.02)
    assert found.parameter == pytest.approx(0.2 * math.sqrt(0.5), rel=0.03)
    assert found.model_form == pytest.approx(0.05, rel=0.1)
    assert found.noise == 0.02
    assert found.noise_from == "stated"
    assert found.remaining == pytest.approx(math.hypot(0.05, 0.02), rel=0.1)
    assert abs(found.correlation) < 0.2
    assert not found.clipped


@given(TRIPLES, st.floats(0, 100), st.floats(0, 100))
@settings(max_examples=60)
def test_the_parts_sum_exactly_to_the_total(signals, u_data, u_num):
    measured, nominal, best = signals
    found = split(measured, nominal, best, u_data, u_num, draws=20)
    total = np.mean((nominal - measured) ** 2)
    shares = asdict(found.shares)
    assert shares.pop("removed") == pytest.approx(shares["parameter"] + shares["cross"], rel=1e-6)
    size = found.parameter**2 + found.remaining**2
    parts = sum(shares.values()) * found.total**2
    assert parts == pytest.approx(total, abs=1e-9 * size + 1e-300)
    assert found.total == pytest.approx(math.sqrt(total), abs=1e-6 * math.sqrt(size))
    assert found.clipped == (found.excess < 0)
    assert found.model_form == 0 or found.excess == 0
    assert found.model_form_low <= found.model_form_high


@given(st.floats(-1e3, 1e3), st.floats(0.01, 100))
@settings(max_examples=20)
def test_origin_and_unit_of_the_signal_do_not_matter(shift, scale):
    signals = made(2, 400)
    was = split(*signals, 0.02, 0.01, draws=50)
    now = split(*(scale * s + shift for s in signals), scale * 0.02, scale * 0.01, draws=50)
    for name in ("total", "parameter", "remaining", "model_form", "model_form_high", "noise"):
        assert getattr(now, name) == pytest.approx(scale * getattr(was, name), rel=1e-6)
    assert asdict(now.shares) == pytest.approx(asdict(was.shares), abs=1e-6)


def test_parts_that_oppose_each_other_have_a_negative_cross_term():
    t = np.linspace(0, 20, 500)
    found = split(np.zeros(500), 0.2 * np.sin(t), 1.0 * np.sin(t), 0.0)
    # the nominal model is nearer than the "best" one: the parameter part makes up for the rest
    assert found.correlation == pytest.approx(-1.0)
    assert found.total < found.parameter
    assert found.shares.cross < -1


def test_noise_that_explains_more_than_is_left_clips_the_model_form_and_says_so():
    measured, nominal, best = made(3, 500, model=0.0)
    found = split(measured, nominal, best, 0.03)
    assert found.model_form == 0
    assert found.clipped
    assert found.excess == pytest.approx(found.remaining**2 - 0.03**2)
    assert found.model_form_low == 0


def test_the_numerical_error_is_taken_out():
    found = split(*made(1, 4000), 0.02, 0.03)
    assert found.numerical == 0.03
    without = split(*made(1, 4000), 0.02)
    assert found.model_form**2 == pytest.approx(without.model_form**2 - 0.03**2)


@pytest.mark.parametrize(
    ("n", "options", "stated"),
    [
        (500, {"memory": 0.0}, True),
        (2000, {}, True),
        (2000, {}, False),
        (2000, {"model": 0.01}, False),
        (10_000, {"memory": 0.99}, True),
    ],
)
def test_the_interval_of_the_model_form_covers_nineteen_times_in_twenty(n, options, stated):
    true, inside = options.get("model", 0.05), 0
    for seed in range(200):
        found = split(*made(seed, n, **options), 0.02 if stated else None, draws=300)
        inside += found.model_form_low <= true <= found.model_form_high
    assert 0.9 <= inside / 200 <= 0.985


def test_without_a_model_error_the_interval_begins_at_zero():
    zero = [split(*made(seed, 1000, model=0.0), 0.02).model_form_low == 0 for seed in range(100)]
    assert np.mean(zero) > 0.93


def test_the_same_data_give_the_same_interval():
    assert split(*made(1), 0.02) == split(*made(1), 0.02)


@pytest.mark.parametrize("sigma", [1e-3, 0.02, 0.2])
def test_noise_is_told_from_second_differences(sigma):
    t, found = 0.01 * np.arange(4000), []
    for seed in range(30):
        chance = np.random.default_rng(seed)
        found.append(measured_noise(np.sin(3 * t) + sigma * chance.normal(size=len(t))))
    values = np.array([one.value for one in found])
    assert values.mean() == pytest.approx(sigma, rel=0.15 if sigma < 0.01 else 0.02)
    if sigma > 0.01:
        pulls = (values - sigma) / np.array([one.u for one in found])
        assert 0.6 < pulls.std() < 1.4


def test_jumps_do_not_pass_for_noise_and_gaps_are_skipped():
    chance = np.random.default_rng(0)
    y = 0.01 * chance.normal(size=3000)
    y[500:] += 5
    y[1200:] -= 8
    y[2000:2100] = np.nan
    assert measured_noise(y).value == pytest.approx(0.01, rel=0.1)


def test_steps_of_a_counter_are_noise_of_a_rectangle():
    t = np.arange(3000)
    step = 0.25
    found = measured_noise(step * np.round(np.sin(t / 400) / step))
    assert found.value == pytest.approx(step / math.sqrt(12))
    assert "smallest step" in found.text


def test_noise_that_is_not_stated_is_estimated_and_said_to_be():
    found = split(*made(4, 4000, model=0.0))
    assert found.noise == pytest.approx(0.02, rel=0.1)
    assert "second difference" in found.noise_from


def test_blocks_are_long_where_the_record_remembers():
    chance = np.random.default_rng(0)
    assert block_length(chance.normal(size=5000)) <= 4
    assert 15 < block_length(wandering(chance, 5000, 1.0, 0.95)) < 500
    assert block_length(np.ones(100)) == 1


def test_missing_samples_are_left_out():
    measured, nominal, best = made(6, 1000)
    measured[100:150] = np.nan
    best[-20:] = np.nan
    found = split(measured, nominal, best, 0.02)
    assert found.n == 930
    kept = np.isfinite(measured) & np.isfinite(best)
    assert found.total == pytest.approx(np.sqrt(np.mean((nominal - measured)[kept] ** 2)))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"measured": np.zeros(3)}, "3 measured"),
        ({"measured": np.full(50, np.nan)}, "only 0 samples"),
        ({"u_num": -1.0}, "zero or more"),
        ({"u_data": -1.0}, "negative or missing"),
    ],
)
def test_impossible_input_is_refused(change, says):
    given_ = {"measured": np.zeros(50), "nominal": np.ones(50), "best": np.ones(50)}
    with pytest.raises(InputError, match=says):
        split(**{**given_, **change})


def test_equal_signals_have_no_gap():
    y = np.sin(np.arange(100.0))
    found = split(y, y, y, 0.0)
    assert found.total == 0
    assert (found.model_form_low, found.model_form_high) == (0.0, 0.0)
    assert set(asdict(found.shares).values()) == {0.0}
