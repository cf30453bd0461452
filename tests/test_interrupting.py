"""However a run ends, what was simulated is kept, said to be, and gone on with."""

from __future__ import annotations

import contextlib
import dataclasses
import errno
import os
import shlex
import shutil
import signal
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import typer

import simcompare
from simcompare.cli import streams
from simcompare.errors import InputError, OutputError
from simcompare.model import whole
from simcompare.results import run_record, store, stored_runs, unfinished
from simcompare.results.records.run import Software
from simcompare.running import interruption
from tests import present
from tests.attacks import kills

ASKED = {"engine": "pymunk", "contact": "default", "seeds": 3, "set": {"drop_height": "0.1m"}}

needs_signals = pytest.mark.skipif(os.name != "posix", reason="sends signals")


@contextlib.contextmanager
def hearing():
    """Ctrl-C as Python has it, also where the tests run in the background."""
    handlers = {number: signal.getsignal(number) for number in interruption.SIGNALS}
    hook = sys.unraisablehook
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        sys.unraisablehook = hook
        for number, handler in handlers.items():
            signal.signal(number, handler)


@pytest.fixture(autouse=True)
def ctrl_c(own_processes):
    present.need("pymunk")
    with hearing():
        yield


def interrupted_at(count):
    """What counts simulations, and presses Ctrl-C twice when so many have ended."""

    def told(_engine, done, _total):
        if done == count:
            signal.raise_signal(signal.SIGINT)
            signal.raise_signal(signal.SIGINT)

    return told


@pytest.fixture(scope="module")
def stopped_once(tmp_path_factory):
    present.need("pymunk")
    out = tmp_path_factory.mktemp("stopped")
    with hearing():
        run = simcompare.run("ball", **ASKED, out=out, progress=interrupted_at(2))
    assert run.record.interrupted
    return run.folder


@pytest.fixture
def stopped(stopped_once, tmp_path):
    """The folder of a run that Ctrl-C ended after two of three simulations."""
    folder = Path(shutil.copytree(stopped_once, tmp_path / "runs" / stopped_once.name))
    for third in folder.rglob("000002.npz"):
        third.unlink()  # it had begun, and may have ended in time all the same
    return folder


@pytest.fixture(scope="module")
def whole_run(tmp_path_factory):
    present.need("pymunk")
    return simcompare.run("ball", **ASKED, out=tmp_path_factory.mktemp("whole"))


def same(run, other):
    """Whether two runs are the same, but for when and where they were made, and how fast."""

    def of(record):
        wall = run_record.Wall()
        sources = tuple(dataclasses.replace(s, wall_s=wall, noise="") for s in record.sources)
        return dataclasses.replace(record, created="", run="", tables={}, sources=sources)

    samples = kills.samples(run.folder), kills.samples(other.folder)
    assert of(run.record) == of(other.record)
    assert samples[0].keys() == samples[1].keys()
    return all((samples[0][key] == samples[1][key]).all() for key in samples[0])


# --- signals -----------------------------------------------------------------------------------


def test_what_is_held_ends_before_it_is_interrupted():
    done = []

    @interruption.held()
    def all_of_it():
        for _ in range(3):
            signal.raise_signal(signal.SIGINT)
        done.append(interruption.came())

    with pytest.raises(KeyboardInterrupt):
        all_of_it()
    assert done == [True]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_what_was_answered_is_not_raised_again():
    told = []
    with interruption.held(lambda: told.append("told")):
        with interruption.held():
            signal.raise_signal(signal.SIGINT)
        interruption.answer()
    assert told == ["told"]
    with interruption.held():
        assert not interruption.came()


def in_a_thread(function):
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(function).result()


def test_what_interrupted_one_run_interrupts_no_later_one_and_none_in_a_thread():
    heard = []

    @interruption.held()
    def interrupted():
        signal.raise_signal(signal.SIGINT)
        heard.extend([interruption.came(), in_a_thread(interruption.came)])

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    signal.signal(signal.SIGINT, lambda *_: None)  # a program's own, which nothing is taken from
    with interruption.held():
        heard += [interruption.came(), in_a_thread(interruption.came)]
    assert heard == [True, False, False, False]


def test_a_command_is_interrupted_once():
    interruption.take_over()
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    for number in interruption.SIGNALS:
        signal.raise_signal(number)


