"""A path is taken as it is, whatever it holds: no pattern, no address, no part of a command."""

from __future__ import annotations

import os
import shutil

import duckdb
import numpy as np
import pytest

import simcompare
from simcompare.cli import writing
from simcompare.hardware import importing, mapping
from simcompare.model import recording_store
from simcompare.results import store
from tests.test_recording_store import a_recording
from tests.test_store import assert_same, synthetic

NAMES = (
    "[ab]", "*", "?", "{a,b}", "[!x]", "it's", 'a "word"', "back\\slash", "new\nline", "tab\t",
    "rocket 🚀", "%41", "$HOME", "$(x)", "-rf", "~", "#x", "a;b", "drop=0.3", "s3:", "http:",
    "a?b=c", "ü", " ", "n" * 255, "'; drop table x;--",
)  # fmt: skip
NOT_UTF8 = os.fsdecode(b"M\xfcller")


@pytest.fixture(params=[*NAMES, NOT_UTF8], ids=lambda name: ascii(name)[:12])
def folder(request, tmp_path):
    """A folder with an odd name, beside those that its pattern would find."""
    for other in ("a", "b", "x", "A"):
        (tmp_path / other).mkdir()
    made = tmp_path / request.param
    try:
        made.mkdir()
    except OSError:
        pytest.skip("this file system takes no such name")
    return made


def test_a_run_is_read_back_from_any_folder(folder, tmp_path):
    other = store.save(synthetic(), tmp_path / "a").folder
    (other / "trajectories.parquet").write_bytes(b"of another")
    place = folder / other.name
    store.check_writable(folder)
    saved = store.save(synthetic(), folder)
    assert saved.folder == place
    assert_same(store.load(place), synthetic())
    assert [path.name for path in folder.iterdir()] == [place.name]


def test_a_recording_is_read_back_from_any_folder(folder, tmp_path):
    other = recording_store.save(a_recording(), tmp_path / "a" / "x.rec")
    (other / "stream-001.parquet").write_bytes(b"of another")
    for place in (folder / "x.rec", folder):
        if place == folder:
            shutil.rmtree(folder)
        recording_store.save(a_recording(), place)
        found = recording_store.load(place).streams["fast"].channels["angle_rad"]
        assert np.array_equal(found.values, [1, np.nan, 3], equal_nan=True)


def test_a_parquet_log_is_read_from_any_folder_and_under_any_name(folder, tmp_path):
    plain = tmp_path / "log.parquet"
    with duckdb.connect() as base:
        rows = 'select i * 0.01 as "t (s)", 7.0 as "y (m)" from range(99) r(i)'
        base.execute(f"copy ({rows}) to '{plain}'")
    for place in (folder / "log.parquet", folder):
        if place == folder:
            shutil.rmtree(folder)
        shutil.copy(plain, place)
        (stream,) = importing.read(place, mapping.NOTHING).streams.values()
        assert set(stream.channels) == {"y_m"}
        assert np.all(stream.channels["y_m"].values == 7)


@pytest.fixture(scope="module")
def run():
    return simcompare.run("ball", engine="pymunk", contact="default", seeds=1)


def test_a_report_and_a_text_are_written_to_any_folder(folder, run):
    assert simcompare.report(run, format="md", out=folder / "r.md").is_file()
    assert writing.text_file(folder, "robot.urdf", "<robot/>", "robot").is_file()
    assert sorted(path.name for path in folder.iterdir()) == ["r.md", "robot.urdf"]


@pytest.mark.parametrize("folder", ["[ab]", "new\nline", NOT_UTF8], indirect=True)
def test_a_command_takes_any_name(folder, command):
    done = command("export", "robot", "-o", str(folder / "robot.urdf"))
    assert done.returncode == 0, done.stderr
    assert (folder / "robot.urdf").is_file()
    log = folder / "log.csv"
    log.write_text("t (s),y (m)\n" + "".join(f"{i / 10},1\n" for i in range(20)))
    done = command("import", str(log), "-o", str(folder / "x.rec"))
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert recording_store.is_recording(folder / "x.rec")
