"""Stored runs: listed one a line, and deleted only as far as they were listed and are ours."""

from __future__ import annotations

import io
import json
import re
import shutil
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare.errors import InputError
from simcompare.results import stored_runs
from simcompare.verbs.runs import runs, to_clean

NOW = datetime(2026, 6, 30, tzinfo=UTC)
FOREIGN = ("notes.txt", "run.json.bak", "figures/photo.png", "inner/run.json")


@pytest.fixture(scope="module")
def record(sweep):
    """The text of a run.json."""
    return (sweep[0].folder / "run.json").read_text(encoding="utf-8")


def store(folder: Path, record: str, created: str = "2026-06-29T00:00:00+00:00") -> Path:
    """The folder of a run that was made at a time."""
    folder.mkdir(parents=True)
    text = json.dumps({**json.loads(record), "created": created, "tables": {}})
    (folder / "run.json").write_text(text, encoding="utf-8")
    (folder / "scores.csv").write_text("source\n", encoding="utf-8")
    (folder / "figures").mkdir()
    (folder / "figures" / "ball-answer.png").write_bytes(b"png")
    return folder


def everything(folder: Path) -> set[Path]:
    return {path for path in folder.rglob("*") if path.is_symlink() or path.is_file()}


# --- the list -----------------------------------------------------------------------------------


def test_runs_are_listed_newest_first_one_line_each(sweep, call):
    code, out, _ = call("runs", sweep[0].folder.parent)
    head, _, *rows, end = out.splitlines()
    assert code == 0
    assert head.split() == ["run", "kind", "asked", "for", "engines", "verdict", "MB"]
    names = sorted((run.folder.name for run in sweep), reverse=True)
    assert [row.split()[0] for row in rows] == names
    assert "drop_height=2m" in rows[0]
    assert max(map(len, out.splitlines())) <= 80
    assert re.search(r"runs holds 3 runs, \d+\.\d MB$", end)


@pytest.mark.parametrize("columns", [20, 40, 60, 80, 200])
def test_nothing_is_cut_off_and_a_name_stays_on_its_line(sweep, call, monkeypatch, columns):
    monkeypatch.setenv("COLUMNS", str(columns))
    _, out, _ = call("runs", sweep[0].folder.parent)
    lines = out.splitlines()
    for run in sweep:
        assert any(line.split()[:1] == [run.folder.name] for line in lines)
    told = " ".join(out.split())
    assert told.count("pymunk") == 3
    assert "drop_height=0.3m" in told
    assert "…" not in out


def test_json_holds_what_the_lines_shorten(sweep, call):
    _, out, _ = call("runs", sweep[0].folder.parent, "--json")
    first = json.loads(out)["runs"][0]
    assert first["asked"] == ["drop_height=2m", "seeds 3"]
    assert first["scenario"], first["engines"] == ("ball", ["pymunk"])
    assert first["size_bytes"] == sum(p.stat().st_size for p in sweep[2].folder.iterdir())


def test_a_recording_is_named_without_its_folders_and_long_names_stay_whole(
    tmp_path, record, call, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "100")
    name = "20260629-120000-accelerometer_chirp"
    folder = store(tmp_path / "runs" / name, record)
    command = ["simcompare", "fit", "ball", "--recording", "/far/away/cork.wav", "--model", "auto"]
    sources = [{**json.loads(record)["sources"][0], "name": f"engine{i}"} for i in range(7)]
    text = {**json.loads(record), "command": command, "sources": sources}
    (folder / "run.json").write_text(json.dumps(text), encoding="utf-8")
    row = call("runs")[1].splitlines()[2]
    assert row.startswith(f"{name}  run   ball: cork")
    assert "7 engines" in row


def test_a_damaged_run_says_why(tmp_path, call):
    folder = tmp_path / "runs" / "20260601-120000-ball"
    folder.mkdir(parents=True)
    (folder / "run.json").write_text("{", encoding="utf-8")
    _, out, _ = call("runs")
    assert "damaged" in out
    assert "cannot be read" in out
    assert runs(folder.parent)[0].created == "2026-06-01T12:00:00+00:00"


