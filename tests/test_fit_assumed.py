"""What a fit of bounces assumes: gravity, the recorder's clock, lengths of a video, given drag."""

import shlex
from dataclasses import replace

import numpy as np
import pytest

import simcompare
from simcompare.errors import InputError
from simcompare.fitting.bounces import assumed, budget, initial_guess, model_selection
from simcompare.fitting.bounces.averaging import averaged
from simcompare.fitting.bounces.bounce_models import MODELS, bounces
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.identifiability import identifiability
from simcompare.fitting.bounces.likelihood import COVERAGE, minimise
from simcompare.fitting.bounces.problem import build
from simcompare.fitting.bounces.reading import from_times
from simcompare.fitting.bounces.roles import roles_of
from simcompare.fitting.bounces.unknowns import internal
from simcompare.propagation import inputs
from simcompare.reports.fit import budget as budget_words
from simcompare.reports.fit import fits
from simcompare.results.records.fit_forms import Prior
from simcompare.results.records.fit_parts import DATA
from simcompare.scenarios import catalogue
from simcompare.statistics.least_squares import covariance_of
from tests.bounces import IN_AIR, TRUTH, filmed, heard, known_words, times_of

#: the gravity of a place that nobody looked up, as the ball says
GRAVITY = Prior(9.80665, 0.03 / 3**0.5, "From the equator to the poles.")
PLACE = {"gravity_m_s2": GRAVITY, "clock_skew": assumed.QUARTZ}
CAMERA = {"gravity_m_s2": GRAVITY, "clock_skew": assumed.FRAMES, "scale": assumed.LENGTHS}
#: uncertainty of an impact that was heard
U_S = 1e-5


def exact(count):
    """Impacts in air without noise."""
    return from_times(times_of(IN_AIR, count), U_S)[0]


def of(found, name):
    """Estimate and standard uncertainty of an unknown."""
    k = found.names.index(name)
    return found.values[k], found.u[k]


# ---- sizes --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "truth", "names"),
    [
        ("constant", TRUTH, ("restitution", "drop_height_m")),
        ("constant+drag", IN_AIR, ("restitution", "drop_height_m", "terminal_speed_m_s")),
    ],
)
def test_intervals_hold_where_gravity_and_clock_are_other_ones(model, truth, names):
    generator, draws = np.random.default_rng(5), 2000
    own = {n: generator.normal(prior.value, prior.u, draws) for n, prior in PLACE.items()}
    whole = build([heard(truth, count=8, u_s=U_S)], MODELS[model], priors=PLACE)
    data = bounces(MODELS["power"], {**truth, **own}, 8).impact_s
    best = minimise(whole, np.tile(initial_guess.of(whole), (draws, 1)),
                    data + generator.normal(0, U_S, data.shape))  # fmt: skip
    assert best.converged.all()
    for name in names:
        k = whole.names.index(name)
        u = [covariance_of(jacobian)[k, k] ** 0.5 for jacobian in best.jacobian]
        inside = np.abs(best.x[:, k] - internal(name, truth[name])) < COVERAGE * np.array(u)
        # 95 %, and three standard deviations of 2000 draws
        assert inside.mean() == pytest.approx(0.95, abs=0.015), name


def test_a_clock_that_is_20_ppm_fast_leaves_the_height_within_its_uncertainty():
    drop = heard({**TRUTH, "clock_skew": 20e-6}, count=9, u_s=1e-6)
    known = {"gravity_m_s2": GRAVITY.value}
    height, u = of(fit(drop, fixed=known, priors={"clock_skew": assumed.QUARTZ}), "drop_height_m")
    assert abs(height - 1) < 3 * u
    # the same clock taken as exact is many uncertainties off
    height, u = of(fit(drop, fixed={**known, "clock_skew": 0.0}), "drop_height_m")
    assert abs(height - 1) > 3 * u


@pytest.mark.parametrize("model", ["constant", "power", "constant+drag"])
def test_what_was_heard_tells_the_restitution_whatever_gravity_and_clock_are(model):
    drop = heard(IN_AIR if "drag" in model else TRUTH, count=8, u_s=U_S)
    exactly, here = fit(drop, model), fit(drop, model, priors=PLACE)
    # ratios of flights hold neither, and a power of the speed little of gravity
    assert here.restitution_at(4.0) == pytest.approx(exactly.restitution_at(4.0), rel=1e-3)


def test_height_and_terminal_speed_go_with_gravity():
    found = fit(exact(8), "constant+drag", priors=PLACE)
    drag = fit(exact(8), "constant+drag")
    for name in ("drop_height_m", "terminal_speed_m_s"):
        value, u = of(found, name)
        # both are lengths over times: as g, and as 1 + skew twice or once
        least = value * GRAVITY.u / GRAVITY.value
        assert u == pytest.approx(np.hypot(least, of(drag, name)[1]), rel=0.02), name


