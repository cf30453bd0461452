"""The answer of a validation in plain words."""

import pytest

from simcompare.validation import telling

FITTED = ("length_m", "damping_N_m_s_rad")


def waveform(parameters="known before", source="north", stream="log", rmse=0.02, **more):
    return {
        "source": source, "stream": stream, "probe": "angle_rad", "unit": "rad", "judged": True,
        "parameters": parameters, "aligned": False, "rmse": rmse, "max_abs": 2 * rmse,
        "nrmse": rmse, **more,
    }  # fmt: skip


def gap(removed=0.0, model_form=0.9, source="north", stream="log", covered=None, **more):
    total = 0.04
    noise = 1 - removed - model_form
    return {
        "source": source, "stream": stream, "probe": "angle_rad", "total": total,
        "remaining": total * (1 - removed) ** 0.5, "model_form": total * model_form**0.5,
        "noise": total * max(noise, 0.0) ** 0.5, "numerical": 0.0, "covered": covered,
        "shares": {"removed": removed, "model_form": model_form, "noise": noise, "numerical": 0.0},
        **more,
    }  # fmt: skip


def value(e_n=0.5, stream="log", **more):
    return {
        "source": "north", "stream": stream, "measure": "mean_period", "e_n": e_n,
        "within_noise": None if e_n is None else abs(e_n) <= 1, "u_val": 1.0, "u_num": 0.1,
        "u_input": 0.9, "u_data": 0.4, **more,
    }  # fmt: skip


def fit(streams=("id.0",), at_bound=()):
    return {"recording": "swings", "streams": list(streams), "at_bound": list(at_bound)}


def record(**more):
    rows = [{"name": name, "fitted": 1.0 if more.get("fit") else None} for name in FITTED]
    return {
        "recording": "swings", "basis": telling.KNOWN, "fit": None, "parameters": rows,
        "compare": {"angle_rad": {"label": "Angle from hanging"}},
        "cases": [{"stream": "log"}], "waveforms": [waveform()], "gaps": [gap()],
        "values": [value()], "timings": [], "provenance": {"repairs": []}, **more,
    }  # fmt: skip


def held_out(**more):
    return record(
        basis=telling.HELD_OUT, fit=fit(), cases=[{"stream": "vad.0"}],
        waveforms=[waveform(stream="vad.0", rmse=0.04),
                   waveform("fitted", stream="vad.0", rmse=0.01)],
        gaps=[gap(0.75, 0.2, stream="vad.0")], **more,
    )  # fmt: skip


def text(found):
    return "\n".join(telling.sentences(found))


def test_parameters_that_were_known_before():
    assert telling.sentences(record()) == [
        "With the parameters known before, the simulated angle from hanging is 2 % of the measured"
        " range off (root mean square). The largest: north, 0.02 rad, and 0.04 rad at one instant.",
        "Of the gap of the angle from hanging, 90 % of the mean square is neither noise nor"
        " numerical error. Nothing was fitted, so it may come from the parameters as well as from"
        " the form of the model.",
        "The one single value agrees within the noise level (|E_n| ≤ 1, k = 2); that shows no"
        " fault, and proves no model. 81 % of the squared uncertainty comes from the parameters.",
        "All parameters were known before the measurement was looked at.",
        "Next: fit the parameters to one part of the recordings and judge another (calibrate:), to"
        " tell wrong parameters from a wrong model.",
    ]


def test_parameters_that_were_fitted_elsewhere():
    assert telling.sentences(held_out()) == [
        "With fitted parameters, the simulated angle from hanging is 1 % of the measured range off"
        " (root mean square); before the fit it was 4 % of the measured range. The largest: north"
        " on vad.0, 0.01 rad, and 0.02 rad at one instant.",
        "What the gap of the angle from hanging is made of, in shares of its mean square:"
        " parameters 75 %; model form 20 %; noise of the measurement 5 %.",
        "The one single value agrees within the noise level (|E_n| ≤ 1, k = 2); that shows no"
        " fault, and proves no model. 81 % of the squared uncertainty comes from the parameters.",
        "Length and damping were fitted to id.0 of swings and held against vad.0 of swings, which"
        " the fit had not seen: what is said here is a prediction. It holds for motions like"
        " these, not beyond.",
        "Next: a better model; neither a shorter step nor a quieter sensor would close this gap."
        " What is left over time shows where to look.",
    ]


