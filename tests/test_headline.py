"""The answer of a run in words: golden sentences from made records."""

from dataclasses import replace

import pytest

from simcompare.cli import console
from simcompare.model.tuning import AtSpeed, TuningRow
from simcompare.reports import builder
from simcompare.reports.render import matplotlib_, plotly_
from simcompare.reports.run import answer, listing, remarks, runs
from simcompare.reports.run.lead_figure import lead_figure
from simcompare.reports.run.lead_table import lead_table
from simcompare.results.records.run import SourceRecord
from tests import records
from tests.records import with_source, with_sources
from tests.test_reports import TOLERANCES, audit_row, make_run

ANSWER = {
    "measure": "restitution",
    "within": "the ball bounces with {value}",
    "outside": "the ball bounces with {value}",
    "nothing": "the ball stays on the floor",
    "causes": [{"quantity": "ball restitution", "says": "no restitution is set"}],
}


def answered(sources, **more):
    return make_run(sources, **{"answer": ANSWER, **more})


def changed(run, name, **fields):
    """The same run with fields of the scores of one engine replaced."""
    found = tuple(
        replace(s, **fields) if s.source == name and s.measure == "restitution" else s
        for s in run.record.scores
    )
    return records.changed(run, scores=found)


def level(mode, **values):
    return [(name, mode, value) for name, value in values.items()]


def test_all_engines_that_pass_are_one_clause_with_the_largest_deviation():
    run = answered(level("assisted", north=0.8001, south=0.7998, west=0.8042))
    # scores.tolerance is 0.008, so three decimals are told; 0.0042 is rounded up
    assert answer.sentences(run) == [
        "Assisted, the ball bounces with 0.800 to 0.804 (± 0.001) in all 3 engines,"
        " within 0.005 of the closed form of 0.8."
    ]


def test_engines_that_agree_are_grouped_and_the_odd_ones_named():
    values = {"north": 0.801, "south": 0.803, "east": 0.9, "west": 0.904, "far": 0.7}
    assert answer.sentences(answered(level("tuned", **values))) == [
        "Tuned, the ball bounces with 0.801 to 0.803 (± 0.001) in north and south;"
        " too far off: 0.900 to 0.904 (± 0.001) in east and west,"
        " 0.700 ± 0.001 in far, where the closed form gives 0.8."
    ]


def test_one_that_scatters_stands_apart_from_those_that_do_not():
    run = changed(answered(level("tuned", north=0.9, south=0.9)), "south", scatter=0.05)
    assert "0.900 ± 0.001 in north, 0.900 ± 0.050 in south" in answer.sentences(run)[0]


def test_what_is_outside_is_told_with_enough_digits_to_see_it():
    # 0.8083 would round to 0.808, which is on the edge of 0.8 ± 0.008
    assert "0.8083" in answer.sentences(answered(level("tuned", north=0.8083)))[0]


def test_by_default_nothing_happens_and_the_audit_tells_why():
    (sentence,) = answer.sentences(answered(level("default", north=0.0, south=0.001)))
    assert sentence == (
        "By default the ball stays on the floor in north and south: no restitution is set."
    )


def test_what_most_engines_do_wrong_comes_first():
    run = answered(level("tuned", north=0.0, south=0.0, west=0.5))
    assert answer.sentences(run)[0] == (
        "Tuned, the ball stays on the floor in north and south;"
        " the ball bounces with 0.500 ± 0.001 in west, where the closed form gives 0.8."
    )


def test_a_cause_is_told_only_of_engines_that_hold_a_value_of_their_own():
    run = answered(level("default", north=0.0, south=0.0))
    run = with_source(run, 1, audit=(replace(audit_row("default"), read_value=0.8),))
    assert answer.sentences(run)[0].endswith(": in north no restitution is set.")
    run = with_source(run, 0, audit=())
    assert answer.sentences(run)[0].endswith("north and south.")