def test_a_video_whose_rod_is_half_a_per_cent_off_is_not_taken_for_drag():
    drop = filmed({**TRUTH, "scale": 1.005})
    plain, found = (fit(drop, "constant", priors=known) for known in ({}, CAMERA))
    value, u = of(found, "restitution")
    assert abs(value - TRUTH["restitution"]) < 3 * u
    assert found.chi2 < plain.chi2 - 3.84  # the fall tells the scale
    assert of(found, "scale")[0] == pytest.approx(1.005, abs=3 * of(found, "scale")[1])
    assert "scale" not in found.assumed


def test_of_equals_the_one_without_drag_is_chosen_in_a_video_too():
    # where u comes from the scatter, priors weigh a little less in the law with one more unknown
    drop = filmed({**TRUTH, "scale": 1.004}, seed=2, stated=False)
    choice = model_selection.compare(drop, ["constant", "constant+drag"], priors=CAMERA)
    assert "terminal_speed_m_s" in choice.candidates[1].fit.at_bound
    assert choice.best.model == "constant"


def test_drag_of_a_coefficient_is_as_sure_as_the_scenario_says():
    file = catalogue.load("ball")
    given = {name: one.value for name, one in file.parameters.items()}
    roles = roles_of(file, {**given, "drag_coefficient": 0.47})
    known = roles.known({}, {})[1]["terminal_speed_m_s"]
    # another coefficient that a smooth sphere may have
    other = roles_of(file, {**given, "drag_coefficient": 0.42}).known({}, {})[1]
    assert abs(other["terminal_speed_m_s"].value - known.value) < 3 * known.u
    assert known.reason
    assert "terminal_speed_m_s" not in roles_of(file, given).known({}, {})[1]  # vacuum
    fixed, priors = roles.known({"terminal_speed_m_s": 9.0, "gravity_m_s2": 9.81}, {})
    assert fixed == {"terminal_speed_m_s": 9.0, "gravity_m_s2": 9.81}
    assert priors == {}


# ---- no finding ---------------------------------------------------------------------------------


def test_what_only_its_prior_knows_is_no_finding():
    found = fit(heard(u_s=U_S), priors=PLACE)
    known = identifiability(found)
    assert set(found.assumed) == set(PLACE)
    assert set(known.names).isdisjoint(PLACE)
    assert set(found.profiles).isdisjoint(PLACE)
    assert not known.is_blind
    assert not any(word in text for text in known_words(found) for word in ("gravity", "clock"))
    # it is neither an unknown nor a measured number for the choice of a law
    assert found.effective == pytest.approx(3, abs=1e-6)
    assert found.dof == fit(heard(u_s=U_S)).dof


def test_rounding_does_not_move_what_is_assumed():
    found = fit(heard(u_s=U_S), "power", priors=PLACE)
    assert of(found, "gravity_m_s2")[0] == GRAVITY.value
    assert of(found, "clock_skew")[0] == 0.0


def test_what_the_data_know_better_is_found():
    drop = replace(
        exact(8), heights_m=np.array([1.0]), u_heights_m=np.array([1e-5]), height_numbers=(0,)
    )
    found = fit(drop, "constant+drag", priors=PLACE)
    assert "gravity_m_s2" in found.found
    assert of(found, "gravity_m_s2")[1] < 0.1 * GRAVITY.u


def test_a_number_that_is_missing_is_not_made_up_by_what_is_assumed():
    with pytest.raises(InputError, match=r"2 measured numbers and 0 priors cannot give 3 unknowns"):
        fit(exact(2), "constant", priors=PLACE)


def test_each_recorder_has_its_clock():
    assert assumed.of_recorder([heard()]) == {"clock_skew": assumed.QUARTZ}
    assert assumed.of_recorder([filmed()]) == {
        "clock_skew": assumed.FRAMES, "scale": assumed.LENGTHS,
    }  # fmt: skip
    assert "scale" not in assumed.of_recorder([filmed()], ["scale"])


# ---- the budget ---------------------------------------------------------------------------------


def test_the_budget_is_the_covariance():
    drop = heard(IN_AIR, count=9, u_s=U_S)
    choice = model_selection.compare(drop, ["constant+drag"], priors=PLACE)
    rows = {one.name: one for one in budget.budgets(choice, averaged(choice))}
    assert set(rows) == {"restitution", "drop_height_m", "terminal_speed_m_s"}
    for name, one in rows.items():
        assert sum(one.shares.values()) == pytest.approx(1)
        assert one.u == pytest.approx(of(choice.best, name)[1], rel=1e-6)
    assert rows["restitution"].largest == DATA
    height = rows["drop_height_m"]
    by_gravity = GRAVITY.u / GRAVITY.value
    assert height.shares["gravity_m_s2"] == pytest.approx((by_gravity / height.u) ** 2, rel=1e-3)
    by_clock = 2 * assumed.QUARTZ.u
    assert height.shares["clock_skew"] == pytest.approx((by_clock / height.u) ** 2, rel=1e-3)


