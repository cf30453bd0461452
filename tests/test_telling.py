"""The answer of a validation in plain words."""

from dataclasses import replace

import pytest

from simcompare.alignment.clock_line import Alignment
from simcompare.model.recording import Repair
from simcompare.reports.validation import answer
from simcompare.results.records.validation import HELD_OUT, SAME, SpreadRecord
from tests.validations import (
    LOG,
    compared,
    fit,
    gap,
    held_out,
    parameter,
    record,
    segment,
    text,
    value,
    waveform,
)


def test_parameters_that_were_known_before():
    assert answer.sentences(record()) == [
        "With the parameters known before, the simulated angle from hanging is 2 % of the measured"
        " range off (root mean square). The largest: north, 0.02 rad, and 0.04 rad at one instant.",
        "Of the gap of the angle from hanging, 90 % of the mean square is neither noise nor"
        " numerical error. Nothing was fitted, so it may come from the parameters as well as from"
        " the form of the model.",
        "The one single value (1 quantity on 1 segment) agrees within the noise level (|E_n| ≤ 1,"
        " k = 2); that shows no fault, and proves no model. 81 % of the squared uncertainty comes"
        " from the parameters. Numerical error weighs most in the mean period of north: u = 0.1 s"
        " of 1 s.",
        "All parameters were known before the measurement was looked at.",
        "Next: fit the parameters to one part of the recordings and judge another (calibrate:), to"
        " tell wrong parameters from a wrong model.",
    ]


def test_parameters_that_were_fitted_elsewhere():
    assert answer.sentences(held_out()) == [
        "With fitted parameters, the simulated angle from hanging is 1 % of the measured range off"
        " (root mean square); before the fit it was 4 % of the measured range. The largest: north,"
        " 0.01 rad, and 0.02 rad at one instant.",
        "Before the fit, the gap of the angle from hanging was made of (shares of its mean square):"
        " parameters 75 %; model form 20 %; noise of the measurement 5 %.",
        "The one single value (1 quantity on 1 segment) agrees within the noise level (|E_n| ≤ 1,"
        " k = 2); that shows no fault, and proves no model. 81 % of the squared uncertainty comes"
        " from the parameters. Numerical error weighs most in the mean period of north: u = 0.1 s"
        " of 1 s.",
        "Length and damping were fitted to id.0 of swings and held against vad.0 of swings, which"
        " the fit had not seen: what is said here is a prediction. It holds for motions like"
        " these, not beyond.",
        "Next: a better model; neither a shorter step nor a quieter sensor would close this gap."
        " What is left over time shows where to look.",
    ]


def test_parameters_that_were_fitted_to_what_is_judged():
    found = record(
        basis=SAME, fit=fit(["log"]), waveforms=[waveform(), waveform("fitted", rmse=0.01)],
        gaps=[gap(0.75, 0.2)],
    )  # fmt: skip
    told = answer.sentences(found)
    assert (
        "Length and damping were fitted to swings, which is also what was judged: this is a fit,"
        " not a validation." in told
    )
    assert told[-1] == "Next: judge segments that were not fitted."
    assert "prediction" not in text(found)
    assert "proves" not in text(found)


def test_no_engine_ran():
    found = record(waveforms=[], gaps=[], values=[])
    assert answer.sentences(found) == ["No engine ran, so nothing can be said."]


@pytest.mark.parametrize("make", [record, held_out])
def test_nothing_is_ever_called_validated(make):
    assert "validated" not in text(make())


def test_parameters_that_do_not_carry_over():
    found = record(
        basis=HELD_OUT, fit=fit(), gaps=[gap(-0.06, 1.05)],
        waveforms=[waveform(), waveform("fitted")],
    )  # fmt: skip
    assert (
        "The fitted parameters made the gap larger, by up to 6 %, so they do not carry over"
        in text(found)
    )
    assert "Model form is what parameters fitted elsewhere leave" in text(found)


