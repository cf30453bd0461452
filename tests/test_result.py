"""What a run shows of itself in Python and in a notebook."""

import builtins
import csv
import inspect
import re
from dataclasses import replace

import pytest
from matplotlib.figure import Figure

import simcompare
from simcompare.cli import manner
from simcompare.cli import run as run_command
from simcompare.errors import InputError, UnknownName
from tests import records

#: bytes of what a notebook keeps of a run, the picture left out
MOST_BYTES = 20_000
PICTURE = re.compile(r'src="data:image/png;base64,[A-Za-z0-9+/=]+"')


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return simcompare.run("ball", engine="pymunk", seeds=3, out=tmp_path_factory.mktemp("runs"))


def test_a_run_is_a_few_lines_of_text(run):
    lines = repr(run).splitlines()
    assert len(lines) <= 8
    assert lines[0] == "Bouncing ball – run"
    assert str(run.folder) in lines[-1]


def test_a_notebook_shows_the_answer_the_table_and_one_figure(run):
    html = run._repr_html_()
    without = PICTURE.sub("", html)
    assert len(PICTURE.findall(html)) == html.count("<img") == 1
    assert len(without.encode()) < MOST_BYTES
    places = [
        without.index(part) for part in ("Bouncing ball", ">pymunk<", ">closed form<", "<img")
    ]
    assert places == sorted(places)
    assert re.search(r'0\.[78]\d+ <span style="color:#2a9d4a">pass</span>', without)


def test_a_notebook_needs_no_network(run):
    assert not re.search(r"https?:|<script|<link", run._repr_html_())


def test_texts_of_files_are_no_markup(run):
    html = records.changed(run, title="<b>$x$</b>")._repr_html_()
    assert "&lt;b&gt;$x$&lt;/b&gt;" in html


def test_what_did_not_run_says_why(run):
    missing = records.with_source(run, 0, status="missing", reason="pymunk is not installed")
    assert "pymunk (by default) did not run: pymunk is not installed" in repr(missing)
    assert "did not run: pymunk is not installed" in missing._repr_html_()


def test_what_a_run_was_held_against_and_its_cautions_are_told():
    run = simcompare.run(
        "ball", preset="table_tennis", against="jena_2021_table_tennis", engine="pymunk", seeds=1
    )
    run = records.changed(run, cautions=("the fit is of another ball",))
    assert "measurement" in repr(run)
    assert "takes its value from this same table" in run._repr_html_()
    assert "Caution: the fit is of another ball" in repr(run)
    assert isinstance(run.plot("measured-restitution"), Figure)


def test_a_caution_of_a_run_is_told_once_however_much_is_asked_for(run, monkeypatch, capsys):
    cautioned = records.changed(run, cautions=("the fit is of another ball",))
    for verbose in (False, True):
        monkeypatch.setattr(manner, "is_verbose", lambda verbose=verbose: verbose)
        run_command._show(cautioned, None, details=False)
        assert capsys.readouterr().out.count("Caution: the fit is of another ball") == 1


def test_the_table_has_a_row_for_each_engine_and_a_column_for_each_level(run):
    table = run.table()
    assert [*table.index] == ["pymunk", "closed form"]
    assert [*table.columns] == ["default", "tuned", "assisted"]
    assert float(table.loc["closed form", "assisted"]) == 0.8
    assert table.loc["pymunk", "assisted"].endswith(" pass")
    assert run.table("settling_time").attrs["title"].startswith("settling time in s")


def test_a_measure_that_is_not_there_names_those_that_are(run):
    with pytest.raises(UnknownName, match="did you mean restitution"):
        run.table("restitutoin")


def test_scores_are_those_of_the_file(run):
    with (run.folder / "scores.csv").open(encoding="utf-8") as file:
        rows = [*csv.DictReader(file)]
    assert [*run.scores.columns] == [*rows[0]]
    assert [*run.scores["measure"]] == [row["measure"] for row in rows]
    assert run.scores["index"].dropna().min() == 1


def test_samples_are_taken_by_engine_and_level(run):
    samples = run.samples("pymunk", "tuned")
    assert samples["height_m"].iloc[0] == pytest.approx(1)
    assert set(samples["contact"]) == {"tuned"}
    assert samples["time_s"].is_monotonic_increasing
    assert {*run.samples()["source"]} == {"pymunk", "closed form"}
    first, middle = run.samples("pymunk", "tuned", 0), run.samples("pymunk", "tuned", 1)
    assert first["height_m"].iloc[0] < middle["height_m"].iloc[0]
    assert samples.equals(middle)


@pytest.mark.parametrize(
    ("asked", "cure"),
    [
        (("pymuk",), "did you mean pymunk"),
        (("pymunk", "tunde"), "did you mean tuned"),
        (("pymunk", "tuned", 3), "there is no repeat 3; expected from 0 to 2"),
    ],
)
def test_samples_that_are_not_there_name_those_that_are(run, asked, cure):
    with pytest.raises(simcompare.SimcompareError, match=cure):
        run.samples(*asked)


def test_samples_of_what_did_not_run_say_why(run):
    missing = records.with_source(run, 0, status="missing", reason="pymunk is not installed")
    with pytest.raises(InputError, match="pymunk, default: pymunk is not installed"):
        replace(missing, trajectories=()).samples("pymunk", "default")