def test_of_engines_that_agree_no_value_is_told_that_none_of_them_has():
    template = {**ANSWER, "within": "the ball bounces with {value} for {settling_time}"}
    run = answered(level("tuned", north=0.797, south=0.803), answer=template)
    times = {"north": 3.9, "south": 4.1}
    timed = [
        replace(s, value=times[s.source]) if s.measure == "settling_time" else s
        for s in run.record.scores
    ]
    run = changed(records.changed(run, scores=tuple(timed)), "south", scatter=0.003)
    (sentence,) = answer.sentences(run)
    assert "with 0.797 to 0.803 (± 0.003 at most) for 3.9 to 4.1 s in north" in sentence


def test_a_value_that_could_not_be_measured_says_nothing_of_the_ball():
    run = changed(answered(level("tuned", north=0.8, south=0.8)), "south", value=None)
    (sentence,) = answer.sentences(run)
    assert sentence.endswith("; the restitution could not be measured in south.")
    why = "south does not give ball.position_m: it has none"
    run = changed(run, "south", lacking=why)
    assert answer.sentences(run)[0].endswith(f"measured in south ({why}).")


def test_values_of_some_repeats_are_told_as_such():
    run = answered(level("default", north=0.0, south=0.0, west=0.004))
    run = changed(run, "south", value=None, low=0.01, high=0.17, repeats=2)
    # the mean is next to nothing, and yet one of the repeats bounces
    run = changed(run, "west", low=0.0, high=0.018)
    assert answer.sentences(run) == [
        "By default the ball stays on the floor in north: no restitution is set; the restitution"
        " differs from repeat to repeat, 0.010 to 0.170 in south (measured in 2 of 3), 0 to"
        " 0.018 in west."
    ]


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_value_that_is_not_finite_is_none(value):
    run = changed(answered(level("tuned", north=0.8)), "north", value=value)
    assert answer.sentences(run) == ["Tuned, the restitution could not be measured in north."]


def test_the_same_at_two_levels_is_said_once():
    run = answered([*level("tuned", north=0.8), *level("assisted", north=0.8)])
    (sentence,) = answer.sentences(run)
    assert sentence.startswith("Tuned and assisted, the ball bounces with 0.800 ± 0.001 in")


def test_the_step_is_told_where_all_took_the_same():
    run = answered(level("tuned", north=0.8, south=0.8))
    row = replace(audit_row("tuned"), quantity="engine step_s", set_value=0.002, read_value=None)
    # some engines hold what they were given in few digits
    read = replace(row, read_value=0.0020000001)
    typed = tuning([0.81], 0.0, 0.0)
    run = with_sources(run, audit=[(row,), (read,)], tuning=[typed, typed])
    assert lead_table(run).title.endswith("repeats, step 2 ms; tolerance 0.008")
    assert any(
        "for a restitution of 0.8, at a step of 2 ms: " in one for one in remarks.typed_in(run)
    )
    run = with_source(run, 0, audit=(replace(row, set_value=0.001),))
    assert "repeats, steps 1 to 2 ms; tolerance" in lead_table(run).title
    assert not any("at a step of" in one for one in remarks.typed_in(run))


def test_without_helps_the_level_says_so():
    run = answered(level("assisted", north=0.8), assist="none")
    assert answer.sentences(run)[0].startswith("Assisted by nothing,")


def test_another_measure_in_a_template_is_filled_in():
    template = {**ANSWER, "within": "the ball bounces with {value} for {settling_time}"}
    run = answered(level("tuned", north=0.8), answer=template)
    timed = [
        replace(s, value=3.96) if s.measure == "settling_time" else s for s in run.record.scores
    ]
    (sentence,) = answer.sentences(records.changed(run, scores=tuple(timed)))
    assert "bounces with 0.800 ± 0.001 for 4.0 s in north" in sentence


def test_many_values_are_a_range():
    values = {f"e{i}": 0.1 * i for i in range(1, 8)}  # e7 is 0.7
    (sentence,) = answer.sentences(answered(level("tuned", **values)))
    assert "the ball bounces with 0.100 to 0.700 (± 0.001) in all 7 engines" in sentence