@needs_signals
def test_what_is_ignored_stays_ignored():
    """Below nohup, and in the background of a script."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    interruption.take_over()
    signal.raise_signal(signal.SIGHUP)
    assert not interruption.came()


def test_ctrl_c_that_a_destructor_swallowed_can_be_pressed_again():
    class Swallows:
        def __del__(self):
            signal.raise_signal(signal.SIGINT)

    interruption.take_over()
    Swallows()
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


@needs_signals
def test_ctrl_c_while_all_is_imported_ends_without_a_traceback():
    early = (
        "import sys, signal, os; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "class Finder:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'typer': os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Finder())\n"
        "from simcompare.__main__ import main; main()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", early], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (130, "simcompare: interrupted\n")


# --- going on ----------------------------------------------------------------------------------


def test_a_run_that_was_ended_early_goes_on_to_the_same_end(stopped, whole_run):
    seen = []
    run = simcompare.resume(stopped, progress=lambda *told: seen.append(told))
    assert seen == [("pymunk", 1, 1)], "only what is missing is simulated"
    assert run.folder == stopped
    assert not unfinished.is_unfinished(stopped)
    assert same(run, whole_run)


def test_what_others_laid_into_the_folder_is_still_there(stopped):
    (stopped / "notes.txt").write_text("mine")
    (stopped / "more").mkdir()
    (stopped / "more" / "photo").write_text("mine too")
    simcompare.resume(stopped)
    assert (stopped / "notes.txt").read_text() == "mine"
    assert (stopped / "more" / "photo").read_text() == "mine too"


def test_ctrl_c_before_anything_had_finished_leaves_nothing(tmp_path, monkeypatch):
    def at_once(*_, **__):
        signal.raise_signal(signal.SIGINT)
        raise simcompare.verbs.run.Interrupted([])

    monkeypatch.setattr("simcompare.verbs.run.run_jobs", at_once)
    with pytest.raises(KeyboardInterrupt, match="nothing had finished"):
        simcompare.run("ball", **ASKED, out=tmp_path)
    assert not list(tmp_path.iterdir())


def test_ctrl_c_while_a_run_is_stored_comes_when_it_is(tmp_path, monkeypatch):
    save = store.save

    def pressed(*words, **more):
        signal.raise_signal(signal.SIGINT)
        return save(*words, **more)

    monkeypatch.setattr(store, "save", pressed)
    with pytest.raises(KeyboardInterrupt, match=r"all of it had finished, and is stored in \S+"):
        simcompare.run("ball", **ASKED, out=tmp_path)
    (folder,) = tmp_path.iterdir()
    assert not simcompare.load_run(folder).record.interrupted


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda m: m.setattr(run_record, "sha256_of", lambda _: "0"), "ball.yaml has changed"),
        (
            lambda m: m.setattr("simcompare.verbs.kept._version", lambda _: "9.9"),
            "it was begun with pymunk",
        ),
        (
            lambda m: m.setattr(run_record, "software", lambda: Software("9.9", "3", "2")),
            "and this is 9.9",
        ),
        (lambda m: m.setattr("simcompare.verbs.kept._digest", lambda _: "0"), "not what it began"),
    ],
    ids=["scenario", "engine", "simcompare", "simulations"],
)
def test_a_run_is_not_mixed_with_what_has_changed(stopped, monkeypatch, change, said):
    before = kills.samples(stopped)
    change(monkeypatch)
    with pytest.raises(InputError, match=said) as refused:
        simcompare.resume(stopped)
    assert "run it again: simcompare run ball --engine pymunk" in str(refused.value)
    assert kills.samples(stopped).keys() == before.keys()


def test_a_run_that_still_goes_on_is_left_alone(stopped):
    with contextlib.closing(unfinished.opened(stopped)):
        with pytest.raises(InputError, match="still goes on"):
            simcompare.resume(stopped)
        (listed,) = stored_runs.of(stopped.parent)
        assert not stored_runs.can_go(listed)


def test_a_simulation_whose_file_is_damaged_is_simulated_again(stopped, whole_run):
    (stopped / unfinished.PARTS / "000000.npz").write_bytes(b"PK and no more")
    assert same(simcompare.resume(stopped), whole_run)


def test_a_run_that_is_complete_has_nothing_to_go_on_with(whole_run):
    with pytest.raises(InputError, match="ended early"):
        simcompare.resume(whole_run.folder)


def test_the_command_goes_on_with_what_it_was_asked(call, stopped):
    code, _, err = call("run", "--resume", stopped, "--seeds", "4", "--engine", "pymunk")
    assert code == 2
    assert "--seeds is not what the run was begun with; leave it out" in err
    assert "--engine" not in err
    code, out, err = call("run", "ball", "--resume", stopped, "--no-report")
    assert (code, err) == (0, "")
    assert f"Stored in {stopped}" in out


def test_without_a_scenario_and_without_a_run_the_command_asks_for_one(call):
    code, _, err = call("run")
    assert code == 2
    assert "which scenario?" in err


def test_the_next_run_names_one_that_was_killed(call, stopped):
    (stopped / store.RECORD).unlink()
    words = ("run", "ball", "--engine", "pymunk", "--contact", "default", "--seeds", "1")
    _, out, _ = call(*words, "--no-report", "--out", stopped.parent)
    told = f"{stopped} was ended early; go on with: "
    (line,) = [line for line in out.splitlines() if line.startswith(told)]
    code, _, err = call(*shlex.split(line.removeprefix(told))[1:], "--no-report")
    assert (code, err) == (0, "")


def test_a_killed_run_is_listed_and_can_be_deleted(stopped):
    (stopped / store.RECORD).unlink()
    for name in (store.TRAJECTORIES, store.SCORES):
        (stopped / name).unlink()
    (listed,) = stored_runs.of(stopped.parent)
    assert listed.verdict == "unfinished"
    assert "--resume" in listed.fault
    assert stored_runs.can_go(listed)
    stored_runs.delete([listed])
    assert not stopped.exists()


def test_an_interrupted_run_can_be_deleted_with_all_that_it_keeps(stopped):
    (listed,) = stored_runs.of(stopped.parent)
    assert listed.verdict == "interrupted"
    stored_runs.delete([listed])
    assert not stopped.exists()


# --- disks and streams -------------------------------------------------------------------------


def full_after(monkeypatch, count):
    """A disk that takes so many more files beside ``asked.json``."""
    write = whole.write

    def bounded(place, content):
        nonlocal count
        if place.suffix == ".npz":
            count -= 1
            if count < 0:
                raise OSError(errno.ENOSPC, "No space left on device")
        return write(place, content)

    monkeypatch.setattr(whole, "write", bounded)


def test_a_disk_that_is_full_keeps_what_was_written_before(tmp_path, monkeypatch, whole_run):
    with monkeypatch.context() as patch:
        full_after(patch, 2)
        with pytest.raises(OutputError, match="No space left") as full:
            simcompare.run("ball", **ASKED, out=tmp_path)
    (folder,) = tmp_path.iterdir()
    cure = f"2 of 3 simulations are kept; go on when there is room: {unfinished.resuming(folder)}"
    assert cure in str(full.value)
    assert same(simcompare.resume(folder), whole_run)


def test_a_disk_that_is_full_at_once_leaves_nothing(tmp_path, monkeypatch):
    full_after(monkeypatch, 0)
    with pytest.raises(OutputError, match="No space left"):
        simcompare.run("ball", **ASKED, out=tmp_path)
    assert not list(tmp_path.iterdir())


def test_a_run_that_does_not_fit_the_disk_is_kept_simulation_by_simulation(
    tmp_path, monkeypatch, whole_run
):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(store, "_write_trajectories", full)
        with pytest.raises(OutputError, match="3 of 3 simulations are kept") as error:
            simcompare.run("ball", **ASKED, out=tmp_path)
    assert "nothing was kept" not in str(error.value)
    (folder,) = tmp_path.iterdir()
    assert same(simcompare.resume(folder), whole_run)


def test_where_only_the_report_does_not_fit_the_answer_is_told_all_the_same(
    call, monkeypatch, tmp_path
):
    def full(*_):
        raise OutputError("report.html: cannot be written (No space left on device)")

    monkeypatch.setattr("simcompare.reports.builder.write_html", full)
    code, out, err = call(
        "run", "ball", "--engine", "pymunk", "--contact", "default", "--seeds", "1", "--out", "r"
    )
    (folder,) = (tmp_path / "r").iterdir()
    assert code == 2
    assert f"Stored in r/{folder.name}" in out
    assert "No space left on device" in err
    later = f"its report can be made later: simcompare report r/{folder.name}"
    assert later in err
    assert simcompare.load_run(folder).record.scores


@pytest.mark.parametrize(
    ("number", "code", "said"),
    [
        (errno.EPIPE, 1, "simcompare: stored in runs/x\n"),
        (errno.EIO, 1, "simcompare: stored in runs/x\n"),
        (errno.ENOSPC, 2, "simcompare: the output cannot be written (full); free some space;"
         " stored in runs/x\n"),
    ],
    ids=["reader gone", "terminal gone", "disk full"],
)  # fmt: skip
def test_where_nobody_reads_the_exit_code_holds_and_the_place_is_told(
    monkeypatch, capsys, number, code, said
):
    monkeypatch.setattr(streams, "_forget_stdout", lambda: None)

    @streams.readers_may_leave(1, "stored in runs/x")
    def print_all():
        raise OSError(number, "full")

    with pytest.raises(typer.Exit) as ended:
        print_all()
    assert (ended.value.exit_code, capsys.readouterr().err) == (code, said)


# --- kills -------------------------------------------------------------------------------------


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="reads /proc")
def test_no_kill_at_any_moment_loses_mixes_or_leaves_anything(tmp_path):
    """A few of the attacks of ``python -m tests.attacks.kills``, one of each kind."""
    whole_one = kills.unbroken(tmp_path / "whole")
    first = {}
    for seed in range(100):
        first.setdefault(kills.drawn(seed)[0], seed)
    found = [kills.attack(seed, tmp_path / str(seed), whole_one) for seed in first.values()]
    assert Counter(kill.fault for kill in found) == {"": len(kills.KINDS)}
