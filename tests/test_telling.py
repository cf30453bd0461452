"""The answer of a validation in plain words."""

import math
from dataclasses import replace

import pytest

from simcompare.alignment.clock_line import Alignment
from simcompare.model.recording import Repair
from simcompare.reports.validation import answer
from simcompare.reports.validation.short import short
from simcompare.results.records.validation import HELD_OUT, KNOWN, SAME, ApartRecord, SpreadRecord
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
        "The simulated angle from hanging is off by 1.15°, 2 % of the measured range (root mean"
        " square).",
        "At one instant it is off by 2.29°, in north.",
        "90 % of the gap of the angle from hanging (mean square) is neither noise nor the step.",
        "Nothing was fitted, so the rest may be wrong parameters or a wrong model.",
        "The mean period agrees within the uncertainty (|E_n| ≤ 1).",
        "That shows no fault; it does not prove the model.",
        "Most of the uncertainty comes from the parameters (81 % of u²).",
        "The step matters most in the mean period of north: 10 % of its uncertainty.",
        "All parameters were known before the measurement.",
        "Next: fit the parameters to one part of the recordings and judge another (calibrate:).",
    ]


def test_parameters_that_were_fitted_elsewhere():
    assert answer.sentences(held_out()) == [
        "The simulated angle from hanging is off by 0.573°, 1 % of the measured range (root mean"
        " square).",
        "Before the fit it was 2.29°.",
        "At one instant it is off by 1.15°, in north.",
        "The gap of the angle from hanging before the fit came from (mean square): the parameters"
        " 75 %, the model 20 %, noise 5 %.",
        "The mean period agrees within the uncertainty (|E_n| ≤ 1).",
        "That shows no fault; it does not prove the model.",
        "Most of the uncertainty comes from the parameters (81 % of u²).",
        "The step matters most in the mean period of north: 10 % of its uncertainty.",
        "Length and damping were fitted to id.0 of swings.",
        "The judged data were not fitted, so this is a prediction.",
        "It holds for motions like these, not beyond.",
        "Next: improve the model; a shorter step or a quieter sensor would not help. What is left"
        " over time shows where to look.",
    ]


def test_parameters_that_were_fitted_to_what_is_judged():
    found = record(
        basis=SAME, fit=fit(["log"]), waveforms=[waveform(), waveform("fitted", rmse=0.01)],
        gaps=[gap(0.75, 0.2)],
    )  # fmt: skip
    told = answer.sentences(found)
    assert "Length and damping were fitted to swings." in told
    assert "The same data were judged: this is a fit, not a validation." in told
    assert told[-1] == "Next: judge segments that were not fitted."
    assert "prediction" not in text(found)
    assert "prove" not in text(found)


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
        "The fitted parameters made the gap up to 3 % larger (root mean square): they do not carry"
        " over." in text(found)
    )
    assert "A share above 100 % is an error that another one hid" in text(found)
    assert "A share above" not in text(held_out())
    assert short(found)[1] == "The fit does not carry over: the gap grew by up to 3 %."
    assert "in parameters that suit only the data they were fitted to." in text(found)


def two_recordings(**more):
    sizes = {"vad.0": 0.00955, "vad.1": 0.0242}
    rows = [waveform(kind, source, stream, rmse * scale)
            for kind in (KNOWN, "fitted") for stream, rmse in sizes.items()
            for source, scale in (("north", 1), ("south", 0.99))]  # fmt: skip
    found = {"mean_period": 0.5, "small_angle_period": 3.0, "loss": 2.0}
    values = [value(e_n, stream, measure=name) for stream in sizes for name, e_n in found.items()]
    cases = [segment(stream) for stream in sizes]
    return held_out(waveforms=rows, values=values, cases=cases, **more)


def test_the_short_answer_names_two_recordings_and_what_the_values_are():
    assert short(two_recordings()) == (
        "The simulated angle from hanging is off by 0.55° (vad.0) and 1.4° (vad.1).",
        "2 of 6 values (mean period, small angle period … of both) agree.",
        "The parameters were fitted to other data.",
    )


def test_the_short_answer_tells_engines_that_differ_by_their_ends():
    rows = [waveform(stream=stream, source=source, rmse=rmse) for stream in ("a", "b")
            for source, rmse in (("north", 0.01), ("south", 0.02))]  # fmt: skip
    told = short(record(waveforms=rows))[0]
    assert told.endswith("0.573° to 1.15° (a) and 0.573° to 1.15° (b).")
    three = [waveform(stream=name, rmse=0.01) for name in "abc"]
    assert short(record(waveforms=three))[0].endswith("by 0.573° (RMS) in 3 recordings.")


def test_the_short_answer_drops_what_is_least_important():
    found = two_recordings(gaps=[gap(-0.3, 1.2)])
    assert short(found)[1:] == (
        "The fit does not carry over: the gap grew by up to 14 %.",
        "2 of 6 values (mean period, small angle period … of both) agree.",
    )
    assert sum(len(sentence.split()) for sentence in short(found)) <= 40