def test_without_an_answer_the_first_judged_measure_leads():
    assert answer.sentences(make_run(level("default", north=0.5))) == [
        "By default the restitution is 0.500 ± 0.001 in north, where the closed form gives 0.8."
    ]
    # a scenario may name what this run did not measure
    other = {**ANSWER, "measure": "bounciness"}
    assert answer.sentences(make_run(level("default", north=0.5), answer=other))[0].startswith(
        "By default the restitution is"
    )


def test_without_a_truth_nothing_is_called_right_or_wrong():
    assert answer.sentences(answered(level("assisted", north=0.7), truth=None)) == [
        "Assisted, the ball bounces with 0.7000 ± 0.0010 in north.",
        "There is no truth to hold the restitution against.",
    ]


def test_nothing_measured_says_so():
    run = answered(level("default", north=None))
    assert answer.sentences(run) == ["Nothing was measured."]
    assert remarks.remarks(run)[-1] == "Did not run: north (failed)."


# remarks


def test_what_was_missed_is_named_measure_by_measure_and_the_farthest_with_its_size():
    run = answered(level("assisted", north=0.801, south=0.9))
    assert remarks.remarks(run)[-1] == (
        "Assisted, too far off: restitution in south (the farthest: off by 0.1000 ± 0.0010,"
        " 12 times the tolerance); settling time could not be measured in north and south."
    )


def test_that_all_tolerances_are_met_is_said():
    only = {"restitution": TOLERANCES["restitution"]}
    run = answered(level("assisted", north=0.8, south=0.8, west=0.8), tolerances=only)
    assert remarks.remarks(run)[-1] == "Assisted, the one judged value is right in all 3 engines."


def test_what_was_not_measured_is_not_called_met():
    run = answered(level("assisted", north=0.8, south=0.8))
    why = "south does not give ball.position_m: it has none"
    met = [replace(s, value=4.0, verdict="pass") if s.measure == "settling_time" else s
           for s in run.record.scores]  # fmt: skip
    run = changed(records.changed(run, scores=tuple(met)), "south", value=None,
                  verdict="info", lacking=why)  # fmt: skip
    assert remarks.remarks(run)[-1] == (
        "Assisted, both judged values are right in north;"
        f" in south 1 of 2 is right, 1 was not measured ({why})."
    )


def test_what_the_scatter_is_and_what_the_first_event_gives_is_said():
    run = answered(level("tuned", north=0.8, south=0.8))
    first = [replace(s, value=0.78) if (s.source, s.index) == ("south", 1) else s
             for s in run.record.scores]  # fmt: skip
    assert remarks.remarks(records.changed(run, scores=tuple(first)))[:2] == [
        "± is the standard deviation over 3 repeats. Phases.",
        "Tuned, the first restitution alone is 0.800 ± 0.001 in north, 0.780 ± 0.001 in south.",
    ]


def test_variants_say_what_they_are():
    run = answered(level("tuned", **{"north:fine": 0.8, "north": 0.8}))
    run = with_source(run, 0, notes=("variant fine: ten sweeps [its manual, §2]",))
    assert "north:fine: ten sweeps." in remarks.remarks(run)


def test_engines_that_did_not_run_are_told_once_by_what_became_of_them():
    run = answered([*level("tuned", north=0.8, south=None), *level("assisted", south=None)])
    east = SourceRecord(name="east", contact="tuned", status="missing", reason="pip install it")
    run = records.changed(run, sources=(*run.record.sources, east))
    found = remarks.remarks(run)
    assert "Did not run: south (failed); east (missing)." in found


def test_an_engine_that_ran_at_some_levels_is_not_said_not_to_have_run():
    run = answered([*level("tuned", north=0.8), *level("assisted", north=None)])
    assert remarks.remarks(run)[-1] == ("Not run assisted: north (failed).")


def test_an_interrupted_run_says_so():
    run = answered(level("assisted", north=0.8), interrupted=True)
    assert remarks.remarks(run)[-1] == "The run was interrupted before it was complete."


def tuning(numbers, depth_m, contact_s):
    at = AtSpeed(2.0, 0.8, 0.0, depth_m, contact_s, 0.0)
    return (TuningRow((), 0.8, tuple(numbers), 2.0, 1e-3, size_m=0.04, at=(at,)),)


