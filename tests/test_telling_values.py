"""Events and single values of a validation in plain words."""

import pytest

from simcompare.inference.plan import ClockPlan
from simcompare.reports.validation import answer
from simcompare.results.records.validation import HELD_OUT, KNOWN, SAME
from tests.validations import gap, record, segment, text, timing, value


def test_a_value_without_uncertainty_is_not_judged():
    found = record(values=[value(None)])
    assert "No single value is judged: a part of its uncertainty is not known." in answer.sentences(
        found
    )
    assert answer.verdict(value(None), KNOWN) == "not judged: u unknown"


def test_a_recording_that_shows_no_single_value():
    assert "No single value of the scenario can be read off this recording." in (
        answer.sentences(record(values=[]))
    )


@pytest.mark.parametrize(
    ("e_n", "basis", "words"),
    [
        (0.9, KNOWN, "within the uncertainty"),
        (-0.9, HELD_OUT, "within the uncertainty"),
        (0.9, SAME, "within the uncertainty (same data)"),
        (1.1, SAME, "beyond the uncertainty"),
        (-1.1, KNOWN, "beyond the uncertainty"),
    ],
)
def test_the_words_for_a_value(e_n, basis, words):
    assert answer.verdict(value(e_n), basis) == words


def test_the_furthest_value_is_named():
    far = value(-4.44, stream="vad.1", measure="log_decrement")
    found = record(
        values=[value(0.2, stream="vad.0"), far], cases=[segment("vad.0"), segment("vad.1")]
    )
    assert "1 of 2 values agrees within the uncertainty (|E_n| ≤ 1)." in text(found)
    assert "The furthest is the log decrement in north on vad.1: E_n = −4.4." in text(found)


def test_a_measured_value_counts_once_for_all_engines():
    rows = [value(0.2, source=name) for name in ("north", "south", "west")]
    assert "The mean period agrees within the uncertainty (|E_n| ≤ 1) in all 3 engines." in (
        text(record(values=rows))
    )
    assert "(|E_n| ≤ 1) in both engines." in text(record(values=rows[:2]))
    rows += [value(3.0, source=name, measure="loss") for name in ("north", "south", "west")]
    found = text(record(values=rows))
    assert "1 of 2 values agrees within the uncertainty (|E_n| ≤ 1) in all 3 engines." in found
    assert "The furthest is the loss in all 3 engines: E_n = +3.0." in found


def test_engines_that_differ_are_named():
    rows = [value(0.2), value(1.5, source="south"), value(0.2, source="west")]
    found = text(record(values=rows))
    assert "The mean period agrees within the uncertainty (|E_n| ≤ 1) in 2 of 3 engines." in found
    assert "Beyond it, where others agree: south in mean period." in found


def test_the_parameter_that_matters_most_is_named():
    budget = {
        "length_m": 0.3,
        "damping_N_m_s_rad (fitted)": 0.8,
        "damping_N_m_s_rad (fitted)'": 0.2,
    }
    found = record(values=[value(budget=budget)], gaps=[gap(covered=1.0)])
    assert "comes from the parameters (81 % of u²), above all from the damping (88 %)." in text(
        found
    )
    assert "Next: measure the damping better; its uncertainty hides" in text(found)


def test_no_parameter_is_named_where_none_stands_out():
    budget = dict.fromkeys(("length_m", "mass_kg", "friction", "gravity_m_s2"), 0.1)
    assert "above all" not in text(record(values=[value(budget=budget)]))


@pytest.mark.parametrize(("u_num", "is_told"), [(0.3, True), (0.01, False)])
def test_the_value_in_which_the_step_matters_most_is_named(u_num, is_told):
    rows = [value(u_num=0.001), value(u_num=u_num, measure="loss")]
    told = "The step matters most in the loss of north: 30 % of its uncertainty."
    assert (told in text(record(values=rows))) == is_told


def test_events_alone_are_an_answer():
    rows = [timing(e_n=(0.5, 3.0, None))]
    found = text(record(waveforms=[], gaps=[], values=[], timings=rows))
    assert (
        "Impact times: in north 5 of 6 measured events, 2 ms apart (root mean square).\n"
        "1 of 2 intervals agrees within the uncertainty" in found
    )
    assert "Fewer than half" not in found


def test_events_are_never_summed_over_engines():
    rows = [timing(), timing(source="south", rmse_s=0.004), timing(source="west", matched=4)]
    found = text(record(timings=rows))
    assert "in north and south 5 of 6 measured events" in found
    assert "2 ms to 4 ms apart" in found
    assert "in west 4 of 5 measured events, 2 ms apart" in found
    rows[-1] = timing(source="west")
    assert "in all 3 engines 5 of 6 measured events" in text(record(timings=rows))


def test_events_that_do_not_belong_together_are_told_first():
    found = record(timings=[timing(matched=2, missed=20), timing(source="south")])
    told = [one for one in answer.sentences(found) if "events" in one]
    assert told[0].startswith("Fewer than half of the events have a partner")
    nothing = timing(matched=0, missed=20, extra=3, rmse_s=None)
    assert "in north 0 of 20 measured events, and 3 that were not measured." in (
        text(record(timings=[nothing]))
    )


def test_clocks_aligned_by_the_very_events_are_told():
    told = "The clocks were aligned by these very events"
    assert told in text(record(timings=[timing()], align=ClockPlan(by="events")))
    assert told not in text(record(timings=[timing()], align=ClockPlan()))


def test_a_value_just_outside_does_not_look_like_one_just_inside():
    rows = [value(-1.04), value(1.02, measure="loss")]
    assert "None of 2 values agrees" in text(record(values=rows))
    assert "E_n = −1.04" in text(record(values=rows))
