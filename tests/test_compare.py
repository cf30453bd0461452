"""Runs beside each other: what differs is found, named, shown and written."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from dataclasses import fields, replace

import numpy as np
import pandas as pd
import pytest

import simcompare
from simcompare.errors import InputError, UnknownName
from simcompare.model.plain import plain
from simcompare.reports.compare import page, tables, words
from simcompare.reports.compare.compared import compared
from simcompare.reports.compare.figure import deviations, figure
from simcompare.reports.render.text_tables import lines
from simcompare.results.records.run import Record
from tests import validations
from tests.records import changed

TITLE = "Restitution, mean of all events and 3 repeats"


def many(run, heights):
    """The same run as if it had been made from each height."""
    return [
        changed(run, parameters={**run.record.parameters, "drop_height_m": height})
        for height in heights
    ]


def with_version(run, version):
    return changed(run, sources=tuple(replace(s, version=version) for s in run.record.sources))


def score_of(run, level, measure):
    return next(
        score
        for score in run.record.scores
        if (score.contact, score.measure, score.index) == (level, measure, None)
    )


# --- what differs -------------------------------------------------------------------------------


def test_runs_are_named_by_the_one_thing_that_differs_and_stand_in_its_order(sweep):
    found = compared(sweep)
    assert found.titles == ("drop_height = 0.3 m", "drop_height = 1 m", "drop_height = 2 m")
    assert [one.name for one in found.differences] == ["drop_height_m"]
    assert found.swept is found.differences[0]


@pytest.mark.parametrize(
    ("fields", "title"),
    [
        ({"preset": "golf"}, "preset golf"),
        ({"assist": "none"}, "helps none"),
        ({"fit_asked": "runs/fit.json"}, "fit runs/fit.json"),
        ({"repeats": 9}, "repeats = 9"),
        ({"against_asked": "itf"}, "against itf"),
        ({"scenario": "other"}, "other"),
    ],
)
def test_each_kind_of_difference_has_its_words(sweep, fields, title):
    found = compared([sweep[0], changed(sweep[0], **fields)])
    assert found.titles[1] == title


def test_a_step_is_told_in_milliseconds(sweep):
    def at(step_s):
        source = sweep[0].record.sources[0]
        rows = [row for row in source.audit if row.quantity == "engine step_s"]
        audit = tuple(replace(row, scenario_value=step_s) for row in rows)
        return changed(sweep[0], sources=(replace(source, audit=audit),))

    assert compared([at(0.0005), at(0.002)]).titles == ("step = 0.5 ms", "step = 2 ms")


def test_engines_levels_and_versions_are_named_where_nothing_else_tells_runs_apart(sweep):
    run = sweep[0]
    sources = run.record.sources
    assert compared([run, with_version(run, "9.9")]).titles[1] == "pymunk 9.9"
    default = changed(run, sources=sources[:1])
    assert compared([run, default]).titles == ("default, tuned, assisted", "default")
    other = changed(run, sources=tuple(replace(one, name="twin") for one in sources))
    assert compared([run, other]).titles == ("pymunk", "twin")


def test_what_is_not_in_a_title_is_told_beside(sweep):
    found = compared([sweep[0], changed(sweep[1], repeats=9)])
    assert found.titles == ("drop_height = 0.3 m", "drop_height = 1 m")
    assert "Also different: repeats (9; 3)." in words.notes(found)


def test_a_value_that_follows_from_the_preset_is_not_named_beside_it(sweep):
    golf = changed(sweep[1], preset="golf", command=("simcompare", "run", "ball"))
    plain = changed(sweep[0], command=("simcompare", "run", "ball"))
    assert compared([plain, golf]).titles == ("no preset", "preset golf")
    as_well = changed(golf, command=sweep[1].record.command)
    assert compared([sweep[0], as_well]).titles[1] == "preset golf, drop_height = 0.3 m"


def test_runs_in_which_nothing_differs_have_the_names_of_their_folders(sweep):
    twin = replace(sweep[0], folder=sweep[1].folder)
    found = compared([sweep[0], twin])
    assert found.titles == (sweep[0].folder.name, sweep[1].folder.name)
    assert words.title(found) == "Bouncing ball: 2 runs with the same settings"
    assert "Nothing that is stored differs between these runs" in words.notes(found)[0]


def test_runs_of_the_same_value_get_a_number(sweep):
    found = compared([*sweep, sweep[1]])
    assert found.titles[:2] == ("drop_height = 0.3 m (1)", "drop_height = 0.3 m (2)")


def test_a_changed_file_of_the_scenario_is_told(sweep):
    found = compared([sweep[0], changed(sweep[1], scenario_sha256="other")])
    assert "The file of the scenario changed between these runs" in words.notes(found)[0]


# --- what cannot be compared --------------------------------------------------------------------


def test_one_run_and_other_kinds_are_refused(sweep):
    with pytest.raises(InputError, match="name at least two"):
        compared(sweep[:1])
    with pytest.raises(InputError) as stop:
        compared([sweep[0], changed(sweep[1], kind="fit")])
    fit = sweep[1].folder
    assert str(stop.value) == (
        f"compare: {fit.name} is a fit; expected runs;"
        f" for one page of all: simcompare report {fit} -o comparison.html"
    )


def test_runs_without_a_measure_in_common_are_refused(sweep):
    scores = tuple(replace(score, measure="depth") for score in sweep[1].record.scores)
    other = changed(sweep[1], scores=scores, scenario="dive")
    with pytest.raises(InputError) as stop:
        compared([sweep[0], other, sweep[2]])
    places = f"{sweep[0].folder} {sweep[2].folder}"
    assert str(stop.value) == (
        "compare: runs of different scenarios have nothing in common: ball (2) and dive (1);"
        f" compare those of one scenario, such as: simcompare compare {places}"
    )


def test_runs_in_which_no_engine_ran_are_left_out_and_named(sweep):
    broken = changed(sweep[1], scores=())
    found = compared([sweep[0], broken, sweep[2]])
    assert len(found.runs) == 2
    assert words.notes(found) == (f"Left out: {sweep[1].folder.name}: no engine ran.",)
    with pytest.raises(InputError, match="has nothing to be compared with"):
        compared([sweep[0], broken])


def two_validations(run, folder):
    """Stores two validations, of which only the records are needed."""
    common = {one.name for one in fields(Record)}
    kept = {name: value for name, value in plain(run.record).items() if name in common}
    more = {"kind": "validation", "validation": plain(validations.record())}
    for name in ("one", "two"):
        (folder / name).mkdir()
        text = json.dumps({**kept, **more, "recording_asked": ["swings"]})
        (folder / name / "run.json").write_text(text, encoding="utf-8")


def test_a_folder_without_a_run_is_told_in_one_sentence(sweep, tmp_path):
    two_validations(sweep[0], tmp_path)
    with pytest.raises(InputError) as caught:
        simcompare.compare(tmp_path)
    says = "holds 2 validations, and no run; expected runs, or a folder that holds them"
    assert str(caught.value) == f"{tmp_path}: {says}"


def test_what_is_no_run_in_a_folder_is_left_out_and_named(sweep, tmp_path):
    for run in sweep:
        shutil.copytree(run.folder, tmp_path / run.folder.name)
    damaged = tmp_path / "broken" / "run.json"
    damaged.parent.mkdir()
    damaged.write_text("{", encoding="utf-8")
    two_validations(sweep[0], tmp_path)
    found = simcompare.compare(tmp_path).compared
    assert len(found.runs) == 3
    damage, others = words.notes(found)
    assert damage.startswith("Left out: broken is damaged: cannot be read")
    assert others == f"Left out: 2 validations in {tmp_path}."


def test_of_different_scenarios_only_what_both_measure_is_compared(sweep):
    scores = tuple(s for s in sweep[1].record.scores if s.measure == "settling_time")
    found = compared([sweep[0], changed(sweep[1], scores=scores, scenario="dive")])
    assert found.measures == ("settling_time",)
    assert words.notes(found)[0].endswith("is compared: settling time.")


def test_a_measure_that_is_not_there_names_those_that_are(sweep):
    with pytest.raises(UnknownName, match="did you mean settling_time"):
        simcompare.compare(sweep, "settling_tim")


# --- table --------------------------------------------------------------------------------------


def test_few_runs_stand_beside_each_other_level_by_level_above_the_truth(sweep):
    (table,) = tables.tables(compared(sweep), "restitution", 80)
    assert table.title == TITLE
    heads = ["engine", "drop_height = 0.3 m", "drop_height = 1 m", "drop_height = 2 m"]
    assert [column.head for column in table.columns] == heads
    assert [group.title for group in table.groups] == ["By default", "Tuned", "Assisted", "Truth"]
    cells = table.groups[2].rows[0]
    assert cells[0] == "pymunk"
    assert all(cell.endswith("✓") for cell in cells[1:])
    value, tolerance = table.groups[3].rows
    assert [float(cell) for cell in value[1:]] == [0.8] * 3
    assert tolerance == ("tolerance", "± 0.0016", "± 0.0016", "± 0.0016")


def test_twenty_runs_of_eight_engines_are_legible_on_80_columns(sweep):
    sources = [
        replace(one, name=f"{one.name}{i}") for i in range(8) for one in sweep[0].record.sources
    ]
    scores = [
        replace(one, source=f"{one.source}{i}") for i in range(8) for one in sweep[0].record.scores
    ]
    wide = changed(sweep[0], sources=tuple(sources), scores=tuple(scores))
    found = compared(many(wide, np.linspace(0.1, 2.0, 20)))
    shown = tables.tables(found, "restitution", 80)
    assert max(len(line) for table in shown for line in lines(table, 80)) <= 80
    heads = [column.head for table in shown for column in table.columns[1:]]
    assert sorted(heads) == sorted(f"pymunk{i}" for i in range(8) for _ in found.levels)
    assert {len(table.groups[0].rows) for table in shown} == {20}
    assert all(re.search(r"; truth 0\.80* ± 0\.0016$", table.title) for table in shown)


def test_a_run_without_an_engine_says_so(sweep):
    sources = tuple(replace(one, name="twin") for one in sweep[1].record.sources)
    (table,) = tables.tables(
        compared([sweep[0], changed(sweep[1], sources=sources)]), "restitution"
    )
    rows = dict((name, cells) for name, *cells in table.groups[0].rows)
    assert [len({*cells} & {"not run"}) for cells in rows.values()] == [1, 1]
    assert rows["pymunk"].index("not run") != rows["twin"].index("not run")


def test_what_did_not_run_is_told_once_with_its_reason(sweep):
    sources = tuple(
        replace(one, status="missing", reason="it is not installed")
        for one in sweep[1].record.sources
    )
    found = compared([sweep[0], changed(sweep[1], sources=sources)])
    (note,) = words.notes(found)
    assert found.sources == compared([sweep[0], sweep[2]]).sources
    assert note == "pymunk did not run (drop_height = 0.3 m): it is not installed"


def test_reasons_that_differ_from_run_to_run_are_told_by_the_first(sweep):
    def lost(run, reason):
        tuned = [replace(one, status="failed", reason=reason) if one.contact == "tuned" else one
                 for one in run.record.sources]  # fmt: skip
        return changed(run, sources=tuple(tuned))

    found = compared([lost(sweep[1], "pymunk: 3 is much"), lost(sweep[0], "4 is more"), sweep[2]])
    (note,) = words.notes(found)
    where = "(drop_height = 0.3 m; drop_height = 1 m); drop_height = 0.3 m"
    assert note == f"pymunk tuned did not run {where}: 3 is much"


def test_a_run_beyond_the_range_of_the_truth_is_not_judged_and_says_why(sweep):
    scores = tuple(
        replace(one, truth=None, tolerance=None, verdict="info") for one in sweep[1].record.scores
    )
    reason = "The ball is too fast."
    found = compared([sweep[0], changed(sweep[1], scores=scores, beyond=(reason,))])
    assert words.notes(found) == (f"Not judged (drop_height = 0.3 m): {reason}",)
    (table,) = tables.tables(found, "restitution")
    assert [row[1] for row in table.groups[-1].rows] == ["none", "none"]
    _, assisted = words.short(found, "restitution")
    assert assisted.endswith(": pymunk in 1 of 1 run.")


def test_the_answer_counts_runs_within_the_tolerance_level_by_level(sweep):
    tuned, assisted = words.short(compared(sweep), "restitution")
    assert tuned.startswith("Tuned, restitution within its tolerance: pymunk in ")
    assert assisted == "Assisted, restitution within its tolerance: pymunk in 3 of 3 runs."


def test_engines_of_one_run_alone_are_counted_in_that_run_and_come_last(sweep):
    def more(rows, field):
        others = ("ode", "dart", "rapier")
        return (*rows, *(replace(row, **{field: name}) for row in rows for name in others))

    first = sweep[0].record
    wide = changed(
        sweep[0], scores=more(first.scores, "source"), sources=more(first.sources, "name")
    )
    _, assisted = words.short(compared([wide, sweep[1]]), "restitution")
    assert assisted.endswith(": pymunk in 2 of 2 runs; the other 3 in 1 of 1 run.")


def test_the_page_begins_with_how_many_values_are_within_the_tolerance(sweep):
    found = compared(sweep)
    tuned, assisted = words.key_numbers(found, "restitution")
    assert (tuned.label, tuned.verdict) == ("tuned", "fail")
    assert (assisted.value, assisted.verdict) == ("3 of 3", "pass")
    assert words.finding(found, "settling_time").startswith("tuned ")
    assert words.key_numbers(found, "resolved_bounces") == ()
    assert words.finding(found, "resolved_bounces") == "not judged"


# --- figure -------------------------------------------------------------------------------------


def test_a_sweep_is_drawn_over_its_parameter_with_truth_and_tolerance(sweep):
    drawn = figure(compared(sweep), "restitution")
    assert drawn.title == "Restitution over drop_height"
    assert [panel.x_label for panel in drawn.panels] == ["drop_height (m)"] * 3
    truth, engine = drawn.panels[2].series
    assert (truth.label, engine.label) == ("truth ± tolerance", "pymunk")
    np.testing.assert_allclose(truth.y, 0.8)
    np.testing.assert_allclose(truth.u, 0.0016)
    np.testing.assert_allclose(engine.x, [0.3, 1.0, 2.0])
    ordered = (sweep[1], sweep[0], sweep[2])
    values = [score_of(run, "assisted", "restitution").value for run in ordered]
    np.testing.assert_array_equal(engine.y, values)


def test_where_the_truth_hides_deviations_these_are_drawn_as_well(sweep):
    found = compared(sweep)
    assert deviations(found, "restitution") is None, "its truth is the same everywhere"
    drawn = deviations(found, "settling_time")
    assert [panel.title for panel in drawn.panels] == [
        panel.title for panel in figure(found, "settling_time").panels[1:]
    ]
    truth, engine = drawn.panels[1].series
    assert set(truth.y) == {0.0}
    scores = [score_of(run, "assisted", "settling_time") for run in found.runs]
    np.testing.assert_allclose(engine.y, [score.value - score.truth for score in scores])
    assert [one.name for one in page.block_of(found, "settling_time").parts[0].figures] == [
        "compare-settling_time", "compare-settling_time-off"
    ]  # fmt: skip
    assert deviations(compared(sweep[:2]), "settling_time") is None, "two runs are no sweep"


def test_other_runs_are_drawn_in_rows_each_with_its_own_truth(sweep):
    drawn = figure(compared(sweep[:2]), "settling_time")
    panel = drawn.panels[1]
    assert panel.y_ticks == ("drop_height = 0.3 m", "drop_height = 1 m")
    lines_of_truth = [span for span in panel.spans if span.label == "truth"]
    assert [span.rows for span in lines_of_truth] == [(-0.5, 0.5), (0.5, 1.5)]
    assert lines_of_truth[0].low < lines_of_truth[1].low


def test_a_wide_sweep_has_a_logarithmic_axis(sweep):
    assert figure(compared(many(sweep[0], (0.1, 1.0, 10.0))), "restitution").panels[0].log_x


# --- Python and the command line ----------------------------------------------------------------


def test_runs_and_folders_are_compared_in_python(sweep, tmp_path):
    found = simcompare.compare([sweep[0], sweep[1].folder, str(sweep[2].folder)])
    table = found.table()
    assert [*table.columns] == [*found.compared.titles]
    assert table.loc[("Truth", "tolerance")].tolist() == ["± 0.0016"] * 3
    assert len(found.plot("penetration").axes) == 3
    html = found._repr_html_()
    assert "drop_height = 0.3 m" in html
    assert "data:image/png" in html
    assert repr(found).startswith("Bouncing ball: 3 runs that differ in drop_height")


def test_a_folder_of_runs_is_all_of_them_and_none_counts_twice(sweep):
    folder = sweep[0].folder.parent
    found = simcompare.compare([folder, sweep[0].folder, sweep[0]])
    assert len(found.compared.runs) == 3


def test_csv_holds_every_value_in_a_row(sweep, tmp_path):
    path = simcompare.compare(sweep).to_csv(tmp_path / "sweep.csv")
    table = pd.read_csv(path)
    assert [*table.columns] == [
        "run", "drop_height_m", "engine", "version", "contact", "measure", "unit", "value",
        "scatter", "u", "truth", "tolerance", "verdict",
    ]  # fmt: skip
    whole = [s for run in sweep for s in run.record.scores if s.index is None]
    assert len(table) == len(whole)
    assert set(table.drop_height_m) == {0.3, 1.0, 2.0}
    of = (table.drop_height_m == 2) & (table.contact == "tuned")
    row, score = (
        table[of & (table.measure == "restitution")],
        score_of(sweep[2], "tuned", "restitution"),
    )
    assert row[["value", "scatter", "truth", "verdict"]].values.tolist() == [
        [score.value, score.scatter, score.truth, score.verdict]
    ]


def test_the_command_prints_a_table_and_where_the_files_are(sweep, call, tmp_path):
    code, out, err = call("compare", sweep[0].folder.parent, "--csv", "a.csv", "-o", "a.html")
    assert code == 0, err
    assert f"\n{TITLE}\nengine" in out
    assert re.search(r"^  pymunk +0\.7\d+\(\d+\) [✓✗] .*\nAssisted$", out, re.MULTILINE)
    assert max(map(len, out.splitlines())) <= 80
    assert out.endswith("Table: a.csv\nPage: a.html\n")
    assert (tmp_path / "a.csv").is_file()
    assert "drop_height = 0.3 m" in (tmp_path / "a.html").read_text(encoding="utf-8")
    assert "✓ pass: " in out


def test_all_measures_and_one_of_them(sweep, call):
    folders = [run.folder for run in sweep]
    _, out, _ = call("compare", *folders, "--no-report", "--measure", "settling_time")
    assert "\nSettling time in s, mean of 3 repeats\n" in out
    _, out, _ = call("compare", *folders, "--no-report", "--measure", "all")
    for name in simcompare.compare(folders).measures:
        assert f"\n{name.replace('_', ' ').capitalize()}" in out


def test_json_is_one_object_with_every_row(sweep, call):
    _, out, _ = call("compare", sweep[0].folder.parent, "--no-report", "--json")
    data = json.loads(out)
    assert [run["drop_height_m"] for run in data["runs"]] == [0.3, 1.0, 2.0]
    assert {row["measure"] for row in data["rows"]} == set(data["measures"])
    assert data["page"] is None


def test_who_reads_no_line_of_it_has_the_page_too(sweep, tmp_path):
    page, folder = tmp_path / "page.html", sweep[0].folder.parent
    command = [sys.executable, "-m", "simcompare", "compare", str(folder), "-o", str(page)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        process.stdout.close()
    assert page.is_file()


@pytest.mark.parametrize("option", ["--csv", "-o"])
@pytest.mark.parametrize("name", ["run.json", "trajectories.parquet", "scores.csv", "notes.txt"])
def test_no_file_of_a_run_or_of_others_is_replaced(sweep, call, tmp_path, option, name):
    copy = shutil.copytree(sweep[0].folder, tmp_path / "run")
    (copy / "notes.txt").write_text("drop_height_m,engine\n", encoding="utf-8")
    before = (copy / name).read_bytes()
    code, _, err = call("compare", sweep[0].folder.parent, option, copy / name)
    assert code == 2
    assert (
        err == f"simcompare: {copy / name}: is another file, and is left as it is; choose"
        " another name\n"
    )
    assert (copy / name).read_bytes() == before


def test_table_and_page_of_another_comparison_are_replaced(sweep, call, tmp_path):
    words = ("compare", "--csv", "a.csv", "-o", "a.html")
    assert call(*words, *(run.folder for run in sweep))[0] == 0
    before = (tmp_path / "a.csv").read_text(encoding="utf-8")
    assert call(*words, *(run.folder for run in sweep[:2]))[0] == 0
    assert (tmp_path / "a.csv").read_text(encoding="utf-8") != before


def test_the_page_lies_beside_the_runs(sweep, call):
    _, out, _ = call("compare", sweep[0].folder.parent)
    assert out.endswith(f"Page: {sweep[0].folder.parent / 'comparison.html'}\n")


@pytest.mark.parametrize(
    ("place", "says"),
    [
        ("nowhere", "nowhere: there is no such file or folder"),
        ("empty", "empty: is not a stored run"),
    ],
)
def test_what_is_no_run_is_refused(call, tmp_path, place, says):
    (tmp_path / "empty").mkdir()
    code, _, err = call("compare", place)
    assert (code, says in err) == (2, True)
