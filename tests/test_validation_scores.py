"""Scores of single values and of several, V&V 20 and the grid convergence index."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simcompare.errors import InputError
from simcompare.statistics.agreement import (
    birge_ratio,
    coverage,
    e_n,
    rms,
    vv20,
    zeta,
)
from simcompare.statistics.grid_convergence import gci

VALUE, SIZE = st.floats(-100, 100), st.floats(0.01, 10)


def test_e_n_and_zeta_of_known_numbers():
    assert e_n(10.5, 10.0, 0.3, 0.4) == pytest.approx(1.0)
    assert zeta(10.5, 10.0, 0.15, 0.2) == pytest.approx(2.0)


def test_without_any_uncertainty_nothing_is_judged():
    assert e_n(1.0, 2.0, 0.0, 0.0) is None
    assert zeta(1.0, 2.0, 0.0, 0.0) is None


@pytest.mark.parametrize("bad", [(-1.0, 1.0), (math.nan, 1.0)])
def test_impossible_uncertainties_are_refused(bad):
    with pytest.raises(InputError):
        zeta(1.0, 2.0, *bad)


@given(VALUE, VALUE, SIZE, SIZE, VALUE, st.floats(0.1, 10))
def test_scores_do_not_depend_on_unit_or_origin_and_change_sign_when_exchanged(x, X, u, U, c, k):
    found = e_n(x, X, u, U)
    assert e_n(k * x + c, k * X + c, k * u, k * U) == pytest.approx(found, rel=1e-6, abs=1e-6)
    assert e_n(X, x, U, u) == pytest.approx(-found)
    assert zeta(x, X, u / 2, U / 2) == pytest.approx(2 * found)


def test_one_in_twenty_is_outside_when_the_uncertainties_are_right():
    chance = np.random.default_rng(3)
    inside = 0
    for _ in range(2000):
        u, U = chance.uniform(0.1, 2, 2)
        inside += abs(e_n(chance.normal(0, u), chance.normal(0, U), 2 * u, 2 * U)) <= 1
    assert 0.94 < inside / 2000 < 0.97


def test_the_weighted_mean_of_known_numbers():
    found = birge_ratio([1.0, 3.0], [1.0, 2.0])
    assert found.mean == pytest.approx((1 + 3 / 4) / (1 + 1 / 4))
    assert found.u_mean == pytest.approx(1 / math.sqrt(1.25))


@given(st.lists(st.tuples(VALUE, SIZE), min_size=2, max_size=8), st.randoms(use_true_random=False))
def test_mean_and_birge_ratio_do_not_depend_on_the_order(rows, chance):
    mixed = rows.copy()
    chance.shuffle(mixed)
    was, now = (birge_ratio(*zip(*r, strict=True)) for r in (rows, mixed))
    assert now.mean == pytest.approx(was.mean, rel=1e-9, abs=1e-9)
    assert now.ratio == pytest.approx(was.ratio, rel=1e-6, abs=1e-6)


def test_the_birge_ratio_of_agreeing_values_is_in_its_range_two_times_in_three():
    chance = np.random.default_rng(5)
    found = [birge_ratio(chance.normal(0, 1, 6), 1.0) for _ in range(1500)]
    assert (found[0].low, found[0].high) == pytest.approx(
        (1 - 1 / math.sqrt(10), 1 + 1 / math.sqrt(10))
    )
    assert 0.6 < np.mean([f.low <= f.ratio <= f.high for f in found]) < 0.75
    assert 0.93 < np.mean([f.consistent for f in found]) < 0.97


def test_values_that_disagree_are_inconsistent():
    found = birge_ratio([1.0, 2.0, 3.0], 0.1)
    assert not found.consistent
    assert found.ratio == pytest.approx(10.0)
    with pytest.raises(InputError, match="one value alone"):
        birge_ratio([1.0], 0.1)
    with pytest.raises(InputError, match="uncertainty greater than zero"):
        birge_ratio([1.0, 2.0], [0.1, 0.0])


def test_comparison_error_and_validation_uncertainty():
    found = vv20(10.3, 10.0, u_num=0.1, u_input=0.2, u_data=0.2)
    assert found.error == pytest.approx(0.3)
    assert found.u_val == pytest.approx(0.3)
    assert (found.e_n, found.zeta) == pytest.approx((0.5, 1.0))
    assert found.within_noise
    assert not vv20(10.7, 10.0, u_num=0.1, u_input=0.2, u_data=0.2).within_noise
    with pytest.raises(InputError, match=r"u_num.*\n.*u_data"):
        vv20(1.0, 1.0, u_num=-1.0, u_input=0.0, u_data=math.nan)


def test_a_value_of_which_a_part_of_the_uncertainty_is_unknown_is_not_judged():
    found = vv20(10.3, 10.0, u_num=None, u_input=0.3, u_data=0.4)
    assert found.u_val == pytest.approx(0.5)
    assert (found.e_n, found.zeta, found.within_noise) == (None, None, None)
    assert vv20(1.0, 2.0, u_num=0.0, u_input=0.0, u_data=0.0).e_n is None


def test_rms_and_coverage_leave_out_what_is_missing():
    assert rms([3.0, math.nan, -4.0]) == pytest.approx(math.sqrt(12.5))
    assert rms([3e-200, 4e-200]) == pytest.approx(math.sqrt(12.5) * 1e-200)
    assert rms([0.0, 0.0]) == 0.0
    assert coverage([1.0, -1.9, 2.1, math.nan], 1.0) == pytest.approx(2 / 3)
    assert coverage([1.0, 3.0], [1.0, 2.0]) == 1.0
    assert coverage([math.nan], 1.0) is None


def test_the_interval_of_the_model_error_covers_it_nineteen_times_in_twenty():
    chance = np.random.default_rng(7)
    hits = 0
    for _ in range(1000):
        a, b, c, true = chance.normal(0, [0.1, 0.2, 0.3, 1.0])
        found = vv20(5 + true + a + b, 5 + c, u_num=0.1, u_input=0.2, u_data=0.3)
        hits += abs(found.error - true) <= 2 * found.u_val
    assert 0.93 < hits / 1000 < 0.975


def of_step(h):
    return 1 + 0.3 * h + 0.02 * h**2


def test_the_order_of_a_known_series():
    found = gci(of_step(0.1), of_step(0.2), of_step(0.4))
    assert found.observed == pytest.approx(1.028, abs=5e-4)
    assert found.kind == "monotone"
    assert found.u_num == pytest.approx(found.error / 2)
    # the truth lies inside the band
    assert abs(of_step(0.1) - 1) < found.error


@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
def test_pure_powers_give_their_order_and_an_error_a_quarter_too_large(order):
    found = gci(*(7 - 2 * h**order for h in (0.1, 0.2, 0.4)))
    assert found.observed == pytest.approx(order, rel=1e-6)
    assert found.error == pytest.approx(1.25 * 2 * 0.1**order)


def test_two_steps_have_a_safety_factor_of_three():
    found = gci(1.01, 1.02)
    assert (found.kind, found.observed) == ("two grids", None)
    assert found.error == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ((1.0, 1.1, 0.9), "oscillatory"),
        ((1.0, 1.2, 1.3), "diverging"),
        ((1.0, 1.0, 1.3), "stalled"),
        ((1.0, 1.3, 1.3), "stalled"),
    ],
)
def test_runs_without_an_order_are_treated_with_caution(values, kind):
    found = gci(*values)
    assert (found.kind, found.observed) == (kind, None)
    assert found.error >= 3 * abs(values[1] - values[0])
    assert found.u_num >= np.std(values, ddof=1) * (1 - 1e-12)


def test_equal_values_have_no_numerical_error():
    assert gci(2.0, 2.0, 2.0).u_num == 0
    assert gci(2.0, 2.0, 2.0).kind == "converged"


def test_a_run_without_a_value_is_refused():
    with pytest.raises(InputError, match="a run gave nan"):
        gci(1.0, math.nan)


@given(st.floats(-5, 5), st.floats(0.2, 4), st.floats(0.1, 10), st.floats(-10, 10))
@settings(max_examples=50)
def test_the_index_scales_with_the_values_and_ignores_their_origin(slope, order, scale, shift):
    values = [slope * h**order for h in (0.1, 0.2, 0.4)]
    was = gci(*values)
    moved = gci(*(scale * v + shift for v in values))
    if was.kind == moved.kind == "monotone" and abs(slope) > 1e-2 and order < 3:
        assert moved.error == pytest.approx(scale * was.error, rel=1e-4)
