"""Words of fits and validations: one thing, several things, and ranges with equal ends."""

import re
from dataclasses import replace
from types import SimpleNamespace

import pytest

from simcompare.fitting.bounces.bounce_models import MODELS
from simcompare.reports.fit import (
    answer,
    engine_words,
    fits,
    form_words,
    identifiability_words,
    short,
)
from simcompare.reports.fit.measured_figures import reason_of
from simcompare.reports.validation import phrases
from simcompare.results.records.fit_bounces import Drop, Rejected, Valid
from simcompare.results.records.fit_engines import OneRestitution, Target
from simcompare.results.records.fit_forms import AtSpeed, Candidate, Choice, Form, Unknown
from simcompare.results.records.fit_parts import Value
from simcompare.statistics.identifiability import Direction, Identifiability


@pytest.mark.parametrize(
    ("low", "high", "words"), [("0.61", "0.61", "0.61"), ("0.60", "0.61", "0.60 to 0.61")]
)
def test_a_range_with_equal_ends_is_one_number(low, high, words):
    assert phrases.ends(low, high) == words


def test_one_thing_and_several():
    assert phrases.counted(1, "impact") == "1 impact"
    assert phrases.counted(0, "impact") == "0 impacts"
    assert phrases.counted(2, "toss", "tosses") == "2 tosses"


@pytest.mark.parametrize(
    ("names", "every", "words"),
    [
        (["north"], ["north"], "north"),
        (["north", "south"], ["north", "south"], "both engines"),
        (["a", "b", "c"], ["a", "b", "c"], "all 3 engines"),
        (["a", "b"], ["a", "b", "c"], "a and b"),
    ],
)
def test_engines_are_named_or_told_as_all(names, every, words):
    assert phrases.whose(names, every) == words


@pytest.mark.parametrize(
    ("value", "unit", "words"),
    [
        (0.02, "rad", "1.15°"), (0.5, "rad/s", "28.6°/s"), (0.0034, "m", "3.4 mm"),
        (2e-6, "s", "2 µs"), (0.25, "s", "250 ms"), (3.0, "m", "3 m"), (0.0, "m", "0 m"),
        (0.02, "N*m", "20 mN·m"), (0.3, "1", "0.3"),
    ],
)  # fmt: skip
def test_sizes_are_told_in_units_of_people(value, unit, words):
    assert phrases.human(value, unit) == words


def unknown(value, low, high, **more):
    return Unknown(value=value, u=0.01, low=low, high=high, interval="normal", **more)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (unknown(0.774, 0.771, 0.777), "0.7740 ± 0.0030"),
        (unknown(0.774, 0.76, 0.81), "0.774 (0.760 to 0.810)"),
        (unknown(9.0, 7.0, None), "above 7"),
        (unknown(None, 7.0, None), "not finite"),
    ],
)
def test_a_value_has_its_95_percent(row, words):
    assert fits.with_95(row) == words


@pytest.mark.parametrize(
    ("words", "value", "note"),
    [
        ("0.7740 ± 0.0030", "0.7740 m", "± 0.0030 (95 %)"),
        ("(1.50 ± 0.43)·10⁻⁴", "1.50·10⁻⁴ m", "± 0.43·10⁻⁴ (95 %)"),
        ("0.774 (0.760 to 0.810)", "0.774 m", "0.760 to 0.810 (95 %)"),
        ("above 7", "above 7 m", "95 %"),
    ],
)
def test_a_number_at_the_top_has_its_interval_below_it(words, value, note):
    found = short.key_number("height", words, "m")
    assert (found.value, found.note) == (value, note)


def candidate(text, delta, e=0.61, **more):
    known = {"law": "constant", "drag": False, "unknowns": 3.0, "chi2": 1.0,
             "bic": 6.0 + delta}  # fmt: skip
    return Candidate(model=text, text=text, aic=6.0 + delta, delta=delta, weight=0.5,
                     parameters={"restitution": Value(e, 0.01)}, **(known | more))  # fmt: skip


def form(**more):
    known = {
        "model": "constant", "text": "constant", "parameters": {}, "covariance": (),
        "correlation": (), "fixed": {}, "priors": {}, "pulls": {}, "chi2": 1.0, "dof": 3,
        "s2": 1.0, "count": 7, "effective_unknowns": 3.0, "rms": {}, "at_bound": (),
        "restitution": (AtSpeed(0.2, 0.61, 0.01), AtSpeed(3.0, 0.61, 0.01)),
    }  # fmt: skip
    return Form(**(known | more))


def choice(*candidates):
    return Choice(chosen="a", scatter=1.0, refused={}, candidates=candidates)


def test_one_model_without_rivals_is_called_the_best():
    far = candidate("falling", 12.0, law="power")
    assert form_words.choice(choice(candidate("plain", 0.0), far), form())[:1] == (
        "best model: plain (AIC 6.0, weight 50%)",
    )


