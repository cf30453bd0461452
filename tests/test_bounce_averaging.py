"""What closed forms of a bounce say together."""

import math

import pytest

from simcompare.errors import InputError
from simcompare.fitting.bounces.averaging import averaged
from simcompare.fitting.bounces.bounce_models import MODELS
from simcompare.fitting.bounces.budget import budgets
from simcompare.fitting.bounces.model_selection import compare
from tests.bounces import IN_AIR, TRUTH, heard


def test_a_law_that_was_told_is_not_averaged():
    choice = compare(heard(), ["power"])
    value, u = choice.best.restitution_at(3.0)
    assert averaged(choice).restitution_at(3.0) == pytest.approx(
        (value, u, value - 1.96 * u, value + 1.96 * u), rel=1e-4
    )


def test_laws_that_fit_as_well_widen_the_interval():
    choice = compare(heard({**TRUTH, "terminal_speed_m_s": 25.0}, count=6, u_s=1e-3))
    _, u = choice.best.restitution_at(4.0)
    value, u_all, low, high = averaged(choice).restitution_at(4.0)
    assert low < 0.85 < high
    assert low < value < high
    assert u_all > 2 * u


def test_one_law_whose_drag_ended_at_0_leaves_room_for_some():
    values = {**TRUTH, "terminal_speed_m_s": 25.0}
    drops = (heard(values, count=6, u_s=1e-3, seed=seed) for seed in range(20))
    choices = (compare(drop, ["constant+drag"]) for drop in drops)
    choice = next(one for one in choices if one.best.at_bound)
    told = averaged(choice)
    value, u, low, high = told.restitution_at(4.0)
    assert u > 2 * choice.best.restitution_at(4.0)[1]  # that of the fit itself knows no drag
    assert low < 0.85 < high
    assert low < value < high
    assert told.unknown("terminal_speed_m_s").high == math.inf


def test_the_budget_has_the_uncertainty_that_is_told():
    for seed, models in ((1, ["constant+drag"]), (2, ["power+drag"]), (3, list(MODELS))):
        choice = compare(heard(IN_AIR, count=7, u_s=1e-3, seed=seed), models)
        told = averaged(choice)
        for row in budgets(choice, told):
            fast = choice.best.speeds_m_s[1]
            is_law = row.name == "restitution"
            u = told.restitution_at(fast)[1] if is_law else told.unknown(row.name).u
            assert row.u == u
            assert sum(row.shares.values()) == pytest.approx(1)


def test_what_the_numbers_do_not_tell_is_refused():
    # a ball that has nearly reached its terminal speed would have fallen from anywhere
    fixed = {"terminal_speed_m_s": 2.0, "restitution": 0.8}
    values = {**fixed, "drop_height_m": 20.0}
    drop = heard(values, count=3, u_s=1e-3)
    with pytest.raises(InputError, match="tell nothing of drop_height_m; correct what is fixed"):
        compare(drop, ["constant+drag"], fixed={**fixed, "release_time_s": 0.0})