def test_a_link_to_a_run_is_no_run(tmp_path, record):
    store(tmp_path / "elsewhere", record)
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "link").symlink_to(tmp_path / "elsewhere")
    assert runs(tmp_path / "runs") == []


def test_without_a_folder_and_without_runs(tmp_path, call):
    assert call("runs")[::2] == (
        2,
        "simcompare: runs: there is no such file or folder; expected a folder of stored runs\n",
    )
    (tmp_path / "runs").mkdir()
    assert call("runs")[1] == "runs holds no runs. Make one: simcompare run ball\n"


# --- the report of the newest ---------------------------------------------------------------------


def test_without_a_name_the_newest_run_is_reported(tmp_path, record, call):
    for day in (9, 8):
        store(
            tmp_path / "runs" / f"202606{day:02}-120000-ball",
            record,
            f"2026-06-{day:02}T12:00:00+00:00",
        )
    (tmp_path / "runs" / "20260610-120000-ball").mkdir()
    (tmp_path / "runs" / "20260610-120000-ball" / "run.json").write_text("{", encoding="utf-8")
    code, out, _ = call("report", "--format", "md")
    assert (code, out) == (0, "runs/20260609-120000-ball/report.md\n")


def test_without_a_name_and_without_runs(call):
    says = "simcompare: runs: holds no run; make one, such as: simcompare run ball\n"
    assert call("report") == (2, "", says)


# --- cleaning -----------------------------------------------------------------------------------


def test_clean_takes_what_is_old_and_not_among_the_newest(tmp_path, record):
    for day in (1, 10, 20, 29):
        store(tmp_path / f"d{day}", record, f"2026-06-{day:02}T00:00:00+00:00")

    def going(**how):
        return [run.folder.name for run in to_clean(runs(tmp_path), now=NOW, **how)]

    assert going(keep=1) == ["d20", "d10", "d1"]
    assert going(older_than="15d") == ["d10", "d1"]
    assert going(older_than="15d", keep=3) == ["d1"]
    assert going(keep=9) == []


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ({}, "say which runs go"),
        ({"older_than": "30"}, "30 has no unit; expected such as 30d"),
        ({"older_than": "-3d"}, "is no age"),
        ({"older_than": "3kg"}, "does not fit"),
        ({"keep": -1}, "expected 0 or more"),
    ],
)
def test_clean_says_what_makes_no_sense(how, says):
    with pytest.raises(InputError, match=says):
        to_clean([], **how)


def test_clean_lists_and_asks_first(tmp_path, record, call, monkeypatch):
    folder = store(tmp_path / "runs" / "one", record)
    for answer, is_left in (("n", True), ("y", False)):
        monkeypatch.setattr("typer.confirm", lambda *_, answer=answer, **__: answer == "y")
        code, _, err = call("runs", "--clean", "--keep", 0)
        assert code == 0
        assert "To delete in runs: 1 run, 0.1 MB, of 1 run, 0.1 MB" in err
        assert folder.exists() == is_left


@pytest.mark.parametrize(("words", "out"), [(["-q"], ""), (["--json"], '{"deleted": []}\n')])
def test_what_is_to_go_is_named_where_it_is_asked(tmp_path, record, call, monkeypatch, words, out):
    store(tmp_path / "runs" / "one", record)
    monkeypatch.setattr("typer.confirm", lambda *_, **__: False)
    code, told, err = call("runs", "--clean", "--keep", 0, *words)
    assert (code, told) == (0, out)
    assert err.index("one") < err.index("To delete in runs: 1 run")
    assert err.endswith("Nothing was deleted.\n")


def test_clean_deletes_nothing_where_nobody_can_be_asked(tmp_path, record, call, monkeypatch):
    folder = store(tmp_path / "runs" / "one", record)
    monkeypatch.setattr("sys.stdin", io.StringIO())
    code, _, err = call("runs", "--clean", "--keep", 0)
    assert code == 2
    assert err.endswith("\nsimcompare: --clean: nobody answered, nothing was deleted; add --yes\n")
    assert folder.exists()


