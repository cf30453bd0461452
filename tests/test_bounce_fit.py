"""Fits of closed forms: information limits, bias, coverage, priors, bounds."""

import json
import math

import numpy as np
import pytest
from scipy import stats

from simcompare.errors import InputError
from simcompare.fitting.bounces import profile, ratios, records
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.reading import from_times
from simcompare.fitting.bounces.tables import from_rebounds
from simcompare.model.plain import plain
from simcompare.reports.fit import answer
from simcompare.results.records.fit_forms import Prior
from simcompare.results.records.fit_parts import finite
from tests.bounces import IN_AIR, TERMINAL, TRUTH, filmed, heard, times_of, warnings_of

E = 0.85
DRAWS = 200
RECOMMENDED = {
    "drop_height_m": Prior(1.0, 1e-3),
    "terminal_speed_m_s": Prior(TERMINAL, 0.05 * TERMINAL),
}


def exact(count, values=IN_AIR) -> Impacts:
    """Impacts without noise, of which 0.1 ms is stated: their covariance is Cramér and Rao's."""
    return from_times(times_of(values, count), 1e-4)[0]


def u_of(found, name="restitution"):
    return found.u[found.names.index(name)]


def drawn(centre, u, generator):
    return Prior(float(generator.normal(centre, u)), u)


# ---- information limits -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "priors", "six", "nine"),
    [
        ("constant+drag", None, 3.7e-4, 1.1e-4),
        ("power+drag", None, 6.4e-3, 1.4e-3),
        ("power+drag", RECOMMENDED, 2.0e-3, 7.1e-4),
    ],
)
def test_uncertainties_are_those_of_cramer_and_rao(model, priors, six, nine):
    for count, expected in ((6, six), (9, nine)):
        found = fit(exact(count), model, priors=priors)
        assert found.as_dict()["restitution"] == pytest.approx(E, abs=1e-7)
        assert u_of(found) == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize(
    ("model", "six", "nine"), [("constant", 5.9e-5, 2.6e-5), ("power", 3.3e-4, 1.4e-4)]
)
def test_a_known_terminal_speed_leaves_as_much_as_cramer_and_rao_say(model, six, nine):
    for count, expected in ((6, six), (9, nine)):
        found = fit(exact(count), model, fixed={"terminal_speed_m_s": TERMINAL})
        assert u_of(found) == pytest.approx(expected, rel=0.1)


def test_the_terminal_speed_is_known_as_well_as_the_limit_allows():
    for count, expected in ((6, 0.045), (9, 0.019)):
        found = fit(exact(count), "constant+drag")
        assert u_of(found, "terminal_speed_m_s") == pytest.approx(expected, rel=0.1)


def test_seven_hits_at_a_tenth_of_a_millisecond_give_the_restitution_to_a_twentieth_of_a_percent():
    errors = [fit(heard(seed=s), profiles=False).as_dict()["restitution"] - E for s in range(50)]
    assert np.max(np.abs(errors)) <= 0.0005 * E


def test_a_video_of_thirty_frames_gives_the_restitution_to_a_fifth_of_a_percent():
    found = [fit(filmed(seed=s), profiles=False) for s in range(30)]
    errors = [f.as_dict()["restitution"] - E for f in found]
    assert np.max(np.abs(errors)) <= 0.002 * E
    # near what the samples can tell at all, for three seconds from the release on
    assert np.std(errors) < 4e-4


# ---- coverage -----------------------------------------------------------------------------------


def covered(fits):
    hits = []
    for found in fits:
        low, high = found.intervals[found.names.index("restitution")]
        hits.append(low <= E <= high)
    return np.mean(hits)


def test_intervals_cover_the_truth_for_a_constant_restitution():
    assert 0.90 <= covered(fit(heard(seed=s)) for s in range(DRAWS)) <= 0.99