def test_uncertain_parameters_take_the_blame_from_the_model():
    blamed = record(fit=fit(), basis=HELD_OUT, gaps=[gap(0.1, 0.8, covered=0.5)],
                    waveforms=[waveform(), waveform("fitted")])  # fmt: skip
    assert "covers 50 % of the samples; the others differ by more than that" in text(blamed)
    assert "it may lie in the equations" in text(blamed)
    assert "Next: a better model" in text(blamed)
    spared = replace(blamed, gaps=[gap(0.1, 0.8, covered=1.0)])
    assert "it may explain the gap without any fault of the model" in text(spared)
    assert "it may lie in the equations" not in text(spared)
    assert "Next: measure the parameters better" in text(spared)


def test_a_better_model_is_not_asked_for_where_a_start_that_was_read_off_dominates():
    found = held_out(values=[value(budget={"start_rad": 0.9})])
    assert "Next: a better model" in text(found)
    found = replace(found, parameters=[*found.parameters, parameter("start_rad", "read off")])
    assert "Next: measure the start better, apart from this recording" in text(found)
    assert "better model" not in text(found)


@pytest.mark.parametrize(
    ("r", "rms", "advice"),
    [
        (-0.9999, 0.05, "fit a recording that tells length and damping apart"),
        (-0.9999, 0.002, "a better model"),
        (0.98, 0.05, "a better model"),
    ],
)
def test_a_better_model_is_not_asked_for_where_parameters_cannot_be_told_apart(r, rms, advice):
    found = held_out(fit=fit(rms=rms, r=r), cases=[segment("vad.0", u=0.001)])
    assert f"Next: {advice}" in text(found)
    told = "The fit cannot tell apart (correlation): length and damping (−0.9999)."
    assert (told in text(found)) == (r < 0)


@pytest.mark.parametrize(
    ("numerical", "words"),
    [
        (0.002, "is at most 5 % of that."),
        (0.02, "is up to 50 % of that: a shorter step comes first."),
    ],
)
def test_the_engines_own_error_is_told_beside_the_gap(numerical, words):
    rows = [gap(0.0, 0.9, name, numerical=numerical) for name in ("north", "south")]
    found = record(gaps=rows, waveforms=[waveform(), waveform(source="south")])
    assert f"The numerical error of each engine {words}" in text(found)
    assert "Its numerical error" in text(replace(found, gaps=rows[:1]))
    assert "numerical error of" not in text(record(gaps=[gap(numerical=0.0)]))


def test_the_engines_agreement_is_told_from_their_spread_alone():
    rows = [waveform(), waveform(source="south")]
    found = record(waveforms=rows)
    assert "each other" not in text(found)
    spread = SpreadRecord("log", "angle_rad", ("north", "south"), 0.001)
    assert (
        "The engines' spread about their own mean is 5 % of that: they agree far better with each"
        " other than with reality." in text(replace(found, spread=[spread]))
    )
    wide = text(replace(found, spread=[replace(spread, rms=0.01)]))
    assert "about their own mean is 50 % of that." in wide
    assert "each other" not in wide
    assert "same numbers" in text(replace(found, spread=[replace(spread, rms=0.0)]))


@pytest.mark.parametrize(
    ("row", "advice"),
    [
        (gap(0.0, 0.1), "a quieter sensor or a longer record"),
        (gap(0.0, 0.1, numerical=0.05), "a shorter step"),
    ],
)
def test_the_largest_part_of_what_is_left_is_what_to_do_next(row, advice):
    assert f"Next: {advice}" in text(record(gaps=[row]))


def test_a_fit_that_ended_at_a_bound_is_told():
    found = held_out(fit=fit(at_bound=["length_m"]))
    assert "Next: ask why the fit pushed the length to its bound" in text(found)


def test_both_scores_are_told_where_clocks_were_aligned():
    rows = [waveform(aligned=True, rmse=0.01), waveform(rmse=0.05)]
    assert (
        "is 1 % of the measured range off (root mean square); with the clocks as recorded it would"
        " be 5 % of the measured range" in text(record(waveforms=rows))
    )


def test_every_judged_quantity_has_its_own_sentence():
    other = waveform(probe="rate", rmse=0.3)
    compare = {"angle_rad": compared("Angle"), "rate": compared("DC voltage")}
    found = text(record(waveforms=[waveform(), other], compare=compare))
    assert "the simulated angle is 2 %" in found
    assert "the simulated DC voltage is 30 %" in found


