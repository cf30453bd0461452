"""The folder of a run while it runs: parts that have finished stay, whatever happens then."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from dataclasses import replace
from pathlib import Path

import pytest

from simcompare.errors import InputError, OutputError
from simcompare.results import store, unfinished
from tests.test_store import assert_same, synthetic

CREATED = "2026-01-02T03:04:05+00:00"
ROOT = Path(__file__).parent.parent


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def begun(folder, *parts):
    made = unfinished.begin(folder, CREATED, "ball")
    for i, part in enumerate(parts):
        made.add(f"{i:04}.bin", part)
    return made


def ended(run, *, early):
    return replace(run, record=replace(run.record, interrupted=early))


def test_a_run_has_its_final_place_from_the_beginning(tmp_path):
    made = begun(tmp_path)
    assert made.folder == tmp_path / "20260102-030405-ball"
    assert begun(tmp_path).folder == tmp_path / "20260102-030405-ball-2"
    assert unfinished.is_unfinished(made.folder)
    assert unfinished.is_running(made.folder)


def test_parts_are_kept_and_read_back(tmp_path):
    made = begun(tmp_path, b"first", b"second")
    made.add("0001.bin", b"other")
    (made.folder / "unfinished" / "NOTES").write_text("of others")
    assert made.parts() == {"0000.bin": b"first", "0001.bin": b"other"}


@pytest.mark.parametrize("early", [True, False])
def test_the_whole_run_takes_the_place_and_parts_stay_where_it_ended_early(tmp_path, early):
    made = begun(tmp_path, b"first")
    run = ended(synthetic(), early=early)
    saved = store.save(run, tmp_path, begun=made)
    assert saved.folder == made.folder
    assert_same(store.load(saved.folder), run)
    assert names(tmp_path) == [made.folder.name]
    assert unfinished.is_unfinished(saved.folder) is early


def test_a_run_that_ended_early_goes_on_and_is_replaced_by_the_whole_one(tmp_path):
    made = begun(tmp_path, b"first")
    store.save(ended(synthetic(), early=True), tmp_path, begun=made)
    made.close()
    again = unfinished.opened(made.folder)
    assert again.parts() == {"0000.bin": b"first"}
    store.save(ended(synthetic(), early=False), tmp_path, begun=again)
    assert not unfinished.is_unfinished(made.folder)
    assert not store.load(made.folder).record.interrupted
    assert names(tmp_path) == [made.folder.name]


def test_what_cannot_be_written_leaves_the_parts(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    made = begun(tmp_path, b"first")
    monkeypatch.setattr(store, "_write_scores", full)
    with pytest.raises(OutputError, match="No space left"):
        store.save(synthetic(), tmp_path, begun=made)
    assert made.parts() == {"0000.bin": b"first"}
    assert names(tmp_path) == [made.folder.name]


def test_nothing_is_left_of_a_run_that_kept_nothing(tmp_path):
    begun(tmp_path, b"first").drop()
    assert names(tmp_path) == []


def test_a_run_that_still_goes_on_is_not_taken_up_and_a_killed_one_is(tmp_path):
    code = f"""
    import sys, time
    from pathlib import Path
    from simcompare.results import unfinished
    made = unfinished.begin(Path(sys.argv[1]), {CREATED!r}, "ball")
    made.add("0000.bin", b"first")
    print("ready", flush=True)
    time.sleep(60)
    """
    run = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code), str(tmp_path)], stdout=subprocess.PIPE,
        cwd=ROOT,
    )  # fmt: skip
    assert run.stdout.readline() == b"ready\n"
    place = tmp_path / "20260102-030405-ball"
    with pytest.raises(InputError, match="still goes on; wait for its end"):
        unfinished.opened(place)
    run.kill()
    run.communicate()
    assert unfinished.opened(place).parts() == {"0000.bin": b"first"}


def test_what_is_no_unfinished_run_is_told(tmp_path):
    saved = store.save(synthetic(), tmp_path)
    with pytest.raises(InputError, match="is not the folder of a run that was ended early"):
        unfinished.opened(saved.folder)


def test_a_place_that_a_killed_writer_reserved_is_free_again(tmp_path):
    (tmp_path / "20260102-030405-ball").mkdir()
    (tmp_path / "other").mkdir()
    assert begun(tmp_path).folder.name == "20260102-030405-ball"
    assert names(tmp_path) == ["20260102-030405-ball", "other"]


def test_where_nobody_can_know_whether_it_runs_it_is_neither_gone_on_with_nor_deleted(
    tmp_path, no_locks, call
):
    made, empty = begun(tmp_path, b"first"), begun(tmp_path)
    with pytest.raises(InputError, match="may still go on: its disk has no locks") as refused:
        unfinished.opened(made.folder)
    assert f"cp -r {made.folder} . && simcompare run --resume {made.folder.name}" in str(
        refused.value
    )
    begun(tmp_path).close()
    assert made.folder.is_dir()
    assert empty.folder.is_dir()
    code, out, _ = call("runs", tmp_path, "--clean", "--keep", 0, "--yes")
    assert code == 0
    assert "may still run" in out
    assert f"rm -r {made.folder}" in out
    assert made.parts() == {"0000.bin": b"first"}
    assert store.save(ended(synthetic(), early=False), tmp_path, begun=made).folder == made.folder