def test_parameters_that_were_fitted_to_what_is_judged():
    found = record(
        basis=telling.SAME, fit=fit(["log"]), waveforms=[waveform(), waveform("fitted", rmse=0.01)],
        gaps=[gap(0.75, 0.2)],
    )  # fmt: skip
    told = telling.sentences(found)
    assert (
        "Length and damping were fitted to swings, which is also what was judged: this is a fit,"
        " not a validation." in told
    )
    assert told[-1] == "Next: judge stretches that were not fitted."
    assert "prediction" not in text(found)
    assert "proves" not in text(found)


def test_no_engine_ran():
    found = record(waveforms=[], gaps=[], values=[])
    assert telling.sentences(found) == ["No engine ran, so nothing can be said."]


def test_a_value_without_uncertainty_is_not_judged():
    found = record(values=[value(None)])
    assert (
        "No single value can be judged, because a part of its uncertainty is not known."
        in telling.sentences(found)
    )
    assert telling.verdict(value(None), telling.KNOWN).startswith("cannot be judged")


def test_a_recording_that_shows_no_single_value():
    assert "No single value of the scenario can be read off this recording." in (
        telling.sentences(record(values=[]))
    )


@pytest.mark.parametrize(
    ("e_n", "basis", "words"),
    [
        (0.9, telling.KNOWN, "within the noise level"),
        (-0.9, telling.HELD_OUT, "within the noise level"),
        (0.9, telling.SAME, "within the noise level, but fitted to the same data"),
        (1.1, telling.SAME, "differs by more than the uncertainties explain"),
        (-1.1, telling.KNOWN, "differs by more than the uncertainties explain"),
    ],
)
def test_the_words_for_a_value(e_n, basis, words):
    assert telling.verdict(value(e_n), basis) == words


@pytest.mark.parametrize("make", [record, held_out])
def test_nothing_is_ever_called_validated(make):
    assert "validated" not in text(make())


def test_the_furthest_value_is_named():
    found = record(values=[value(0.2), value(-4.44, stream="vad-1", measure="log_decrement")])
    assert (
        "Of 2 single values 1 agrees within the noise level (|E_n| ≤ 1, k = 2); the furthest is the"
        " log decrement of north on vad-1, E_n = −4.4." in text(found)
    )


def test_parameters_that_do_not_carry_over():
    found = record(
        basis=telling.HELD_OUT, fit=fit(), gaps=[gap(-0.06, 1.05)],
        waveforms=[waveform(), waveform("fitted")],
    )  # fmt: skip
    assert (
        "The fitted parameters made the gap larger, by up to 6 %, so they do not carry over"
        in text(found)
    )
    assert "Model form is what no choice of these parameters takes away" in text(found)


def test_uncertain_parameters_take_the_blame_from_the_model():
    blamed = record(fit=fit(), basis=telling.HELD_OUT, gaps=[gap(0.1, 0.8, covered=0.5)],
                    waveforms=[waveform(), waveform("fitted")])  # fmt: skip
    assert "covers 50 % of the samples; the others differ by more than that" in text(blamed)
    assert "something is missing in the equations" in text(blamed)
    assert "Next: a better model" in text(blamed)
    spared = {**blamed, "gaps": [gap(0.1, 0.8, covered=1.0)]}
    assert "it may explain the gap without any fault of the model" in text(spared)
    assert "something is missing" not in text(spared)
    assert "Next: know the parameters better" in text(spared)