def test_uncertain_parameters_take_the_blame_from_the_model():
    blamed = record(fit=fit(), basis=HELD_OUT, gaps=[gap(0.1, 0.8, covered=0.5)],
                    waveforms=[waveform(), waveform("fitted")])  # fmt: skip
    assert "covers 50 % of the samples: it does not explain the whole gap." in text(blamed)
    assert "may lie in the equations" in text(blamed)
    assert "Next: improve the model" in text(blamed)
    spared = replace(blamed, gaps=[gap(0.1, 0.8, covered=1.0)])
    assert "it may explain the gap." in text(spared)
    assert "may lie in the equations" not in text(spared)
    assert "Next: measure the parameters better" in text(spared)


def test_a_better_model_is_not_asked_for_where_a_start_that_was_read_off_dominates():
    found = held_out(values=[value(budget={"start_rad": 0.9})])
    assert "Next: improve the model" in text(found)
    found = replace(found, parameters=[*found.parameters, parameter("start_rad", "read off")])
    assert "Next: measure the start better, apart from this recording." in text(found)
    assert "improve the model" not in text(found)


@pytest.mark.parametrize(
    ("r", "rms", "advice"),
    [
        (-0.9999, 0.05, "fit a recording that separates length and damping"),
        (-0.9999, 0.002, "improve the model"),
        (0.98, 0.05, "improve the model"),
    ],
)
def test_a_better_model_is_not_asked_for_where_parameters_cannot_be_told_apart(r, rms, advice):
    found = held_out(fit=fit(rms=rms, r=r), cases=[segment("vad.0", u=0.001)])
    assert f"Next: {advice}" in text(found)
    told = "The fit cannot separate length and damping (correlation −0.9999)."
    assert (told in text(found)) == (r < 0)


@pytest.mark.parametrize(
    ("numerical", "words"),
    [
        (0.002, "is at most 5 % of the gap."),
        (0.02, "is up to 50 % of the gap: make the step shorter first."),
    ],
)
def test_the_engines_own_error_is_told_beside_the_gap(numerical, words):
    rows = [gap(0.0, 0.9, name, numerical=numerical) for name in ("north", "south")]
    found = record(gaps=rows, waveforms=[waveform(), waveform(source="south")])
    assert f"The error of the step {words}" in text(found)
    assert "error of the step" not in text(record(gaps=[gap(numerical=0.0)]))


def test_the_engines_agreement_is_told_from_their_spread_alone():
    rows = [waveform(), waveform(source="south")]
    found = record(waveforms=rows)
    assert "each other" not in text(found)
    spread = SpreadRecord("log", "angle_rad", ("north", "south"), 0.001)
    assert (
        "The engines differ from each other by 5 % of the gap: they agree better with each other"
        " than with reality." in text(replace(found, spread=[spread]))
    )
    wide = text(replace(found, spread=[replace(spread, rms=0.01)]))
    assert "The engines differ from each other by 50 % of the gap." in wide
    assert "same numbers" in text(replace(found, spread=[replace(spread, rms=0.0)]))


@pytest.mark.parametrize(
    ("row", "advice"),
    [
        (gap(0.0, 0.1), "use a quieter sensor or a longer record"),
        (gap(0.0, 0.1, numerical=0.05), "make the step shorter"),
    ],
)
def test_the_largest_part_of_what_is_left_is_what_to_do_next(row, advice):
    assert f"Next: {advice}" in text(record(gaps=[row]))


def test_a_fit_that_ended_at_a_bound_is_told():
    found = held_out(fit=fit(at_bound=["length_m"]))
    assert "Next: ask why the fit pushed the length to the limit" in text(found)


def test_both_scores_are_told_where_clocks_were_aligned():
    rows = [waveform(aligned=True, rmse=0.01), waveform(rmse=0.05)]
    found = text(record(waveforms=rows))
    assert "is off by 0.573°, 1 % of the measured range" in found
    assert "With the clocks as recorded it would be 2.86°." in found


def test_every_judged_quantity_has_its_own_sentence():
    other = waveform(probe="rate", rmse=0.3)
    compare = {"angle_rad": compared("Angle"), "rate": compared("DC voltage")}
    found = text(record(waveforms=[waveform(), other], compare=compare))
    assert "The simulated angle is off by 1.15°, 2 %" in found
    assert "The simulated DC voltage is off by 17.2°, 30 %" in found


def test_a_measurement_that_does_not_vary_has_no_range():
    assert "is off by 1.15° (root mean square)" in text(record(waveforms=[waveform(nrmse=None)]))


def test_defects_of_the_log_are_told():
    repairs = (
        Repair("counter_wrap", "repair", ""),
        Repair("time_gaps", "warning", ""),
        Repair("harmless", "info", ""),
    )
    found = text(record(provenance=replace(LOG, repairs=repairs)))
    assert "(repaired: counter wrap; left and marked: time gaps)" in found
    assert "harmless" not in found


