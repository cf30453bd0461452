"""Runs on disk: what is read is what was written, and nothing is ever half-written."""

from __future__ import annotations

import errno
import json
import shutil
import subprocess
import sys
import textwrap
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import simcompare
from simcompare.comparison.comparison import Score
from simcompare.errors import InputError, OutputError
from simcompare.model import plain as json_of
from simcompare.model.plain import plain
from simcompare.model.trajectory import Trajectory
from simcompare.results import store
from simcompare.results.records import stored as records
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.run import FORMAT, RunRecord
from simcompare.results.records.validation import ValidationRecord
from simcompare.results.run import Run, Stored
from tests import validations
from tests.test_fitting import stopwatch


@pytest.fixture
def made(add_engine, fall):
    """A run that is not stored."""
    add_engine("toy")
    return simcompare.run(str(fall), engine="toy")


def synthetic():
    """A run with everything that storing could lose."""
    rng = np.random.default_rng(0)
    t = np.arange(50, dtype=np.float64) * np.float64(1e-3)
    signals = {"ball.position_m": rng.normal(size=(50, 3)), "wheel.rate_rad_s": rng.normal(size=50)}
    first = Trajectory("toy", t, signals, contact="assisted")
    second = Trajectory(
        "toy", t[:20], {"ball.orientation_wxyz": rng.normal(size=(20, 4))}, contact="default"
    )
    truth = Trajectory("closed form", t, {"ball.position_m": rng.normal(size=(50, 3)) * 1e-300})
    scores = (
        Score("toy", "assisted", "restitution", "h", None, 0.1 + 0.2, 1e-17, 1e-17 / 3, "1", 9,
              0.8, 0.002, "fail"),
        Score("toy", "assisted", "rebound, height", "h", 3, None, None, None, "m", 9,
              None, None, "info"),
    )  # fmt: skip
    record = {
        "kind": "run",
        "format": FORMAT,
        "title": "Ball",
        "question": "Does it bounce?",
        "parameters": {},
        "step_s": 0.001,
        "duration_s": 0.05,
        "repeats": 2,
        "software": {"simcompare": "0", "python": "3", "numpy": "2"},
        "machine": {"system": "Linux", "processor": "", "python_implementation": "cpython"},
        "created": "2026-01-02T03:04:05+00:00",
        "scenario": "ball",
        "sources": [
            {"name": "toy", "contact": "assisted", "status": "ok", "noise": "Höhe\n\u2028"}
        ],
        "engines_asked": "toy",
        "interrupted": True,
        "scores": [vars(score) for score in scores],
    }
    stored = (
        Stored("toy", "assisted", 0, first),
        Stored("toy", "assisted", 1, first),
        Stored("toy", "default", 0, second),
        Stored("closed form", "", 0, truth),
    )
    return Run(records.of_plain(record), stored)


def assert_same(back, run):
    assert back.record.scores == run.record.scores
    assert back.record == replace(run.record, run=back.record.run, tables=back.record.tables)
    assert len(back.trajectories) == len(run.trajectories)
    for ours, theirs in zip(back.trajectories, run.trajectories, strict=True):
        assert replace(ours, trajectory=None) == replace(theirs, trajectory=None)
        assert np.array_equal(ours.trajectory.time_s, theirs.trajectory.time_s)
        assert set(ours.trajectory.signals) == set(theirs.trajectory.signals)
        for name, values in theirs.trajectory.signals.items():
            assert np.array_equal(ours.trajectory.signals[name], values), name


def test_what_is_read_is_what_was_written_to_the_last_bit(tmp_path):
    run = synthetic()
    saved = store.save(run, tmp_path / "runs")
    assert saved.folder is not None
    assert saved.record.run == str(saved.folder)
    assert_same(store.load(saved.folder), run)
    assert simcompare.load_run(saved.folder).exit_code == 1
    assert sorted(p.name for p in saved.folder.iterdir()) == [
        "run.json",
        "scores.csv",
        "trajectories.parquet",
    ]


def test_a_folder_may_be_called_as_a_pattern_of_files_is(tmp_path):
    run = synthetic()
    (tmp_path / "runs b").mkdir()  # what the pattern would find
    saved = store.save(run, tmp_path / "it's runs [ab]?*")
    assert saved.folder is not None
    assert_same(store.load(saved.folder), run)