def test_a_measurement_that_does_not_vary_has_no_range():
    assert "is 0.02 rad off" in text(record(waveforms=[waveform(nrmse=None)]))


def test_defects_of_the_log_are_told():
    repairs = (
        Repair("counter_wrap", "repair", ""),
        Repair("time_gaps", "warning", ""),
        Repair("harmless", "info", ""),
    )
    found = text(record(provenance=replace(LOG, repairs=repairs)))
    assert "(repaired: counter wrap; left and marked: time gaps)" in found
    assert "harmless" not in found


def test_an_ambiguous_alignment_is_told_first():
    sure = Alignment(0.0, 0.0, 0.0, 0.0, "events")
    unsure = replace(sure, ambiguous=True)
    found = record(alignments=[unsure])
    assert answer.sentences(found)[0].startswith("The clocks are not aligned with certainty:")
    assert "with certainty" not in text(record(alignments=[sure]))
    assert "with certainty" not in text(record(alignments=[None]))
    two = record(cases=[segment("a"), segment("b")], alignments=[None, unsure])
    assert "with certainty (b):" in text(two)


def test_a_window_that_was_cut_is_told():
    short = segment("b", short=True, duration_s=4.25)
    assert "The log ends before the window that was asked for: only 4.25 s are judged." in (
        text(record(cases=[short]))
    )
    assert "only 4.25 s of b are judged" in text(record(cases=[segment("a"), short]))
    assert "asked for" not in text(record())


def test_what_was_read_off_the_recording_is_not_called_known():
    rows = [("start_rad", "read off"), ("length_m", "known"), ("mass_kg", "scenario"),
            ("duration_s", "scenario"), ("damping_N_m_s_rad", "given")]  # fmt: skip
    found = record(parameters=[parameter(*row) for row in rows])
    assert (
        "The start was read off the recording that is judged, at the start of it. The damping was"
        " given by the user. The length was known before the measurement was looked at. One"
        " more parameter is the scenario's own, with no uncertainty." in text(found)
    )
    assert "All parameters" not in text(found)


def test_a_fit_chosen_with_the_judged_pieces_in_sight_is_no_prediction():
    found = held_out(fit=fit(chosen_knowing=True))
    assert "chosen knowing the judged ones, so this is weaker than a prediction" in text(found)
    assert "is a prediction" not in text(found)


def test_a_signal_of_nothing_but_noise_has_no_share_of_its_range():
    cases = [segment(u=0.01)]
    still = waveform(rmse=0.02, nrmse=0.3, n=500)
    assert "is 0.02 rad off" in text(record(waveforms=[still], cases=cases))
    moving = waveform(rmse=0.02, nrmse=0.02, n=500)
    assert "is 2 % of the measured range off" in text(record(waveforms=[moving], cases=cases))


def test_engines_that_are_equally_far_off_are_told_as_all():
    rows = [waveform(), waveform(source="south"), waveform(source="west")]
    assert "The largest: all 3 engines, 0.02 rad" in text(record(waveforms=rows))
    assert "The largest: south, 0.03 rad" in (
        text(record(waveforms=[*rows, waveform(source="south", rmse=0.03)]))
    )


def test_many_quantities_are_told_in_one_sentence():
    probes = {"a": "Rate a", "b": "Rate b", "c": "Rate c"}
    found = record(
        compare={probe: compared(label) for probe, label in probes.items()},
        waveforms=[waveform(probe=p, rmse=0.01 * i) for i, p in enumerate(probes, start=1)],
        gaps=[gap(model_form=0.1 * i, probe=p) for i, p in enumerate(probes, start=1)],
    )
    told = answer.sentences(found)
    assert told[0] == (
        "With the parameters known before, the simulated signals are off by (root mean square, in"
        " shares of the measured range): rate a 1 %; rate b 2 %; rate c 3 %."
    )
    assert told[1].startswith(
        "Of the mean square of each gap this is neither noise nor numerical error: rate a 10 %;"
        " rate b 20 %; rate c 30 %. Nothing was fitted"
    )


def test_a_vanishing_numerical_error_is_told_shortly():
    rows = [gap(0.0, 0.9, name, numerical=1e-6) for name in ("north", "south")]
    assert "of each engine is below 0.05 % of that" in text(record(gaps=rows))
