"""How the leading measure changes with the step: lines of the answer, and the picture."""

import math
from dataclasses import replace

import pytest

from simcompare.reports.run import answer, remarks
from simcompare.reports.run.by_step import figure
from simcompare.reports.run.lead import lead_of
from simcompare.reports.run.lead_table import lead_table
from simcompare.reports.run.short import MAX_WORDS, short
from simcompare.reports.sections.headline import headline
from tests import records
from tests.records import with_sources
from tests.test_headline import ANSWER, changed, level, tuning
from tests.test_reports import TOLERANCES, make_run

WIDE = {"restitution": {"relative": 0.05, "absolute": None, "reason": "Because steps are long."}}


def stepped(mode, tolerances=WIDE, **engines):
    """Engines at 1 and 2 ms; at the longer step less is asked."""
    values = {
        f"{e}@{at}ms": v for e, pair in engines.items() for at, v in zip((1, 2), pair, strict=True)
    }
    steps = [
        {"at": f"@{at}ms", "engine_step_s": 1e-3 * at, "step_s": 0.01, "dither": None,
         "tolerances": own}
        for at, own in ((2, tolerances), (1, TOLERANCES))
    ]  # fmt: skip
    run = make_run(level(mode, **values), answer=ANSWER, steps=steps)
    run = with_sources(
        run, engine=[e for e in engines for _ in (1, 2)], engine_step_s=[1e-3, 2e-3] * len(engines)
    )
    # then the tolerance of a score is that of its step
    return records.changed(run, scores=tuple(replace(s, tolerance=None) for s in run.record.scores))


def test_each_engine_is_a_line_of_its_values_in_the_order_of_the_steps():
    run = stepped("tuned", north=(0.81, 0.81), south=(0.81, 0.81), west=(0.8, 0.85))
    assert answer.sentences(run) == [
        "Tuned, restitution (mean over all events of a repeat) at steps of 1 and 2 ms, where the"
        " closed form gives 0.8 (✗ is off by more than 0.008 and 0.04):",
        "north and south: 0.810 ± 0.001 ✗, 0.810 ± 0.001",
        "west: 0.800 ± 0.001, 0.850 ± 0.001 ✗",
    ]


def test_what_is_the_same_at_every_step_is_told_once_and_what_is_shown_is_not_judged():
    run = stepped("default", TOLERANCES, north=(0.0, 0.0), south=(0.0, 0.5), west=(0.0, 0.0))
    run = changed(run, "south@1ms", value=None, low=0.1, high=0.2)
    run = changed(run, "west@2ms", value=None)
    assert answer.sentences(run) == [
        "By default restitution (mean over all events of a repeat) at steps of 1 and 2 ms, where"
        " the closed form gives 0.8:",
        "north: 0 ± 0.001 at every step",
        "south: 0.100 to 0.200, 0.500 ± 0.001",
        "west: 0 ± 0.001, –",
    ]


def test_the_table_says_which_tolerance_is_whose():
    assert (
        "tolerance 0.008 at 1 ms, 0.04 at 2 ms"
        in lead_table(stepped("tuned", north=(0.8, 0.8))).title
    )
    same = lead_table(stepped("tuned", TOLERANCES, north=(0.8, 0.8))).title
    assert same.endswith("tolerance 0.008")


def many_steps(**levels):
    """One engine at twenty steps, of which the first half has the smaller tolerance."""
    steps = [round(0.1 * k, 1) for k in range(1, 21)]
    rows = [(f"north@{step:g}ms", mode, value) for mode, values in levels.items()
            for step, value in zip(steps, values, strict=True)]  # fmt: skip
    records_of_steps = [
        {"at": f"@{step:g}ms", "engine_step_s": 1e-3 * step, "step_s": 0.01, "dither": None,
         "tolerances": TOLERANCES if step <= 1.0 else WIDE}
        for step in steps
    ]  # fmt: skip
    run = make_run(rows, answer=ANSWER, steps=records_of_steps)
    return records.changed(run, scores=tuple(replace(s, tolerance=None) for s in run.record.scores))


def test_many_steps_are_a_range_and_up_to_which_they_are_right():
    default, wrong = [0.0] * 20, [0.8] * 5 + [0.9] * 15
    run = many_steps(default=default, tuned=wrong)
    (first, second) = short(run)
    assert first.startswith("By default the ball stays on the floor in all 20 cases")
    assert second == (
        "Tuned, the restitution is 0.800 to 0.900, right up to 0.5 ms (closed form 0.8);"
        " but the settling time is unmeasured in all 20."
    )
    run = many_steps(tuned=wrong, assisted=[0.9, *wrong[1:]])
    assert short(run)[1].startswith("Assisted, 0.800 to 0.900, right in 4 of 20")
    assert sum(len(sentence.split()) for sentence in short(run)) <= MAX_WORDS


def test_tolerances_of_many_steps_are_told_once_each():
    title = lead_table(many_steps(tuned=[0.8] * 20)).title
    assert title.endswith("; tolerance 0.008 up to 1 ms, 0.04 above")


def test_the_first_picture_has_a_line_for_each_engine_over_the_step():
    run = stepped("tuned", north=(0.81, 0.81), south=(0.79, 0.85))
    first, *_ = headline(run).figures
    assert first.name == "answer-steps"
    (panel,) = first.panels
    truth, north, south = panel.series
    assert [one.label for one in (north, south)] == ["north", "south"]
    assert list(south.x) == [1.0, 2.0]
    assert list(south.y) == pytest.approx([0.79, 0.85])
    # the tolerance of each step about the truth
    assert list(truth.y) == pytest.approx([0.8, 0.8])
    assert list(truth.u) == pytest.approx([0.008, 0.04])


def test_a_run_with_one_step_has_no_such_picture():
    run = make_run(level("tuned", north=0.8), answer=ANSWER)
    assert figure(run, lead_of(run)) is None


def test_what_is_typed_in_is_told_engine_by_engine():
    run = stepped("tuned", north=(0.8, 0.8), south=(0.8, 0.8))
    numbers = (0.81, 0.82, 0.71, 0.72)
    run = with_sources(run, tuning=[tuning([number], math.nan, math.nan) for number in numbers])
    assert (
        "Typed in for a restitution of 0.8 at 1ms and 2ms: 0.81, 0.82 in north;"
        " 0.71, 0.72 in south." in remarks.remarks(run)
    )