def test_options_of_clean_do_nothing_alone(call):
    code, _, err = call("runs", "--keep", 3, "--yes")
    assert (code, err) == (2, "simcompare: --keep and --yes: deletes nothing without --clean\n")


def test_a_folder_with_files_of_others_is_kept_and_named(tmp_path, record, call):
    folder = store(tmp_path / "runs" / "one", record)
    (folder / "notes.txt").touch()
    _, out, _ = call("runs", "--clean", "--keep", 0, "--yes")
    assert "Kept: runs/one holds files that are not ours: notes.txt" in out
    assert len(everything(folder)) == 4


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"format": 2,', "cannot be read: it is cut off or damaged in line 1"),
        ('{"format": 9}', "a newer simcompare wrote it (format 9, known to 3); update simcompare"),
        (
            '{"format": 1, "scenario": "x.*", "sources": 1, "software": 2}',
            "field required, and more",
        ),
        ("[]", "holds a list, not an object"),
    ],
)
def test_what_cannot_be_read_is_kept_with_the_reason(tmp_path, record, call, text, says):
    folder = store(tmp_path / "runs" / "my ball", record)
    (folder / "run.json").write_text(text, encoding="utf-8")
    _, out, _ = call("runs", "--clean", "--keep", 0, "--yes")
    assert "Kept: runs/my ball: its run.json" in out
    assert says in " ".join(out.split())
    assert " ".join(out.split()).endswith("To delete it yourself: rm -r 'runs/my ball'")
    assert out.endswith("\n  rm -r 'runs/my ball'\n")
    assert len(everything(folder)) == 3


@st.composite
def folders(draw):
    """For each run: what lies beside our files, and how its run.json is damaged."""
    return draw(
        st.lists(
            st.tuples(
                st.sets(st.sampled_from((*FOREIGN, "link"))),
                st.sampled_from(("whole", "cut", "other", "wrong")),
            ),
            max_size=4,
        )
    )


DAMAGE = {
    "whole": lambda text: text,
    "cut": lambda text: text[:-9],
    "other": lambda text: '{"scenario": "ball"}',
    "wrong": lambda text: text.replace('"repeats": 3', '"repeats": "three"', 1),
}


@given(folders(), st.integers(0, 3))
def test_clean_deletes_exactly_what_it_listed(tmp_path_factory, record, layout, keep):
    base = tmp_path_factory.mktemp("clean")
    victim = store(base / "victim", record)
    for number, (others, damage) in enumerate(layout):
        folder = store(base / "runs" / str(number), record)
        path = folder / "run.json"
        path.write_text(DAMAGE[damage](path.read_text(encoding="utf-8")), encoding="utf-8")
        for name in others - {"link"}:
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).touch()
        if "link" in others:
            (folder / "scores.csv").unlink()
            (folder / "scores.csv").symlink_to(victim / "scores.csv")
    (base / "runs").mkdir(exist_ok=True)
    (base / "runs" / "linked").symlink_to(victim)
    before = everything(base)
    going = to_clean(runs(base / "runs"), keep=keep, now=NOW)
    stored_runs.delete(going)
    listed = {path for run in going for path in run.files}
    assert everything(base) == before - listed
    assert not any(run.folder.exists() for run in going)
    kept = {int(run.folder.name) for run in going}
    assert all(layout[i][0] == set() and layout[i][1] == "whole" for i in kept)
    shutil.rmtree(base)


def test_a_folder_that_became_a_link_is_left(tmp_path, record):
    folder, victim = store(tmp_path / "runs" / "one", record), store(tmp_path / "victim", record)
    going = runs(folder.parent)
    shutil.rmtree(folder)
    folder.symlink_to(victim)
    stored_runs.delete(going)
    assert len(everything(victim)) == 3