def test_intervals_cover_the_truth_with_drag_and_a_prior():
    generator = np.random.default_rng(0)

    def draws():
        for seed in range(DRAWS):
            priors = {"terminal_speed_m_s": drawn(TERMINAL, 0.43, generator)}
            yield fit(heard(IN_AIR, seed=seed), "constant+drag", priors=priors)

    assert 0.90 <= covered(draws()) <= 0.99


def test_intervals_cover_the_truth_from_video():
    assert 0.90 <= covered(fit(filmed(seed=s)) for s in range(DRAWS)) <= 0.99


def test_intervals_cover_the_truth_where_no_uncertainty_is_stated():
    fits = (
        fit(from_times(heard(seed=s, count=9).times_s)[0], profiles=False)
        for s in range(DRAWS // 2)
    )
    assert 0.88 <= covered(fits) <= 0.995


# ---- drag ---------------------------------------------------------------------------------------


def test_drag_in_the_model_leaves_no_bias_beyond_the_interval():
    found = [fit(heard(IN_AIR, seed=s), "constant+drag") for s in range(20)]
    pulls = [(f.as_dict()["restitution"] - E) / u_of(f) for f in found]
    assert abs(np.mean(pulls)) < 3 / math.sqrt(20)


def test_drag_left_out_biases_a_table_tennis_ball_by_three_and_a_half_percent():
    found = fit(exact(7))
    assert found.as_dict()["restitution"] / E - 1 == pytest.approx(-0.035, abs=0.001)
    assert found.rms["times"] == pytest.approx(5.1e-3, rel=0.02)
    assert found.s2 > 1000
    factor = f"scatter {math.sqrt(found.s2):.1f} times as much as stated"
    assert any(factor in text for text in warnings_of(found))


@pytest.mark.parametrize(
    ("terminal", "bias", "rms"), [(30.0, -0.0040, 0.59e-3), (60.0, -0.0010, 0.15e-3)]
)
def test_drag_left_out_biases_heavier_balls_less(terminal, bias, rms):
    found = fit(exact(7, {**TRUTH, "terminal_speed_m_s": terminal}))
    assert found.as_dict()["restitution"] / E - 1 == pytest.approx(bias, rel=0.15)
    assert found.rms["times"] == pytest.approx(rms, rel=0.15)


def test_vacuum_needs_no_drag_and_the_words_say_so():
    found = next(f for f in (fit(heard(seed=s), "constant+drag") for s in range(20)) if f.at_bound)
    assert found.as_dict()["terminal_speed_m_s"] == math.inf
    low, high = found.intervals[found.names.index("terminal_speed_m_s")]
    assert 20 < low < 1000
    assert high == math.inf
    (said,) = [text for text in warnings_of(found) if "no air drag is seen" in text]
    assert f"the terminal speed is above {low:.3g} m/s" in said
    form = finite(records.form_of(found))
    assert form.parameters["terminal_speed_m_s"].value is None


# ---- covariance, intervals, ratios --------------------------------------------------------------


def test_ratios_of_flights_do_not_change_with_offset_and_rate_of_the_clock():
    drop = heard()
    moved = from_times(7.0 + (1 + 80e-6) * drop.times_s, 1e-4)[0]
    assert ratios.ratios(moved).values == pytest.approx(ratios.ratios(drop).values, rel=1e-12)
    assert ratios.ratios(moved).mean == pytest.approx(ratios.ratios(drop).mean, rel=1e-12)
    plain, fast = fit(drop).as_dict(), fit(moved).as_dict()
    assert fast["restitution"] == pytest.approx(plain["restitution"], rel=1e-7)
    # what the rate does change: the drop looks higher, by its square
    assert fast["drop_height_m"] / plain["drop_height_m"] == pytest.approx(1 + 160e-6, rel=1e-6)


def test_ratios_have_the_uncertainty_of_flights_that_share_an_impact():
    found = ratios.ratios(exact(7, TRUTH))
    flight = np.diff(times_of(TRUTH, 7))[:-1]
    assert found.u == pytest.approx(math.sqrt(2) * 1e-4 * math.sqrt(1 + E + E * E) / flight)
    assert found.values == pytest.approx([E] * 5)


def test_ratios_that_rise_are_named_as_the_mark_of_drag():
    row, *_ = ratios.of_drops([heard(IN_AIR)])
    assert "rise by" in answer.trend(row)
    assert "drag" in answer.trend(row)
    level, *_ = ratios.of_drops([exact(7, TRUTH)])
    assert "no trend" in answer.trend(level)


def test_noise_that_exceeds_its_statement_widens_the_interval():
    drop = from_times(times_of() + np.random.default_rng(1).normal(0, 5e-4, 7), 1e-4)[0]
    found, plain = fit(drop), fit(heard())
    assert found.s2 > 4
    wider = math.sqrt(found.s2) * stats.t.ppf(0.975, found.dof) / stats.norm.ppf(0.975)
    assert u_of(found) == pytest.approx(u_of(plain) * wider, rel=0.05)
    factor = f"scatter {math.sqrt(found.s2):.1f} times as much as stated"
    assert any(factor in text for text in warnings_of(found))


def test_less_noise_than_stated_is_no_reason_for_smaller_intervals():
    drop = from_times(times_of(), 1e-4)[0]
    assert fit(drop).s2 == 1.0
    assert fit(drop).chi2 < 1e-6


def test_a_profile_of_a_straight_problem_is_the_normal_interval():
    found = fit(heard(), profiles=False)
    taken = profile.profile(found, "restitution")
    k = found.names.index("restitution")
    assert (taken.low, taken.high) == pytest.approx(found.intervals[k], rel=1e-4)
    assert taken.chi2.min() >= 0


def test_profiles_replace_intervals_of_what_is_correlated():
    found = fit(heard(IN_AIR), "power+drag")
    assert found.how[found.names.index("terminal_speed_m_s")] == "profile"
    low, high = found.intervals[found.names.index("terminal_speed_m_s")]
    best = found.as_dict()["terminal_speed_m_s"]
    assert high - best > 1.1 * (best - low)


# ---- priors and bounds --------------------------------------------------------------------------


def test_a_prior_that_contradicts_the_data_is_told():
    found = fit(heard(), priors={"drop_height_m": Prior(1.02, 1e-3)})
    assert found.pulls["drop_height_m"] < -3
    (said,) = [text for text in warnings_of(found) if "contradicts" in text]
    assert "the prior 1.02 ± 0.001 of drop height" in said
    assert "below it" in said


def test_a_wrong_terminal_speed_is_told_with_its_side():
    found = fit(heard(IN_AIR), "constant+drag", priors={"terminal_speed_m_s": Prior(9.5, 0.1)})
    (said,) = [text for text in warnings_of(found) if "contradicts" in text]
    assert "below it" in said


def test_priors_that_agree_are_not_complained_about():
    generator = np.random.default_rng(3)
    told = 0
    for seed in range(60):
        priors = {"drop_height_m": drawn(1.0, 1e-3, generator)}
        told += any("contradicts" in t for t in warnings_of(fit(heard(seed=seed), priors=priors)))
    assert told <= 2


def test_a_prior_pulls_as_far_as_its_weight():
    free = fit(heard(IN_AIR), "constant+drag")
    held = fit(heard(IN_AIR), "constant+drag", priors={"drop_height_m": Prior(1.0, 1e-5)})
    assert held.as_dict()["drop_height_m"] == pytest.approx(1.0, abs=5e-5)
    assert u_of(held) < 0.6 * u_of(free)
    assert held.effective < 3.1


def test_scatter_widens_the_data_and_not_the_prior():
    drop = from_times(times_of() + np.random.default_rng(1).normal(0, 2e-3, 7), 1e-4)[0]
    found = fit(drop, priors={"drop_height_m": Prior(1.0, 1e-3)})
    assert found.s2 > 50
    assert u_of(found, "drop_height_m") <= 1e-3


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"unknowns": ["restitutoin"]}, "did you mean restitution"),
        ({"priors": {"restitution": Prior(0.8, 0.0)}}, "an uncertainty above 0"),
        ({"priors": {"terminal_speed_m_s": Prior(-1, 1)}}, "a speed is above 0"),
        ({"unknowns": ["restitution"], "fixed": {"restitution": 0.8}}, "both sought and fixed"),
        ({"fixed": {"colour": 1.0}}, "no parameter of a bounce is called 'colour'"),
    ],
)
def test_a_wrong_request_is_refused_in_words(request_, message):
    with pytest.raises(InputError, match=message):
        fit(heard(), **request_)