def test_what_is_typed_in_and_what_contacts_cost():
    run = answered(level("tuned", north=0.8, south=0.8, west=0.8, east=0.8))
    spring = (-119338.1, -50.87462)
    run = with_sources(
        run,
        tuning=[
            tuning([0.80132], 1e-7, 0.0019),
            tuning(spring, 0.01172, 0.0086),
            tuning([0.79853], 0.0043, 0.001),
            tuning([0.81], 0.0044, 0.0022),
        ],
    )
    rows = tuple(
        replace(audit_row("tuned"), engine_parameter=f"spring[{i}]", set_value=value)
        for i, value in enumerate(spring)
    )
    run = with_source(run, 1, audit=rows)
    assert remarks.remarks(run)[2:4] == [
        "Typed in for a restitution of 0.8: 0.8013 in north, spring = (−119338, −50.8746) in"
        " south, 0.7985 in west, 0.81 in east.",
        "A tuned contact sinks in by up to 12 mm and lasts 8.6 ms in south;"
        " 4.3 to 4.4 mm and 1 to 2.2 ms in west and east; 0.4 mm and 1.9 ms in north.",
    ]


# lists


def test_one_engine_in_several_rows_is_not_several_engines():
    assert listing.engines(["a", "b", "c"], ["a", "b", "c"]) == "all 3 engines"
    rows = ["a", "a@2ms", "a:rk4"]
    assert listing.engines(rows, rows) == "all 3 cases"
    assert listing.engines(["a", "c"], ["a", "b", "c"]) == "a and c"
    assert listing.engines(list("acdef"), list("abcdef")) == "5 of 6 engines"


def test_an_engine_at_all_of_its_steps_is_one_name():
    every = ["a@1ms", "a@2ms", "b@1ms", "b@2ms", "c@1ms", "c@2ms", "c@4ms"]
    some = ["a@1ms", "a@2ms", "b@2ms", "c@1ms", "c@4ms"]
    assert listing.steps_together(some, every) == ["a", "b@2ms", "c@1ms/4ms"]


def test_a_tolerance_with_both_widths_is_the_larger_one():
    both = {"restitution": {"relative": 0.1, "absolute": 0.01, "reason": "Because of both."}}
    run = make_run(level("default", north=0.5), tolerances=both)
    score = next(s for s in run.record.scores if s.measure == "restitution" and s.index is None)
    assert runs.width(run, score) == pytest.approx(0.08)


def test_each_source_is_held_to_its_own_tolerance(monkeypatch):
    """As where steps are compared, and longer ones are held to less."""
    run = answered(level("tuned", north=0.82, south=0.82, west=0.8))
    wide = {"north": 0.04}
    monkeypatch.setattr(runs, "width", lambda run, score: wide.get(score.source, 0.008))
    assert answer.sentences(run) == [
        "Tuned, the ball bounces with 0.800 ± 0.001 in west, 0.820 ± 0.001 in north;"
        " too far off: 0.820 ± 0.001 in south, where the closed form gives 0.8."
    ]
    (panel,) = lead_figure(run).panels
    *bands, truth = panel.spans
    assert [band.rows for band in bands] == [(-0.5, 0.5), (0.5, 1.5), (1.5, 2.5)]
    assert [band.high for band in bands] == pytest.approx([0.84, 0.808, 0.808])
    assert truth.rows is None
    # both renderers draw them
    shapes = plotly_.as_dict(lead_figure(run))["layout"]["shapes"]
    assert [(one["y0"], one["y1"], one["yref"]) for one in shapes[:2]] == [
        (-0.5, 0.5, "y"), (0.5, 1.5, "y"),
    ]  # fmt: skip
    assert matplotlib_.rendered(lead_figure(run), "svg")


# on a terminal


def test_long_reasons_are_folded_and_commands_stay_in_one_piece(capsys):
    command = "'.venv/bin/python' -m pip install " + "'a package with a long name' " * 4
    console.print_wrapped([f"{'north is not installed ' * 5}; cure: {command}"])
    *folded, last = capsys.readouterr().out.splitlines()
    assert max(map(len, folded)) <= 80
    assert last == f"  {command}"