def test_a_tie_of_models_is_called_a_tie():
    best, rival = candidate("plain", 0.0), candidate("falling", 2.0, law="power")
    assert form_words.choice(choice(best, rival), form()) == (
        "a tie: these fit about as well, and results are averaged by their weights: plain (50%);"
        " falling (50%)",
    )


def chosen(**more):
    return form(parameters={"restitution": unknown(0.61, 0.608, 0.612)}, **more)


@pytest.mark.parametrize(
    ("rival", "fixed", "words"),
    [
        (candidate("power", 2.0, law="power"), {}, None),
        (candidate("drag", 2.0, drag=True), {"terminal_speed_m_s": 9.0}, None),
        (candidate("drag", 2.0, drag=True), {}, "tell whether the air slows the ball"),
        (candidate("both", 2.0, law="power", drag=True), {},
         "tell air drag from a restitution that depends on speed"),
    ],
)  # fmt: skip
def test_drag_that_is_not_told_from_the_rest_has_a_cure(rival, fixed, words):
    told = form_words.cure(choice(candidate("plain", 0.0), rival), chosen(fixed=fixed))
    assert told == (() if words is None else (
        f"the data cannot {words}: give the terminal speed of your ball, such as"
        " --fix terminal_speed=9m/s",
    ))  # fmt: skip


@pytest.mark.parametrize("model", MODELS.values())
def test_a_model_does_not_say_that_the_restitution_falls_with_the_speed(model):
    # the exponent that is found may have either sign
    assert not re.search("falling|rising", model.text)


def test_a_model_that_does_not_fit_is_told_with_its_error():
    simple = replace(candidate("constant", 53.0, 0.6), model="constant")
    told = form_words.choice(choice(candidate("drag", 0.0, drag=True), simple), form())
    assert told[-1] == (
        "a constant restitution without drag does not fit; it would give 0.6000, 1.6 % too low"
    )


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"u_known": False}, "the recording states no uncertainty"),
        ({"dof": 0}, "as many unknowns as measured numbers"),
        ({"scattered": True, "s2": 4.0}, "the data scatter 2.0 times as much as stated"),
        ({"parameters": {"exponent": unknown(0.1, None, None, open_low=True, open_high=True)}},
         "the data do not tell the exponent"),
        ({"parameters": {"exponent": unknown(0.1, None, 0.2, open_low=True)}},
         "the data give no lower limit of the exponent"),
    ],
)  # fmt: skip
def test_what_a_reader_must_know_of_a_form(more, words):
    assert any(words in text for text in form_words.warnings(form(**more)))


def drop(dropped=(), missed=()):
    return Drop("sound", "a.wav", (1, 2), (0.1, 0.2), (None, None), (), (), (), 0, dropped, missed,
                ())  # fmt: skip


def test_what_was_left_out_of_a_drop():
    one = Rejected("sample", 3, 0.1, "not released yet")
    assert answer.dropped(drop((one,))) == ["sample 3 at 0.1000 s was left out: not released yet"]
    two = (one, replace(one, number=4, time_s=0.2))
    assert answer.dropped(drop(two)) == [
        "2 samples from 0.1000 to 0.2000 s were left out: not released yet"
    ]
    assert answer.dropped(drop(missed=(4,))) == ["impact 4 was not recorded"]
    assert answer.dropped(drop(missed=(4, 6))) == ["impacts 4 and 6 were not recorded"]


def test_reasons_that_differ_in_their_numbers_alone_have_one_mark():
    assert reason_of("12 mm off its flight") == reason_of("−7 mm off its flight")
    assert reason_of("within a flight, 9.0 ms after impact 1 (3%)") == "within a flight"


def known(correlation, weak=0.0):
    """What drops tell of restitution and drop height; ``weak``: singular value of the second."""
    moves = {"restitution": 0.01, "drop_height_m": -0.2}
    rows = (Direction(1.0, {}, False), Direction(weak or 0.5, moves, bool(weak)))
    return Identifiability(
        names=("restitution", "drop_height_m"), singular_values=(1.0, weak or 0.5),
        condition=1 / (weak or 0.5), u_data=(0.1, 0.1), u=(0.1, 0.1),
        correlation=((1.0, correlation), (correlation, 1.0)), directions=rows,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (known(0.3), ("the data determine all unknowns",)),
        (
            known(-0.958),
            (
                "the data determine all unknowns",
                "these go together, with their correlation: restitution and drop height (−0.96);"
                " quote both",
            ),
        ),
        (
            known(0.3, 1e-3),
            (
                "drop height and restitution are not separated by the sound: give one of them with"
                " --fix or --prior",
                "the noise hides this change: restitution +0.01, drop height −0.2 m",
            ),
        ),
        (
            known(0.3, 1e-9),
            (
                "the data do not tell restitution and drop height apart",
                "drop height and restitution are not separated by the sound: give one of them with"
                " --fix or --prior",
            ),
        ),
    ],
)
def test_what_the_data_tell(found, words):
    assert identifiability_words.of_bounces(found, {}, "sound") == words