def test_a_run_of_an_engine_is_read_back_too(made, tmp_path):
    saved = store.save(made, tmp_path)
    assert saved.folder is not None
    assert_same(store.load(saved.folder), made)


def test_two_runs_in_one_second_have_folders_of_their_own(tmp_path):
    run = synthetic()
    folders = [store.save(run, tmp_path).folder for _ in range(3)]
    assert len(set(folders)) == 3


def test_runs_stored_at_the_same_time_do_not_harm_each_other(tmp_path):
    """As when a shell loop starts several commands in one folder."""
    run, start = synthetic(), threading.Barrier(8)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)  # the threads take turns as often as processes would

    def twice(_):
        start.wait()
        return [store.save(run, tmp_path) for _ in range(2)]

    try:
        with ThreadPoolExecutor(8) as pool:
            saved = [each for two in pool.map(twice, range(8)) for each in two]
    finally:
        sys.setswitchinterval(interval)
    assert len({run.folder for run in saved}) == 16
    for each in saved:
        assert each.folder is not None
        assert_same(store.load(each.folder), run)
    assert len(list(tmp_path.iterdir())) == 16


def test_what_another_process_is_writing_is_left_alone(tmp_path, monkeypatch):
    """Another command takes the same identifier between our look and our making of the folder."""
    theirs: list[Path] = []
    make = Path.mkdir

    def mkdir(self, *args, **more):
        if not theirs and self.parent == tmp_path:
            make(self, parents=True)
            (self / "run.json").write_text("theirs")
            theirs.append(self)
        make(self, *args, **more)

    monkeypatch.setattr(Path, "mkdir", mkdir)
    saved = store.save(synthetic(), tmp_path)
    assert (theirs[0] / "run.json").read_text() == "theirs"
    assert saved.folder is not None
    assert saved.folder.is_dir()


def test_odd_folder_names_are_no_trouble(tmp_path):
    saved = store.save(synthetic(), tmp_path / 'it\'s a "run" [*?] é')
    assert saved.folder is not None
    assert len(store.load(saved.folder).trajectories) == 4


def test_a_place_that_cannot_be_written_is_told_before_and_after(tmp_path, fall):
    (tmp_path / "file").write_text("x")
    out = tmp_path / "file" / "runs"
    with pytest.raises(OutputError, match="another --out"):
        store.save(synthetic(), out)
    with pytest.raises(OutputError, match="another"):
        simcompare.run(str(fall), engine="pymunk", out=out)
    assert (tmp_path / "file").read_text() == "x"