def test_what_contradicts_the_log_is_told_in_full():
    found = text(
        record(provenance=replace(LOG, repairs=(Repair("drive", "warning", "it misses"),)))
    )
    assert "What is said of the log contradicts it: it misses." in found
    assert "had defects" not in found


def test_an_ambiguous_alignment_is_told_first():
    sure = Alignment(0.0, 0.0, 0.0, 0.0, "events")
    unsure = replace(sure, ambiguous=True)
    found = record(alignments=[unsure])
    assert answer.sentences(found)[0].startswith("The clocks are not aligned with certainty:")
    assert "with certainty" not in text(record(alignments=[sure]))
    assert "with certainty" not in text(record(alignments=[None]))
    two = record(cases=[segment("a"), segment("b")], alignments=[None, unsure])
    assert "with certainty (b):" in text(two)


def apart(**more):
    found = {"stream": "log", "parameter": "start_angle_rad", "channel": "angle", "over_s": 0.05,
             "simulated": math.pi / 2, "measured": math.pi / 6, "unit": "rad"}  # fmt: skip
    return ApartRecord(**(found | more))


def test_a_simulation_that_begins_elsewhere_is_told_first_and_nothing_is_advised():
    found = record(apart=[apart()])
    first = (
        "The simulation starts at 90°, the log at 30°: add start: {start_angle_rad: {channel:"
        " angle}} under validate: in the mapping."
    )
    assert answer.sentences(found)[0] == first
    assert "Next:" not in text(found)
    assert short(found) == (first, "The simulated angle from hanging is off by 1.15° (RMS).")


def test_a_start_is_read_off_as_the_channel_is_compared():
    found = record(apart=[apart(channel="arm 1", over_s=0.27, offset=-0.1)])
    assert '{channel: "arm 1", over_s: 0.27, offset: -0.1}' in short(found)[0]
    two = [apart(), apart(stream="b"), apart(stream="b", parameter="start_x_m", channel="x")]
    found = record(apart=two, cases=[segment("log"), segment("b")])
    assert (
        "the log at 30° on log: add start: {start_angle_rad: {channel: angle}, start_x_m:"
        in (short(found)[0])
    )


def test_a_window_that_was_cut_is_told():
    cut = segment("b", short=True, duration_s=4.25)
    assert "The log ends early: only 4.25 s are judged." in text(record(cases=[cut]))
    assert "only 4.25 s of b are judged" in text(record(cases=[segment("a"), cut]))
    assert "ends early" not in text(record())


def test_what_was_read_off_the_recording_is_not_called_known():
    rows = [("start_rad", "read off"), ("length_m", "known"), ("mass_kg", "scenario"),
            ("duration_s", "scenario"), ("damping_N_m_s_rad", "given")]  # fmt: skip
    found = record(parameters=[parameter(*row) for row in rows])
    assert (
        "The start was read off the start of the recording.\nThe damping was given by the user.\n"
        "The length was known before the measurement.\n"
        "One more parameter is the scenario's own, taken as exact." in text(found)
    )
    assert "All parameters" not in text(found)


def test_a_fit_chosen_with_the_judged_pieces_in_sight_is_no_prediction():
    found = held_out(fit=fit(chosen_knowing=True))
    assert "with the judged ones in sight, so this is weaker than a prediction" in text(found)
    assert "is a prediction" not in text(found)


def test_a_signal_of_nothing_but_noise_has_no_share_of_its_range():
    cases = [segment(u=0.01)]
    still = waveform(rmse=0.02, nrmse=0.3, n=500)
    assert "is off by 1.15° (root mean square)" in text(record(waveforms=[still], cases=cases))
    moving = waveform(rmse=0.02, nrmse=0.02, n=500)
    assert "2 % of the measured range" in text(record(waveforms=[moving], cases=cases))


def test_engines_that_are_equally_far_off_are_told_as_all():
    rows = [waveform(), waveform(source="south"), waveform(source="west")]
    assert "At one instant it is off by 2.29°, in all 3 engines." in text(record(waveforms=rows))
    assert "At one instant it is off by 3.44°, in south." in (
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
    assert told[:3] == [
        "The simulation is off by (root mean square): rate a 0.573°; rate b 1.15°; rate c 1.72°.",
        "So much of each gap (mean square) is neither noise nor the step: rate a 10 %; rate b 20 %;"
        " rate c 30 %.",
        "Nothing was fitted, so the rest may be wrong parameters or a wrong model.",
    ]


def test_a_vanishing_numerical_error_is_told_shortly():
    rows = [gap(0.0, 0.9, name, numerical=1e-6) for name in ("north", "south")]
    assert "error of the step is below 0.05 % of the gap" in text(record(gaps=rows))
