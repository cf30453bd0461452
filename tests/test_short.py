"""The answer of a run in forty words and four numbers."""

from dataclasses import replace

import pytest

import simcompare
from simcompare.comparison.comparison import FAIL
from simcompare.model.settings import DEFAULT
from simcompare.reports.run import answer, runs
from simcompare.reports.run.key_numbers import key_numbers
from simcompare.reports.run.lead import lead_of
from simcompare.reports.run.short import MAX_WORDS, short
from tests import records
from tests.records import with_sources
from tests.test_headline import ANSWER, answered, changed, level
from tests.test_reports import audit_row, make_run

CAUSE = "no restitution is set"
WHOLE = {**ANSWER, "within": "the ball bounces with {value} for {settling_time}"}


def words(sentences):
    return sum(len(sentence.split()) for sentence in sentences)


def met(run):
    """The same run, in which the second tolerance is met by all."""
    scores = [replace(s, value=4.0, verdict="pass") if s.measure == "settling_time" else s
              for s in run.record.scores]  # fmt: skip
    return records.changed(run, scores=tuple(scores))


def all_levels(**more):
    return met(
        answered(
            [
                *level("default", north=0.0, south=0.0, west=0.0),
                *level("tuned", north=0.81, south=0.82, west=0.8),
                *level("assisted", north=0.8, south=0.8, west=0.801),
            ],
            answer=WHOLE,
            **more,
        )
    )


def test_each_level_is_a_sentence():
    run = all_levels()
    held = audit_row(DEFAULT)
    given = replace(held, set_value=0.8, read_value=0.8)
    run = with_sources(run, audit=[(held,)] * 3 + [(given,)] * 6)
    assert short(run) == (
        "By default the ball stays on the floor in all 3 engines: no restitution is set.",
        "Tuned, the ball bounces with 0.810 to 0.820 instead of 0.8 in 2 of 3.",
        "Assisted, 0.800 to 0.801 in all 3.",
    )


@pytest.mark.parametrize(("set_value", "end"), [(0.8, " (tuned sets it)."), (None, ".")])
def test_what_cures_a_cause_is_said_only_where_it_does(set_value, end):
    run = met(answered([*level("default", north=0.0), *level("tuned", north=0.8)]))
    held = audit_row(DEFAULT)
    given = replace(held, set_value=set_value, read_value=set_value or 0.0)
    run = with_sources(run, audit=[(held,), (given,)])
    assert short(run)[0] == f"By default the ball stays on the floor in north: {CAUSE}{end}"


def test_what_is_wrong_alike_where_all_is_set_had_another_cause():
    run = met(answered([*level("default", north=0.7), *level("tuned", north=0.701)]))
    given = replace(audit_row(DEFAULT), set_value=0.8, read_value=0.8)
    run = with_sources(run, audit=[(audit_row(DEFAULT),), (given,)])
    assert CAUSE not in short(run)[0]


def test_what_happens_alike_at_two_levels_is_one_sentence():
    run = met(answered([*level("tuned", north=0.8), *level("assisted", north=0.8)], answer=WHOLE))
    assert short(run) == ("Tuned and assisted, the ball bounces with 0.800 for 4.0 s in north.",)


def test_a_half_sentence_is_said_once():
    rows = [*level("tuned", a=0.8, b=0.801, c=0.9), *level("assisted", a=0.8, b=0.8, c=0.8)]
    template = {**ANSWER, "within": "the ball bounces ({value})"}
    first, second = short(met(answered(rows, answer=template)))
    assert "the ball bounces (0.800 to 0.801)" in first
    assert second == "Assisted, 0.800 in all 3."


def test_where_all_is_right_a_half_sentence_without_a_value_tells_none():
    told = {**ANSWER, "within": "the ball bounces as it should", "outside": "it bounces {value}"}
    run = met(
        answered(
            [*level("default", north=0.8, south=0.8), *level("tuned", north=0.8, south=0.3),
             *level("assisted", north=0.8, south=0.8)],
            answer=told,
        )
    )  # fmt: skip
    text = " ".join(short(run))
    assert text.count("the ball bounces as it should in") == 3
    assert "0.8" not in text


def test_engines_that_are_off_are_named_with_what_they_have():
    run = met(answered(level("tuned", a=0.8, b=0.8, c=0.801, d=0.9)))
    assert short(run) == (
        "Tuned, the ball bounces with 0.800 to 0.801 in 3 of 4 engines; off in d (0.900).",
    )