def test_laws_that_disagree_have_their_share():
    choice = model_selection.compare(heard(IN_AIR, count=6, u_s=1e-4), priors=PLACE)
    (one,) = (row for row in budget.budgets(choice, averaged(choice)) if row.name == "restitution")
    assert one.shares["choice of law"] > 0.1
    assert one.u > choice.best.restitution_at(choice.best.speeds_m_s[1])[1]


# ---- what is printed ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    drop = tmp_path_factory.mktemp("assumed") / "drop.csv"
    times = heard(count=8, u_s=U_S).times_s
    rows = "".join(f"{k},{t:.8f},{U_S}\n" for k, t in enumerate(times, start=1))
    drop.write_text(f"bounce,impact_time_s,u_impact_time_s\n{rows}")
    return drop, simcompare.fit("ball", recordings=[drop], engine="pymunk", unknowns="clock_skew")


def test_a_clock_can_be_sought_where_its_quartz_is_known(told):
    form = told[1].record.fit.closed_form
    row = form.parameters["clock_skew"]
    assert (row.value, row.u) == (pytest.approx(0, abs=1e-8), pytest.approx(50e-6, rel=1e-3))
    assert [fits.how(form, name) for name in ("restitution", "clock_skew", "gravity_m_s2")] == [
        "fitted", "assumed", "assumed",
    ]  # fmt: skip


def test_a_length_scale_still_cannot_be_heard(told):
    with pytest.raises(InputError, match="tell nothing of scale; leave it out, fix it"):
        simcompare.fit("ball", recordings=[told[0]], engine="pymunk", unknowns="scale")


@pytest.mark.parametrize(
    ("option", "given"), [("fixed", {"scale": 1.01}), ("priors", {"scale": (1.0, 0.01)})]
)
def test_a_scale_of_what_was_not_filmed_is_refused(told, option, given):
    with pytest.raises(InputError, match="lengths in a video, and no recording is one"):
        simcompare.fit("ball", recordings=[told[0]], engine="pymunk", **{option: given})


def test_what_dominates_is_told_with_advice_that_can_be_pasted(told):
    drop, found = told
    (text,) = budget_words.words(found.record.fit)
    assert text.startswith(
        "The uncertainty of the drop height is mostly that of the local gravity, which was assumed"
    )
    advice = shlex.split(text.removesuffix(".").partition("such as ")[2])
    assert advice[0] == "--fix"
    name, _, value = advice[1].partition("=")
    again = simcompare.fit("ball", recordings=[drop], engine="pymunk", fixed={name: value})
    form = again.record.fit.closed_form
    assert form.fixed["gravity_m_s2"] == 9.8061
    assert form.parameters["drop_height_m"].u < 0.1 * found.record.fit.closed_form.parameters[
        "drop_height_m"].u  # fmt: skip
    # what is left is the clock's
    (rest,) = budget_words.words(again.record.fit)
    assert "the recorder's clock" in rest


def test_engines_have_the_gravity_of_the_closed_form(told):
    record = told[1].record.fit
    assert record.run_with.closed["gravity_m_s2"] == GRAVITY.value
    assert all("gravity_m_s2" not in source.parameters for source in record.sources)


def test_drag_of_vacuum_is_no_input_of_an_uncertainty():
    file = catalogue.load("ball")
    given = {name: one.value for name, one in file.parameters.items()}
    for coefficient, listed in ((0.0, False), (0.47, True)):
        known = inputs.of_scenario(file, {**given, "drag_coefficient": coefficient}, {}, {})
        assert ("drag_coefficient" in [one.name for one in known]) == listed


AGAINST = "The drag of the settings, a terminal speed of 8.64 ± 0.5 m/s, contradicts the data"


@pytest.mark.parametrize(("speed_m_s", "told"), [(np.inf, 1), (8.64, 0)])
def test_a_drag_of_the_settings_that_the_data_exclude_is_told(tmp_path, speed_m_s, told):
    path = tmp_path / "drop.csv"
    truth = {**TRUTH, "terminal_speed_m_s": speed_m_s}
    flights = np.diff(times_of(truth, 8, "constant+drag"))
    rows = [f"{k},{flight:.6f}" for k, flight in enumerate(flights, start=1)]
    path.write_text("\n".join(["bounce,interval_s", *rows]), encoding="utf-8")
    found = simcompare.fit(
        "ball", recordings=[path], engine="pymunk", set={"drag_coefficient": 0.47}
    )
    assert sum(text.startswith(AGAINST) for text in found.record.fit.sentences) == told