def test_too_few_bounces_are_refused_in_words_and_a_known_height_helps():
    two = from_times(times_of(count=2), 1e-4)[0]
    with pytest.raises(InputError, match=r"2 measured numbers and 0 priors cannot give 3 unknowns"):
        fit(two)
    found = fit(two, fixed={"drop_height_m": 1.0})
    assert found.as_dict()["restitution"] == pytest.approx(E, abs=1e-9)
    assert any("nothing can show a wrong model" in text for text in warnings_of(found))


def test_unknown_noise_with_nothing_left_to_tell_it_is_refused():
    with pytest.raises(InputError, match="nothing tells the scatter of 3 measured numbers"):
        fit(from_times(times_of(count=3))[0])


# ---- other data ---------------------------------------------------------------------------------


def test_a_missed_impact_costs_information_but_no_bias():
    whole, holed = exact(8), from_times(np.delete(times_of(IN_AIR, 8), 3), 1e-4)[0]
    found = [fit(d, "constant+drag") for d in (whole, holed)]
    assert found[1].as_dict()["restitution"] == pytest.approx(E, abs=1e-7)
    assert u_of(found[0]) < u_of(found[1]) < 2 * u_of(found[0])


def test_rebound_heights_give_the_restitution():
    generator = np.random.default_rng(0)
    heights = 0.85 ** (2 * np.arange(1, 6)) + generator.normal(0, 1e-3, 5)
    found = fit(from_rebounds(heights, 1e-3, drop_height=(1.0, 1e-3)), unknowns=[
        "restitution", "drop_height_m"
    ])  # fmt: skip
    assert abs(found.as_dict()["restitution"] - E) < 3 * u_of(found)
    assert u_of(found) < 5e-4