def test_other_measures_that_fail_are_said_where_the_leading_one_passes():
    run = answered(level("assisted", north=0.8, south=0.8))
    (sentence,) = short(run)
    assert sentence.endswith(
        "in north and south; but the settling time is unmeasured in north and south."
    )


def test_repeats_that_differ_are_told_by_their_ends():
    run = changed(answered(level("default", a=0.0, b=0.0, c=0.0)), "c", value=None, low=0.0,
                  high=0.17)  # fmt: skip
    assert "varying in c (0 to 0.170)" in short(run)[0]


def test_what_most_engines_lack_is_said():
    run = changed(met(answered(level("tuned", a=0.8, b=0.8))), "b", value=None, low=None, high=None)
    assert short(run)[0].endswith("not measurable in b.")


def test_an_error_is_told_by_its_largest():
    tolerances = {"restitution": {"relative": None, "absolute": 0.01, "reason": "Because of it."}}
    run = make_run(level("tuned", a=0.002, b=0.004), truth=0.0, tolerances=tolerances)
    assert short(run) == ("Tuned, the restitution is at most 0.004 in a and b.",)
    run = make_run(level("tuned", a=1e-12, b=2e-13), truth=0.0, tolerances=tolerances)
    assert short(run) == ("Tuned, the restitution is 0 in a and b.",)


def test_nothing_measured_says_so():
    assert short(answered(level("default", north=None))) == ("Nothing was measured.",)
    assert key_numbers(answered(level("default", north=None))) == ()


@pytest.mark.parametrize("engines", [1, 3, 14])
def test_it_is_never_longer_than_forty_words(engines):
    names = [f"engine{i}" for i in range(engines)]
    modes = ("default", "coefficients", "tuned", "assisted")
    rows = [(name, mode, 0.1 * (i + k)) for k, mode in enumerate(modes)
            for i, name in enumerate(names)]  # fmt: skip
    run = answered(rows, answer=WHOLE)
    assert 0 < words(short(run)) <= MAX_WORDS


def test_key_numbers_are_one_for_each_level_and_the_truth():
    numbers = [(n.label, n.value, n.note, n.verdict) for n in key_numbers(all_levels())]
    assert numbers == [
        ("by default", "0", "the ball stays on the floor in all 3 engines", ""),
        ("tuned", "0.800 to 0.820", "1 of 3 within ±0.008", "fail"),
        ("assisted", "0.800 to 0.801", "3 of 3 within ±0.008", "pass"),
        ("truth", "0.8", "", ""),
    ]


def test_a_key_number_counts_what_else_is_off():
    (number, _) = key_numbers(answered(level("assisted", north=0.8)))
    assert number.note == "1 of 1 within ±0.008; 1 other value is unmeasured"
    assert number.verdict == "fail"


def test_the_value_that_is_farthest_off_is_told_beside_its_truth():
    run = answered(level("assisted", north=0.8, south=0.8))
    times = {"north": 4.2, "south": 5.0}
    run = records.changed(run, scores=tuple(
        replace(s, value=times[s.source], verdict="fail") if s.measure == "settling_time" else s
        for s in run.record.scores
    ))  # fmt: skip
    assert "settling time is off in north and south (5.0 s instead of 4 s)" in short(run)[0]


@pytest.mark.parametrize(
    ("times", "told"),
    [
        ({"a": None, "b": 4.0}, "but the settling time is unmeasured in a"),
        ({"a": None, "b": 5.0}, "but the settling time is off or unmeasured in a and b"),
    ],
)
def test_what_has_no_value_is_not_called_off(times, told):
    run = answered(level("assisted", a=0.8, b=0.8))
    run = records.changed(run, scores=tuple(
        replace(s, value=times[s.source], verdict="pass" if times[s.source] == 4.0 else "fail")
        if s.measure == "settling_time" else s
        for s in run.record.scores
    ))  # fmt: skip
    assert told in short(run)[0]
    assert told.split("time ")[1].split(" in")[0] in key_numbers(run)[0].note