@pytest.mark.parametrize("name", [None, "answer", "height_m", "events-restitution"])
def test_figures_are_those_of_the_report(run, name):
    figure = run.plot(name)
    assert isinstance(figure, Figure)
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_a_figure_that_is_not_there_names_those_that_are(run):
    with pytest.raises(UnknownName, match="did you mean height_m"):
        run.plot("hight_m")


def test_passed_is_exit_code_zero(run):
    assert run.passed
    failed = records.changed(
        run, scores=tuple(replace(score, verdict="fail") for score in run.record.scores)
    )
    assert not failed.passed


def test_a_report_lies_beside_the_run(run, tmp_path):
    assert run.report() == run.folder / "report.html"
    assert simcompare.report(str(run.folder), format="md") == run.folder / "report.md"
    figures = simcompare.report([run, run.folder], format="svg", out=tmp_path)
    assert len([*figures.glob("*.svg")]) > 2


def test_a_report_of_a_run_that_is_not_stored_lies_here(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    replace(run, folder=None).report(format="md")
    assert (tmp_path / "ball-report.md").is_file()


def test_a_report_of_nothing_is_refused():
    with pytest.raises(InputError, match="expected at least one"):
        simcompare.report([])
    with pytest.raises(UnknownName, match="did you mean html"):
        simcompare.report([], format="htm")


def test_a_stored_run_is_read_from_text_a_path_or_its_file(run):
    for place in (run.folder, str(run.folder), run.folder / "run.json"):
        assert simcompare.load_run(place).record == run.record
        assert simcompare.load_run(place).table().equals(run.table())


def test_the_package_shows_what_people_use_and_no_more():
    shown = [name for name in dir(simcompare) if not name.startswith("__")]
    assert shown == sorted(simcompare._PUBLIC)


@pytest.mark.parametrize("name", sorted(simcompare._PUBLIC))
def test_what_people_use_says_what_it_is_and_functions_give_an_example(name):
    found = getattr(simcompare, name)
    assert found.__doc__
    if inspect.isfunction(found):
        _, example = found.__doc__.split("::\n\n", 1)
        assert example.count("simcompare.") >= 1


def test_importing_everything_hides_no_name_of_python():
    assert not set(simcompare.__all__) & set(dir(builtins))


def test_list_shows_what_simcompare_list_prints():
    listed = simcompare.list()
    assert "ball" in listed.table().index
    assert "pymunk" in listed.engines
    assert "Scenarios:" in repr(listed)
    assert ">ball<" in listed._repr_html_()
    assert len(listed._repr_html_().encode()) < MOST_BYTES


def test_show_shows_the_parameters_and_which_engines_can():
    facts = simcompare.show("ball")
    assert facts.table().loc["drop_height_m", "value"] == "1"
    assert "drop_height_m = 1 m" in repr(facts)
    shown = facts._repr_html_()
    assert "pymunk" in shown
    assert len(PICTURE.sub("", shown).encode()) < MOST_BYTES


@pytest.fixture(scope="module")
def tuned():
    return simcompare.tune(restitution=0.8, engine="pymunk", speed="1..4")


def test_answers_of_tune_are_a_table_and_a_figure(tuned):
    assert [*tuned.table().index] == ["pymunk"]
    assert tuned.table().loc["pymunk", "type in"].startswith("elasticity")
    assert "holds in pymunk." in repr(tuned)
    assert "<img" in tuned._repr_html_()
    assert isinstance(tuned.plot(), Figure)


def test_answers_of_tune_at_one_speed_are_no_figure():
    tuned = simcompare.tune(restitution=0.8, engine="pymunk", speed="2")
    assert "<img" not in tuned._repr_html_()
    with pytest.raises(InputError, match=r'speed="0.5..4"'):
        tuned.plot()


def test_answers_of_tune_say_why_there_is_none(tuned):
    failed = replace(tuned[0], statement=None, status="failed", reason="it fell apart")
    table = type(tuned)([failed]).table()
    assert table.loc["pymunk", "what to know"] == "it fell apart"


def test_a_characterization_shows_its_first_experiment():
    found = simcompare.characterize("friction", engine="pymunk", contact="tuned")
    assert found.table().equals(found.table("friction"))
    assert found._repr_html_().count("<img") == 1
    assert isinstance(found.plot(), Figure)
    with pytest.raises(UnknownName, match="experiment that was done"):
        found.table("bounce")


def test_a_controlled_trajectory_shows_its_probes():
    found = simcompare.control("pendulum_torque", lambda time_s, readings: {}, engine="pymunk")
    assert found.table().loc["angle_rad", "start"] == "0"
    assert [*found.samples()][:2] == ["time_s", "angle_rad"]
    assert "controlled in pymunk" in found._repr_html_()
    assert isinstance(found.plot("hinge.rate_rad_s"), Figure)
    with pytest.raises(UnknownName, match="did you mean angle_rad"):
        found.plot("angel_rad")
    assert len(repr(found)) < 300


def test_stored_runs_are_a_table(run):
    found = simcompare.runs(run.folder.parent)
    assert [*found.table().index] == [run.folder.name]
    assert found.table().loc[run.folder.name, "engines"] == "pymunk"
    assert repr(found[0]) == f"{run.folder}: pass"
    assert len(found._repr_html_().encode()) < MOST_BYTES