def test_several_drops_share_the_ball_and_have_heights_of_their_own():
    drops = [heard({**IN_AIR, "drop_height_m": h}, seed=k) for k, h in enumerate((0.5, 0.9, 1.3))]
    found = fit(drops, "constant+drag")
    assert found.names == (
        "restitution", "terminal_speed_m_s", "drop_height_m[1]", "drop_height_m[2]",
        "drop_height_m[3]", "release_time_s[1]", "release_time_s[2]", "release_time_s[3]",
    )  # fmt: skip
    assert abs(found.as_dict()["restitution"] - E) < 3 * u_of(found)
    assert u_of(found) < 0.7 * u_of(fit(drops[1], "constant+drag"))
    assert found.as_dict()["drop_height_m[3]"] == pytest.approx(1.3, abs=0.01)


def test_the_effective_restitution_carries_its_uncertainty_over_the_speeds():
    found = fit(heard({**TRUTH, "exponent": 0.05}, count=9), "power")
    for speed in found.speeds_m_s:
        value, u = found.restitution_at(speed)
        assert abs(value - 0.85 * (speed / 4) ** -0.05) < 4 * u
        assert 0 < u < 1e-3


# ---- output ---------------------------------------------------------------------------


def test_a_fit_becomes_plain_values():
    found = fit(heard(IN_AIR), "power+drag", priors=RECOMMENDED)
    form = plain(finite(records.form_of(found)))
    json.dumps(form, allow_nan=False)
    assert form["model"] == "power+drag"
    row = form["parameters"]["restitution"]
    assert row["low"] < row["value"] < row["high"]
    assert set(form["pulls"]) == set(RECOMMENDED)
    assert form["s2"] >= 1
