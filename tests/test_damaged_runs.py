"""Stored runs that were changed or are damaged: one sentence that names the file."""

from __future__ import annotations

import json
import shutil

import duckdb
import pytest

import simcompare
from simcompare.errors import InputError


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """A small run and its files' content."""
    folder = tmp_path_factory.mktemp("runs")
    run = simcompare.run("ball", engine="pymunk", contact="default", seeds=2, out=folder)
    record, samples = run.folder / "run.json", run.folder / "trajectories.parquet"
    return run.folder, record.read_bytes(), samples.read_bytes()


@pytest.fixture
def run(stored):
    """The folder of the run; it is whole again afterwards."""
    folder, record, samples = stored
    yield folder
    (folder / "run.json").write_bytes(record)
    (folder / "trajectories.parquet").write_bytes(samples)


def without_digests(folder):
    """Makes the record of a run one of an older simcompare, which told nothing of its tables."""
    path = folder / "run.json"
    record = json.loads(path.read_text(encoding="utf-8"))
    path.write_text(json.dumps({**record, "format": 2, "tables": {}}), encoding="utf-8")


def edit(folder, query):
    """Puts what a query gives of the samples in their place, and says that nobody knows."""
    without_digests(folder)
    path = folder / "trajectories.parquet"
    changed = folder / "changed.parquet"
    with duckdb.connect() as connection:
        connection.execute(f"create table old as from '{path}'")
        connection.execute(f"copy ({query}) to '{changed}' (format parquet)")
    changed.replace(path)


SIGNAL = '"ball.position_m.x"'


@pytest.mark.parametrize(
    ("query", "words"),
    [
        ("from old where false", "is damaged: it holds no samples"),
        ("select * replace ('x' as time_s) from old", "its column time_s holds no numbers"),
        ("select * replace ([1.0] as time_s) from old", "its column time_s holds no numbers"),
        (
            f"select * replace ('x' as {SIGNAL}) from old",
            "ball.position_m.x holds no numbers",
        ),
        (f"select * replace ([1.0] as {SIGNAL}) from old", "ball.position_m.x holds no numbers"),
        ("select * replace ('a' as repeat) from old", "its column repeat holds no numbers"),
        ("select * replace (null::double as time_s) from old", "a time is missing"),
        ("select * replace (0.0 as time_s) from old", "is damaged at pymunk, default"),
        ("from old order by time_s", "the samples of a source do not stand together"),
        ("select * exclude (time_s) from old", "is not of a run: it has no column time_s"),
        ("select * exclude (source) from old", "is not of a run: it has no column source"),
    ],
)
def test_samples_that_are_none_are_told_with_the_file(run, query, words):
    edit(run, query)
    with pytest.raises(InputError) as caught:
        simcompare.load_run(run)
    assert str(run / "trajectories.parquet") in str(caught.value)
    assert words in str(caught.value)


@pytest.mark.parametrize("part", [0, 1, 4, 1000])
@pytest.mark.parametrize("is_old", [False, True])
def test_samples_that_are_cut_are_told(run, part, is_old):
    path = run / "trajectories.parquet"
    path.write_bytes(path.read_bytes()[:part])
    fault = "is not what was written: it is cut off, damaged or changed"
    if is_old:
        without_digests(run)
        fault = "cannot be read: it is cut off or damaged"
    with pytest.raises(InputError, match=rf"trajectories\.parquet: {fault}; run it again: simc"):
        simcompare.load_run(run)


def test_samples_of_another_run_are_told(run, tmp_path):
    other = simcompare.run("ball", engine="pymunk", contact="default", seeds=1, out=tmp_path)
    shutil.copy(other.folder / "trajectories.parquet", run)
    with pytest.raises(InputError, match=r"trajectories\.parquet: is not what was written"):
        simcompare.load_run(run)


def test_samples_that_are_gone_are_told(run):
    (run / "trajectories.parquet").unlink()
    with pytest.raises(InputError, match=r"trajectories\.parquet: cannot be read: No such file"):
        simcompare.load_run(run)


