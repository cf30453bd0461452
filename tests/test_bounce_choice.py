"""Which model the data ask for, and how estimates scatter in simulated and resampled repeats."""

import json
import math
import re

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.fitting.bounces import bootstrap, model_selection, records
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.reading import from_times
from simcompare.model.plain import plain
from simcompare.results.records.fit_forms import RIVAL
from simcompare.results.records.fit_parts import finite
from tests.bounces import IN_AIR, TRUTH, choice_words, filmed, heard, times_of

E = 0.85


# ---- choice -------------------------------------------------------------------------------------


def test_the_choice_of_model_sees_the_drag_and_says_what_leaving_it_out_costs():
    choice = model_selection.compare(heard(IN_AIR, count=8))
    assert choice.best.model == "constant+drag"
    simple = next(c for c in choice.candidates if c.model == "constant")
    assert simple.delta > 1000
    assert simple.weight < 1e-9
    (said,) = [w for w in choice_words(choice) if "without drag does not fit" in w]
    assert re.search(r" 3\.\d % too low$", said)


def test_drag_in_a_video_is_seen_by_its_arcs():
    choice = model_selection.compare(filmed(IN_AIR), ["constant", "constant+drag"])
    assert choice.best.model == "constant+drag"
    low, high = choice.best.intervals[0]
    assert low <= E <= high


def test_a_constant_restitution_is_chosen_where_there_is_nothing_else():
    chosen = [model_selection.compare(heard(seed=s, count=8)) for s in range(10)]
    assert sum(c.best.model == "constant" for c in chosen) >= 7
    assert all(c.dof == 0 for c in chosen)
    assert all(sum(r.weight for r in c.candidates) == pytest.approx(1) for c in chosen)


def test_velocity_dependence_is_told_from_drag_where_the_data_can():
    values = {**TRUTH, "exponent": 0.05}
    choice = model_selection.compare(heard(values, count=9))
    # so small an exponent is nearly the same in both
    assert choice.best.model in ("power", "logarithmic")
    drag = next(c for c in choice.candidates if c.model == "constant+drag")
    assert drag.delta > 10


def test_a_hunt_crossley_contact_is_recognised():
    choice = model_selection.compare(heard(count=8, model="hunt_crossley"))
    assert choice.best.model == "hunt_crossley"


def test_what_the_data_cannot_tell_is_said_with_what_would_help():
    values = {**TRUTH, "terminal_speed_m_s": 25.0}
    choice = model_selection.compare(heard(values, count=6, u_s=1e-3))
    assert {c.model for c in choice.candidates if c.delta < RIVAL} >= {
        "constant+drag",
        "power",
    }
    told = "cannot tell air drag from a restitution that depends on speed: give the terminal speed"
    assert any(told in w for w in choice_words(choice))
    known = model_selection.compare(
        heard(values, count=6, u_s=1e-3), fixed={"terminal_speed_m_s": 25.0}
    )
    assert not any("give the terminal speed" in w for w in choice_words(known))


def test_the_numbers_of_the_choice_are_akaike_and_schwarz():
    choice = model_selection.compare(heard(IN_AIR, count=9), ["constant", "constant+drag"])
    for c in choice.candidates:
        k, n = len(c.fit.names), 9
        assert c.unknowns == pytest.approx(k)
        assert c.aic == pytest.approx(c.chi2 + 2 * k)
        assert c.bic == pytest.approx(c.chi2 + k * math.log(n))
    assert choice.candidates[1].delta == pytest.approx(
        choice.candidates[1].aic - choice.candidates[0].aic
    )


def test_unknown_noise_is_told_by_the_richest_law():
    choice = model_selection.compare(from_times(heard(IN_AIR, count=10).times_s)[0])
    assert choice.best.model.endswith("+drag")  # a slope beside it may help by chance
    assert choice.dof == 10 - 5
    for c in choice.candidates:
        misfit = 5 * math.log(c.chi2 / 5)
        assert c.aic == pytest.approx(misfit + 2 * c.unknowns)
        assert c.bic == pytest.approx(misfit + c.unknowns * math.log(10))


def test_a_model_with_too_many_unknowns_is_refused_and_the_others_stand():
    choice = model_selection.compare(from_times(times_of(IN_AIR, 4), 1e-4)[0])
    assert list(choice.refused) == ["power+drag", "linear+drag", "logarithmic+drag"]
    assert "4 measured numbers and 0 priors cannot give 5 unknowns" in choice.refused["power+drag"]
    json.dumps(plain(finite(records.choice_of(choice))), allow_nan=False)


def test_one_bounce_does_not_tell_two_unknowns_apart():
    heights = {"heights_m": np.array([1.0, 0.64]), "u_heights_m": np.array([1e-3, 1e-3])}
    drop = Impacts(height_numbers=(0, 1), **heights)
    with pytest.raises(InputError, match="1 measured number and 0 priors cannot give 2 unknowns"):
        model_selection.compare(drop, ["constant+drag"], fixed={"drop_height_m": 1.0})


# ---- bootstrap ----------------------------------------------------------------------------------


def test_the_parametric_bootstrap_agrees_with_the_covariance():
    found = fit(heard(IN_AIR), "constant+drag")
    again = bootstrap.parametric(found, seed=1)
    assert len(again.draws) == 200
    assert again.failed == 0
    assert again.u == pytest.approx(found.u, rel=0.2)
    assert np.abs(again.bias / found.u).max() < 0.4


def test_the_bootstrap_is_the_same_for_the_same_seed():
    found = fit(heard())
    one, two, other = (bootstrap.parametric(found, 20, seed=s) for s in (5, 5, 6))
    assert one.draws.tolist() == two.draws.tolist()
    assert one.draws.tolist() != other.draws.tolist()