@pytest.mark.parametrize(
    ("numerical", "words"),
    [
        (0.002, "is at most 5 % of that: they agree far better with each other than with reality."),
        (0.02, "is up to 50 % of that: a shorter step comes first."),
    ],
)
def test_the_engines_own_error_is_told_beside_the_gap(numerical, words):
    rows = [gap(0.0, 0.9, name, numerical=numerical) for name in ("north", "south")]
    found = record(gaps=rows, waveforms=[waveform(), waveform(source="south")])
    assert f"The numerical error of each engine {words}" in text(found)
    assert "each other" not in text({**found, "gaps": rows[:1]})


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
    found = held_out() | {"fit": fit(at_bound=["length_m"])}
    assert "Next: ask why the fit pushed the length to its bound" in text(found)


def test_both_scores_are_told_where_clocks_were_aligned():
    rows = [waveform(aligned=True, rmse=0.01), waveform(rmse=0.05)]
    assert (
        "is 1 % of the measured range off (root mean square); with the clocks as recorded it would"
        " be 5 % of the measured range" in text(record(waveforms=rows))
    )


def test_every_judged_quantity_has_its_own_sentence():
    other = waveform(probe="rate", rmse=0.3)
    compare = {"angle_rad": {"label": "Angle"}, "rate": {"label": "DC voltage"}}
    found = text(record(waveforms=[waveform(), other], compare=compare))
    assert "the simulated angle is 2 %" in found
    assert "the simulated DC voltage is 30 %" in found


def test_a_measurement_that_does_not_vary_has_no_range():
    assert "is 0.02 rad off" in text(record(waveforms=[waveform(nrmse=None)]))


def test_defects_of_the_log_are_told():
    repairs = [
        {"rule": "counter_wrap", "severity": "repair"},
        {"rule": "time_gaps", "severity": "warning"},
        {"rule": "harmless", "severity": "info"},
    ]
    found = text(record(provenance={"repairs": repairs}))
    assert "(repaired: counter wrap; left and marked: time gaps)" in found
    assert "harmless" not in found


def test_events_alone_are_an_answer():
    timing = {
        "source": "north", "stream": "log", "series": "impact_times", "matched": 5, "missed": 1,
        "extra": 0, "rmse_s": 0.002,
        "intervals": [{"e_n": 0.5}, {"e_n": 3.0}, {"e_n": None}],
    }  # fmt: skip
    found = text(record(waveforms=[], gaps=[], values=[], timings=[timing]))
    assert (
        "Impact times: simulated and measured are at most 0.002 s apart (root mean square, north);"
        " 1 has no partner. Of 2 intervals 1 agrees within the noise level" in found
    )


def test_many_quantities_are_told_in_one_sentence():
    probes = {"a": "Rate a", "b": "Rate b", "c": "Rate c"}
    found = record(
        compare={probe: {"label": label} for probe, label in probes.items()},
        waveforms=[waveform(probe=p, rmse=0.01 * i) for i, p in enumerate(probes, start=1)],
        gaps=[gap(model_form=0.1 * i, probe=p) for i, p in enumerate(probes, start=1)],
    )
    told = telling.sentences(found)
    assert told[0] == (
        "With the parameters known before, the simulated signals are off by these shares of the"
        " measured range (root mean square): rate a 1 %; rate b 2 %; rate c 3 %."
    )
    assert told[1].startswith(
        "Of the mean square of each gap this is neither noise nor numerical error: rate a 10 %;"
        " rate b 20 %; rate c 30 %. Nothing was fitted"
    )


def test_a_value_just_outside_does_not_look_like_one_just_inside():
    assert "None of 2 single values agrees" in text(record(values=[value(-1.04), value(1.02)]))
    assert "E_n = −1.04" in text(record(values=[value(-1.04), value(1.02)]))


def test_a_vanishing_numerical_error_is_told_shortly():
    rows = [gap(0.0, 0.9, name, numerical=1e-6) for name in ("north", "south")]
    assert "of each engine is below 0.05 % of that" in text(record(gaps=rows))