def test_a_record_that_is_cut_says_where(run):
    path = run / "run.json"
    path.write_text("".join(path.read_text(encoding="utf-8").splitlines(keepends=True)[:3])[:-9])
    says = r"run\.json: cannot be read: it is cut off or damaged in line 3; run it again$"
    with pytest.raises(InputError, match=says):
        simcompare.load_run(run)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda tree: tree["scores"][0].update(verdict="maybe"), "no report can be made of it"),
        (lambda tree: tree.update(kind="fit"), "run.json"),
        (lambda tree: tree.update(scores={}), "run.json"),
        (lambda tree: tree["scores"][0].update(value="high"), "run.json"),
        (lambda tree: tree["scores"][0].update(value=[1.0]), "run.json"),
        (lambda tree: tree.pop("sources"), "run.json"),
        (lambda tree: tree.update(sources=None), "run.json"),
    ],
)
@pytest.mark.parametrize("format", ["html", "md"])
def test_a_record_whose_parts_do_not_belong_together_is_told(
    call, run, tmp_path, change, words, format
):
    tree = json.loads((run / "run.json").read_text(encoding="utf-8"))
    change(tree)
    (run / "run.json").write_text(json.dumps(tree), encoding="utf-8")
    code, out, err = call("report", str(run), "--format", format, "--out", str(tmp_path / "r"))
    assert (code, out) == (2, "")
    assert str(run) in err
    assert words in err
    assert "Traceback" not in err


def test_a_fault_of_our_own_is_none_of_a_run_that_was_not_stored(monkeypatch, tmp_path):
    from simcompare.reports import builder

    def breaks(*_):
        raise KeyError("our own")

    run = simcompare.run("ball", engine="pymunk", contact="default", seeds=1)
    monkeypatch.setattr(builder, "write_markdown", breaks)
    with pytest.raises(KeyError):
        simcompare.report(run, format="md", out=tmp_path / "r.md")


@pytest.mark.parametrize(
    "words",
    [
        ("report", "x", "--out", ""), ("report", "x", "--out="), ("run", "ball", "--out", ""),
        ("run", "ball", "-o", ""), ("import", "x.csv", "--map", ""), ("export", "ball", "--out="),
        ("run", "ball", "--engine", ""), ("run", "ball", "--step", ""), ("fit", "ball", "-r", ""),
        ("validate", "pendulum", "--recording="), ("tune", "ball", "--step", ""),
    ],
    ids=" ".join,
)  # fmt: skip
def test_an_option_with_nothing_behind_it_is_told(call, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    option = next(word for word in words if word.startswith("-")).rstrip("=")
    assert f"simcompare: {option}: is empty; give a value, or leave it out" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("run", "ball", "--seeds", "nine"), "--seeds: 'nine' is no number here; expected a whole"),
        (
            ("run", "ball", "--seeds=1.5"),
            "--seeds: '1.5' is no number here; expected a whole number",
        ),
        (
            ("run", "ball", "--time-limit", "0,5"),
            "--time-limit: '0,5' is no number here; write 0.5",
        ),
        (
            ("fit", "ball", "-r", "x", "--time-limit", "5s"),
            "'5s' is no number here; expected a num",
        ),
    ],
)
def test_an_option_that_takes_a_number_says_what_it_found(call, words, sentence):
    code, out, err = call(*words)
    assert (code, out) == (2, "")
    assert sentence in err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("fit", "pendulum", "-r", "pendulum_free_swing", "--prior", "length=1m:1mm"),
         "--prior: pendulum is fitted by waveform, which this is not for"),
        (("fit", "cube_toss", "-r", "cube_toss", "--prior", "friction=0.2:0.1"),
         "--prior: cube_toss is fitted by tosses, which this is not for"),
        (("fit", "pendulum", "-r", "pendulum_free_swing", "--fix", "length=0.2m", "--fix",
          "damping=0", "--set", "friction=0"),
         "pendulum: nothing is left to fit: length_m, damping_N_m_s_rad, friction_N_m are given"),
        (("fit", "pendulum", "-r", "pendulum_free_swing", "--fix", "lenght=0.2m"),
         "pendulum, --fix: no parameter is called 'lenght'; did you mean length_m"),
        (("run", "cube_toss", "--set", "start_orientation_w=0.5"), "a rotation has length 1"),
    ],
)  # fmt: skip
def test_what_a_fit_or_scene_cannot_take_is_told_by_its_right_name(call, words, sentence):
    code, _, err = call(*words, "--engine", "mujoco")
    assert code == 2
    assert sentence in err