@pytest.mark.engines("box2d", "pymunk")
@pytest.mark.parametrize(
    "scenario", ["accelerometer_force", "motor_bench", "pendulum_servo", "robot_planar"]
)
def test_whatever_fails_is_counted_in_few_words(scenario):
    run = simcompare.run(scenario, engine="box2d,pymunk", judge="tuned")
    assert 0 < words(short(run)) <= MAX_WORDS
    lead, numbers = lead_of(run), {number.label: number for number in key_numbers(run)}
    for mode in ("tuned", "assisted"):
        failed = {s.measure for s in run.record.scores if (s.contact, s.verdict) == (mode, FAIL)}
        others = failed - {lead.measure}
        number = numbers[runs.mode_words(mode)]
        assert (number.verdict == "fail") == bool(failed)
        assert ("other value" in number.note) == bool(others)
        assert not others or f"{len(others)} other value" in number.note


def unmeasured(values, truths):
    """A run in which nothing has the leading measure, which has no truth; the other has these."""
    run = answered([*level("default", **values), *level("tuned", **values)])
    fields = {"restitution": {"value": None, "low": None, "high": None, "truth": None},
              "settling_time": {"truth": truths, "tolerance": 0.1}}  # fmt: skip
    scores = [replace(s, **fields[s.measure]) for s in run.record.scores if s.index is None]
    scores = [replace(s, value=values[s.source], verdict="fail" if s.contact == "tuned" else "info")
              if s.measure == "settling_time" else s for s in scores]  # fmt: skip
    return records.changed(run, scores=tuple(scores))


def test_where_the_leading_measure_has_no_value_the_first_judged_one_leads():
    run = unmeasured({"north": 5.0, "south": 4.8}, 4.0)
    told = (
        "The restitution could not be measured.",
        "By default and tuned, the settling time is 4.8 to 5.0 s instead of 4 s in north and south",
    )
    assert short(run) == (told[0], f"{told[1]}.")
    assert answer.sentences(run)[0] == told[0]
    default, tuned, truth = key_numbers(run)
    assert (default.value, tuned.value, truth.value) == ("4.8 to 5.0 s", "4.8 to 5.0 s", "4 s")
    assert (tuned.note, tuned.verdict) == ("0 of 2 within ±0.1 s", "fail")


def test_a_value_beside_a_wide_tolerance_keeps_two_digits():
    tolerances = {"restitution": {"relative": None, "absolute": 0.0014, "reason": "Because of it."}}
    for value, told in ((0.0003, "0.0003"), (0.012, "0.012"), (0.0047, "0.0047")):
        run = make_run(level("tuned", a=value), truth=value, tolerances=tolerances)
        assert short(run) == (f"Tuned, the restitution is {told} in a.",)


def test_an_error_that_is_too_large_is_told_beside_its_tolerance():
    run = unmeasured({"north": 0.3, "south": 0.8}, 0.0)
    assert "the settling time is 0.30 to 0.80 s (tolerance 0.1 s) in north" in " ".join(short(run))


def test_an_engine_at_several_steps_is_counted_as_several_cases():
    values = {f"{engine}@{at}ms": 0.8 for engine in ("north", "south") for at in (1, 2)}
    run = answered(level("assisted", **values))
    assert "settling time is unmeasured in all 4 cases" in short(run)[0]
    run = met(answered(level("default", **values), truth=None))
    assert key_numbers(run)[0].note == "4 of 4 cases"


def test_a_cause_in_an_engine_at_several_steps_is_counted_as_several_cases():
    values = {"north@1ms": 0.0, "north@2ms": 0.0, "north@4ms": 0.0, "south": 0.5}
    run = answered(level("default", **values))
    held = audit_row(DEFAULT)
    run = with_sources(run, audit=[(held,)] * 3 + [(replace(held, read_value=0.8),)])
    assert f"in 3 cases {CAUSE}" in short(run)[0]


def test_what_else_is_off_is_counted_in_all_engines_in_words_and_numbers_alike():
    run = answered(level("assisted", a=0.8, b=0.8, c=0.8, d=0.9), answer=WHOLE)
    on_time = [replace(s, value=4.0, verdict="pass")
               if s.measure == "settling_time" and s.source != "d" else s
               for s in run.record.scores]  # fmt: skip
    run = records.changed(run, scores=tuple(on_time))
    assert "; but the settling time is unmeasured in d" in short(run)[0]
    assert key_numbers(run)[0].note == "3 of 4 within ±0.008; 1 other value is unmeasured"


def test_what_else_is_off_is_said_where_the_leading_measure_has_no_value():
    run = changed(answered(level("tuned", a=0.8, b=0.8)), "a", value=None, low=None, high=None)
    run = changed(run, "b", value=None, low=None, high=None)
    assert short(run) == (
        "Tuned, the restitution could not be measured in a and b;"
        " but the settling time is unmeasured in a and b.",
    )