@pytest.mark.parametrize(
    ("module", "part"),
    [(json_of, "text"), (store, "_write_scores"), (store, "_write_trajectories")],
)
def test_a_full_disk_leaves_nothing(tmp_path, monkeypatch, module, part):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(module, part, full)
    with pytest.raises(OutputError, match="No space left on device"):
        store.save(synthetic(), tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("limit", [500, 3000])
def test_a_write_that_fails_halfway_leaves_nothing(tmp_path, limit):
    """The system itself refuses: files may not be larger than ``limit`` bytes."""
    pytest.importorskip("resource")
    code = f"""
    import resource, sys
    from pathlib import Path
    from simcompare.results import store
    from simcompare.errors import OutputError
    from tests.test_store import synthetic
    run = synthetic()
    resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
    try:
        store.save(run, Path({str(tmp_path)!r}))
    except OutputError as error:
        print("told:", error)
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        capture_output=True,
        text=True,
        check=False,
        cwd=Path(__file__).parent.parent,
    )
    assert done.stdout.startswith("told:"), done.stdout + done.stderr
    assert "nothing was kept" in done.stdout
    assert list(tmp_path.iterdir()) == []


def as_json():
    """A record as JSON holds it."""
    return plain(synthetic().record)


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "null", "{}", '{"scores": 3}', "\0\0\0"])
def test_a_file_that_holds_no_record_is_told(tmp_path, text):
    (tmp_path / "run.json").write_text(text)
    with pytest.raises(InputError, match=r"run\.json"):
        store.load(tmp_path)


@pytest.mark.parametrize("form", [1, 2, FORMAT])
@pytest.mark.parametrize(
    ("path", "value", "fault"),
    [
        ("created", ..., "created: field required"),
        ("step_s", "soon", "step_s: input should be a valid number"),
        ("scores", 3, "scores: input should be a valid tuple"),
        ("scores.1", 3, "scores.1: input should be a dictionary or an instance of Score"),
        ("scores.1.measure", ..., "scores.1.measure: field required"),
        ("scores.0.u", "wide", "scores.0.u: input should be a valid number"),
        ("scores.0.repeats", "few", "scores.0.repeats: input should be a valid integer"),
        ("sources", None, "sources: input should be a valid tuple"),
        ("sources.0.contact", [], "sources.0.contact: input should be a valid string"),
        ("software.python", ..., "software.python: field required"),
        ("against", 3, "against: input should be a dictionary or an instance of Measurement"),
        ("against", {"matches": [3]}, "against.file: field required"),
    ],
)
def test_a_damaged_record_is_told_with_its_place(tmp_path, form, path, value, fault):
    record = json.loads(json.dumps(as_json() | {"format": form}))
    *way, last = (int(step) if step.isdecimal() else step for step in path.split("."))
    part = record
    for step in way:
        part = part[step]
    if value is ...:
        del part[last]
    else:
        part[last] = value
    (tmp_path / "run.json").write_text(json.dumps(record))
    with pytest.raises(InputError) as told:
        store.load(tmp_path)
    assert told.value.where == str(tmp_path / "run.json")
    assert any(one.lower().startswith(f"cannot be read: {fault.lower()}")
               for one in told.value.faults)  # fmt: skip


def test_of_many_faults_the_first_are_told(tmp_path):
    (tmp_path / "run.json").write_text(json.dumps({"format": FORMAT, "kind": "run"}))
    with pytest.raises(InputError) as told:
        store.load(tmp_path)
    *first, last = told.value.faults
    assert len(first) == 5
    assert last == "7 more such faults"


def test_a_record_of_a_newer_simcompare_is_told_as_such(tmp_path):
    (tmp_path / "run.json").write_text(json.dumps(as_json() | {"format": FORMAT + 1}))
    says = rf"a newer simcompare wrote it \(format {FORMAT + 1}, known to {FORMAT}\); update"
    with pytest.raises(InputError, match=says):
        store.load(tmp_path)


@pytest.mark.parametrize("form", [0, "1", None, [1]])
def test_a_record_of_another_format_is_told(tmp_path, form):
    (tmp_path / "run.json").write_text(json.dumps(as_json() | {"format": form}))
    with pytest.raises(InputError) as told:
        store.load(tmp_path)
    assert told.value.faults == (f"format {form!r} is not known; expected 1 or 2 or {FORMAT}",)


@pytest.mark.parametrize("kind", ["walk", None, []])
def test_a_record_of_another_kind_is_told(tmp_path, kind):
    (tmp_path / "run.json").write_text(json.dumps(as_json() | {"kind": kind}))
    with pytest.raises(InputError) as told:
        store.load(tmp_path)
    assert told.value.faults == (f"kind {kind!r} is not known; expected run or fit or validation",)


def of_the_first_format(**more):
    """A record as version 0.1 wrote it: of no kind, with fewer fields, u being the scatter."""
    row = {"source": "toy", "contact": "mapped", "measure": "restitution", "probe": "h",
           "index": None, "value": 0.8, "u": 0.003, "unit": "1", "repeats": 9, "truth": 0.8,
           "tolerance": 0.008, "verdict": "pass", "low": 0.79, "high": 0.81}  # fmt: skip
    keys = ("created", "scenario", "title", "question", "parameters", "step_s", "duration_s",
            "repeats", "software", "machine", "engines_asked")  # fmt: skip
    source = {"name": "toy", "contact": "mapped", "status": "ok", "repeats": 9,
              "known_limits": [{"text": "No joints.", "reference": "its manual"}]}  # fmt: skip
    today = as_json()
    return {"format": 1, **{key: today[key] for key in keys}, "sources": [source], "scores": [row],
            "interrupted": False, **more}  # fmt: skip


def read(folder, record):
    (folder / "run.json").write_text(json.dumps(record))
    return store.load(folder).record


def test_a_run_of_the_first_format_is_read(tmp_path):
    match = {"source": "toy", "contact": "mapped", "quantity": "rebound_height", "bounce": 1,
             "value": 0.65, "u": 0.003, "measured": 0.64, "u_measured": 0.004, "low": None,
             "high": None, "unit": "m", "e_n": 1.0, "inside": True}  # fmt: skip
    against = {"file": "ball.csv", "sha256": "0", "head": {"title": "A ball"}, "parameters": {},
               "caution": None, "matches": [match]}  # fmt: skip
    record = read(tmp_path, of_the_first_format(against=against, against_asked="ball.csv"))
    assert isinstance(record, RunRecord)
    assert (record.kind, record.format) == ("run", FORMAT)
    (score,), (source,) = record.scores, record.sources
    assert (score.scatter, score.u) == (0.003, pytest.approx(0.001))
    assert (score.contact, source.contact) == ("assisted", "assisted")
    assert (source.engine, source.engine_step_s) == (None, None)
    (found,) = record.against.matches
    assert (found.contact, found.scatter) == ("assisted", 0.003)


def old_fit(folder):
    """What version 0.1 stored of a fit of bounces: no kind, and fewer facts."""
    drop = stopwatch(folder / "drop.csv")
    found = plain(simcompare.fit("ball", recordings=[drop], engine="pymunk").record.fit)
    del found["by"], found["closed_form"]["u_known"], found["closed_form"]["scattered"]
    for row in found["choice"]["candidates"]:
        del row["law"], row["drag"]
    for row in found["other_estimates"]:
        del row["rule"], row["trend"], row["u_trend"]
        row |= {"starts": 12, "reached": 7}
    return found


@pytest.mark.parametrize(
    ("kind", "record_type"), [("fit", FitRecord), ("validation", ValidationRecord)]
)
def test_a_fit_and_a_validation_of_the_first_format_are_read(tmp_path, kind, record_type):
    found = old_fit(tmp_path) if kind == "fit" else plain(validations.record())
    more = {kind: found, "recording_asked": ["drop.csv"]}
    record = read(tmp_path, of_the_first_format(**more))
    assert isinstance(record, record_type)
    assert record.kind == kind
    assert record.recording_asked == ("drop.csv",)
    (score,) = record.scores
    assert (score.scatter, score.u) == (None, 0.003), "it was that of the value, not of repeats"
    assert (score.truth, score.measured) == ((0.8, None) if kind == "fit" else (None, 0.8))


def test_what_is_read_of_the_first_format_is_stored_in_that_of_today(tmp_path):
    (tmp_path / "run.json").write_text(json.dumps(of_the_first_format()))
    old = store.load(tmp_path)
    saved = store.save(old, tmp_path / "runs")
    assert json.loads((saved.folder / "run.json").read_text())["format"] == FORMAT
    assert_same(store.load(saved.folder), old)


@pytest.mark.parametrize("damage", ["cut", "empty", "other", "noise"])
def test_damaged_trajectories_are_told(tmp_path, damage):
    saved = store.save(synthetic(), tmp_path)
    assert saved.folder is not None
    path = saved.folder / "trajectories.parquet"
    raw = path.read_bytes()
    if damage == "other":
        import duckdb

        path.unlink()
        duckdb.sql(f"copy (select 1 as x) to '{path}' (format parquet)")
    else:
        new = {"cut": raw[: len(raw) // 2], "empty": b"", "noise": b"PAR1" + bytes(64) + b"PAR1"}
        path.write_bytes(new[damage])
    with pytest.raises(InputError, match=r"trajectories\.parquet"):
        store.load(saved.folder)


def test_a_folder_without_a_run_is_told(tmp_path):
    with pytest.raises(InputError, match="not a stored run"):
        store.load(tmp_path)
    with pytest.raises(InputError, match="no such file or folder; expected the folder of a stored"):
        store.load(tmp_path / "nope")


def test_no_half_written_run_is_seen_as_a_run(tmp_path):
    """A process that was killed leaves at most a hidden folder, which no later run trips over."""
    saved = store.save(synthetic(), tmp_path)
    assert saved.folder is not None
    partial = tmp_path / f".{saved.folder.name}.partial"
    shutil.move(saved.folder, partial)
    again = store.save(synthetic(), tmp_path)
    assert again.folder is not None
    assert [p for p in tmp_path.iterdir() if not p.name.startswith(".")] == [again.folder]


@pytest.mark.parametrize(
    "text",
    ["[" * 200_000, '{"format": 2, "step_s": NaN}', '{"format": true}'],
    ids=("nested", "nan", "true"),
)
def test_what_is_no_json_of_ours_is_refused(tmp_path, text):
    (tmp_path / "run.json").write_text(text)
    with pytest.raises(InputError, match=r"run\.json: "):
        store.load(tmp_path)