def test_a_value_and_its_scatter_stay_on_one_line(capsys):
    console.print_wrapped(["x" * 70 + " 0.5 (± 0.1 at most)"])
    assert any(line.strip().startswith("(± 0.1") for line in capsys.readouterr().out.splitlines())


# the table of the report


def test_counts_of_tolerances_name_their_level_and_ends_stand_for_a_mean(tmp_path):
    run = answered([*level("tuned", north=0.8), *level("assisted", north=0.8)])
    run = changed(run, "north", value=None, low=0.01, high=0.17)
    page = builder.write_html([run], tmp_path / "report.html").read_text(encoding="utf-8")
    assert "tuned\u00a01\u00a0of\u00a02" in page
    assert "assisted\u00a01\u00a0of\u00a02" in page
    assert "0.0100 to 0.1700" in page


TWO = """
name: two
title: Two balls
question: Do both bounce?
world: {duration_s: 0.6, step_s: 0.001}
bodies:
  floor: {fixed: true, shapes: [{type: plane}]}
  a: {mass_kg: 0.1, inertia_kg_m2: [1e-4, 1e-4, 1e-4], position_m: [0, 0, 0.3],
      shapes: [{type: sphere, radius_m: 0.05}]}
  b: {mass_kg: 0.1, inertia_kg_m2: [1e-4, 1e-4, 1e-4], position_m: [1, 0, 0.3],
      shapes: [{type: sphere, radius_m: 0.05}]}
contacts:
  - {pair: [a, floor], restitution: 0.8}
  - {pair: [b, floor], restitution: 0.5}
probes:
  height_m: {observe: a.position_m, component: 2, offset: -0.05, label: Height, unit: m}
measures:
  - {function: bounces, probe: height_m}
"""


@pytest.mark.engines("pymunk")
def test_numbers_are_told_for_every_restitution_of_a_scene(call, tmp_path):
    (tmp_path / "two").mkdir()
    (tmp_path / "two" / "two.yaml").write_text(TWO, encoding="utf-8")
    words = ("--engine", "pymunk", "--contact", "tuned", "--no-report", "-v")
    _, out, _ = call("run", str(tmp_path / "two"), *words)
    told = " ".join(out.split())
    assert "Typed in for a restitution of 0.8, at a step of 1 ms: 0.80" in told
    assert "Typed in for a restitution of 0.5, at a step of 1 ms: 0.50" in told


FINE = {"restitution": {"relative": None, "absolute": 5.9e-5, "reason": "Because it is fine."}}


def test_a_small_end_of_a_range_and_a_small_scatter_are_no_zero():
    values = {"north": -0.000401, "south": 0.00688, "west": 0.004}
    run = answered(level("default", **values), truth=0.01954, tolerances=FINE)
    assert "bounces with −0.00040 to 0.00688 (± 0.00100) in" in answer.sentences(run)[0]
    run = answered(level("default", north=0.01954), truth=0.01954, tolerances=FINE)
    run = changed(run, "north", scatter=2e-4)
    assert "bounces with 0.01954 ± 0.00020 in north" in answer.sentences(run)[0]


def test_a_scatter_below_the_last_digit_is_not_told():
    run = changed(answered(level("tuned", north=0.8)), "north", scatter=2e-4)
    assert "bounces with 0.800 in north" in answer.sentences(run)[0]


def test_a_range_of_powers_of_ten_has_its_scatter_too():
    tiny = {"restitution": {"relative": None, "absolute": 1e-9, "reason": "Because it is tiny."}}
    values = {"north": 4e-6, "south": 6e-6, "west": 5e-6}
    run = answered(level("default", **values), truth=0.0, tolerances=tiny)
    for name in values:
        run = changed(run, name, scatter=3e-8)
    assert "4·10⁻⁶ to 6·10⁻⁶ (± 3·10⁻⁸)" in answer.sentences(run)[0]