@pytest.mark.parametrize(
    ("speed", "slope", "told"),
    [
        # neither is certain
        (unknown(9.5, 7.0, None), unknown(0.02, -0.01, 0.05), True),
        # the air is seen, or a slope is: the data have separated the two
        (unknown(9.508, 9.43, 9.59), unknown(0.02, -0.01, 0.05), False),
        (unknown(9.5, 7.0, None), unknown(0.02, 0.01, 0.03), False),
    ],
)
def test_drag_and_slope_are_told_as_one_only_where_neither_is_certain(speed, slope, told):
    moves = {"terminal_speed_m_s": 1.0, "exponent": 0.01}
    found = Identifiability(
        names=tuple(moves), singular_values=(1.0, 1e-3), condition=1e3, u_data=(0.1, 0.1),
        u=(0.1, 0.1), correlation=((1.0, 0.3), (0.3, 1.0)),
        directions=(Direction(1.0, {}, False), Direction(1e-3, moves, True)),
    )  # fmt: skip
    parameters = {"terminal_speed_m_s": speed, "exponent": slope}
    words = " ".join(identifiability_words.of_bounces(found, {}, "stopwatch", parameters))
    assert ("drag and a restitution that depends on speed are not separated by the impact times"
            in words) == told  # fmt: skip
    assert "sound" not in words


def test_a_slope_that_every_rival_has_leaves_only_the_air_open():
    best, rival = candidate("a", 0.0, law="power"), candidate("b", 2.0, law="linear", drag=True)
    (told,) = form_words.cure(choice(best, rival), chosen())
    assert told.startswith("the data cannot tell whether the air slows the ball")


@pytest.mark.parametrize(
    ("law", "slope", "words"),
    [
        ("power", unknown(0.03, 0.01, 0.05), "depends on the speed: "),
        ("linear", unknown(0.0, -0.02, 0.02), "is "),
        # a law without an exponent: the ends differ by 0.02 ± 0.014
        ("hunt_crossley", None, "is "),
    ],
)
def test_a_dependence_on_the_speed_is_told_only_where_it_is_seen(law, slope, words):
    ends = (AtSpeed(0.5, 0.80, 0.01, 0.78, 0.82), AtSpeed(4.0, 0.78, 0.01, 0.76, 0.80))
    rows = {"restitution": unknown(0.78, 0.76, 0.80)} | ({"exponent": slope} if slope else {})
    record = SimpleNamespace(
        closed_form=form(model="m", parameters=rows, restitution=ends),
        choice=choice(replace(candidate("m", 0.0, law=law), weight=1.0)),
    )
    record.one_number, record.is_tuned = OneRestitution(0.79, 0.01, 0.01, 0.02), True
    # what engines lack is told only where the ball has it
    assert bool(engine_words.one_number(record)) == (words != "is ")
    told = fits.restitution_words(record)
    assert told.startswith(f"The restitution {words}0.800 ± 0.020 at 0.5 m/s")
    assert told.endswith("; no dependence on the speed is seen.") == (words == "is ")


def averaged_record(disagree, **more):
    height = unknown(0.856, 0.75, 0.92)
    rows = {
        "restitution": replace(unknown(0.78, 0.76, 0.80), interval="averaged"),
        "drop_height_m": replace(height, interval="averaged"),
    }
    known = {
        "closed_form": form(model="a", parameters=rows),
        "choice": replace(choice(candidate("a", 0.0), candidate("b", 1.0)), disagree=disagree),
        "sources": (SimpleNamespace(name="north", status="ok"),),
        "tuned_to": Target(0.78, 0.01, 4.1), "valid": Valid((0.5, 4.1), 1e-3, 1e-3),
    }  # fmt: skip
    return SimpleNamespace(**(known | more))


def test_where_models_disagree_every_number_that_they_share_is_a_range():
    row = averaged_record(True).closed_form.parameters["drop_height_m"]
    assert fits.told_95(averaged_record(True), row, "drop_height_m") == "0.75 to 0.92 m"
    assert fits.told_95(averaged_record(False), row, "drop_height_m").startswith("0.86 m (")
    # and the numbers that are typed in belong to one value between the models
    _, engines = short._of_bounces(averaged_record(True))
    assert engines.startswith("With the numbers below, north bounces with 0.78, the models' mean,")


def test_engines_are_not_said_to_bounce_as_a_ball_for_which_none_can_be_tuned():
    _, engines = short._of_bounces(averaged_record(False, tuned_to=Target(0.995, 1e-4, 4.1)))
    assert engines == (
        "Engines are tuned up to 0.99; this ball has 0.995 at the first impact, so none bounces as"
        " it does."
    )
