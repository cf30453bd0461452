"""Logs are read in a process of their own, which ends where it takes more than it may."""

import errno
import json
import os
import signal
import socket
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError, NoSuchFile
from simcompare.hardware import confined, importing, reading_process
from simcompare.hardware.logs import importers
from simcompare.hardware.mapping import NOTHING, of_tree
from simcompare.model import whole

linux = pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="limits are Linux's")
MB = 1 << 20


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "log.csv"
    rows = [f"{0.01 * i:.2f},{np.sin(i):.4f}" for i in range(200) if i != 90]
    path.write_text("\n".join(["t [s],x [m]", *rows, "2.5"]) + "\n")
    return path


@pytest.fixture(params=["fork", "new Python"])
def either_way(request, monkeypatch):
    monkeypatch.setattr(confined, "fork_is_safe", lambda: request.param == "fork")


def ending_of(task, folder, memory_mb=50, file_mb=10, seconds=60.0):
    limits = confined.Limits(memory_mb * MB, file_mb * MB, seconds)
    return confined.run(task, f"{task.__module__}:{task.__name__}", folder, limits)


@pytest.mark.usefixtures("either_way")
def test_a_recording_comes_back_as_it_was_read(log):
    mapping = of_tree({"channels": {"y": {"column": "x", "unit": "mm", "u": 0.5}}}, "map")
    found = reading_process.read(log, mapping, about={"title": "a bench"})
    wanted = importing.read(log, mapping, about={"title": "a bench"})
    assert found.provenance == wanted.provenance
    assert len(found.provenance.repairs) > 1
    (stream,), (same,) = found.streams.values(), wanted.streams.values()
    assert (stream.clock, stream.gaps) == (same.clock, same.gaps)
    np.testing.assert_array_equal(stream.time_s, same.time_s)
    np.testing.assert_array_equal(stream.channels["y_m"].values, same.channels["y_m"].values)
    assert stream.channels["y_m"].u == same.channels["y_m"].u
    assert reading_process.template(log) == importing.template(log)


def test_numbers_of_a_long_recording_are_looked_at_where_they_lie(tmp_path, monkeypatch):
    monkeypatch.setattr("simcompare.hardware.carried._HELD", 100)
    path = tmp_path / "long.csv"
    path.write_text("t [s],x [m]\n" + "".join(f"{i},{i % 7}\n" for i in range(300)))
    values = reading_process.read(path, NOTHING).streams["log"].channels["x_m"].values
    assert isinstance(values, np.memmap)
    assert values.tolist() == [i % 7 for i in range(300)]


@pytest.mark.usefixtures("either_way")
def test_an_error_comes_back_as_it_was_raised(tmp_path):
    empty = tmp_path / "empty.csv"
    empty.write_text("")
    with pytest.raises(InputError, match="is empty") as fault:
        reading_process.read(empty, NOTHING)
    assert fault.value.where == str(empty)
    assert fault.value.faults == ("is empty; expected a log with at least two samples",)
    with pytest.raises(NoSuchFile, match="did you mean"):
        reading_process.read(tmp_path / "emty.csv", NOTHING)


def test_an_error_that_nobody_foresaw_keeps_its_trace(log, monkeypatch):
    monkeypatch.setattr(confined, "fork_is_safe", lambda: True)
    monkeypatch.setattr(importing, "read", lambda *_, **__: 1 / 0)
    with pytest.raises(RuntimeError, match="ZeroDivisionError") as fault:
        reading_process.read(log, NOTHING)
    assert "in _answered" in fault.value.__notes__[0]


# ---- limits -----------------------------------------------------------------------------------


def take_memory(folder):
    try:
        # 64 MB each: what is smaller may lie in memory that the parent gave back to itself
        held = [np.ones(8 * MB) for _ in range(5)]
    except MemoryError:
        held = []
    confined.answer(folder, {"held": len(held)})


def fill_disk(folder):
    with (folder / "large").open("wb") as file:
        try:
            file.write(b"0" * (20 * MB))
            file.flush()
        except OSError as error:
            confined.answer(folder, {"errno": error.errno})


def sleep(folder):
    time.sleep(1000)
    confined.answer(folder, {})


def die(folder):
    (folder / "begun").touch()
    os.kill(os.getpid(), signal.SIGKILL)


def fail(folder):
    print("on the way")
    raise ValueError("it does not work")


def say_where(folder):
    with tempfile.NamedTemporaryFile() as file:
        confined.answer(folder, {"file": file.name, "group": os.getpgid(0)})


@linux
@pytest.mark.usefixtures("either_way")
def test_more_memory_or_disk_than_allowed_is_not_given(tmp_path):
    ending_of(take_memory, tmp_path)
    assert json.loads((tmp_path / "answer.json").read_text()) == {"held": 0}
    ending_of(take_memory, tmp_path, memory_mb=1000)
    assert json.loads((tmp_path / "answer.json").read_text()) == {"held": 5}
    ending_of(fill_disk, tmp_path)
    assert json.loads((tmp_path / "answer.json").read_text()) == {"errno": 27}


@pytest.mark.usefixtures("either_way")
def test_what_lasts_too_long_or_dies_is_told(tmp_path):
    assert ending_of(sleep, tmp_path, seconds=0.5).is_late
    assert not (tmp_path / "answer.json").exists()
    ending = ending_of(die, tmp_path)
    assert (tmp_path / "begun").exists()
    assert ending == confined.Ending(signal=signal.SIGKILL)
    assert ending_of(fail, tmp_path) == confined.Ending(said="ValueError: it does not work")


@pytest.mark.usefixtures("either_way")
def test_temporary_files_lie_in_the_folder_of_the_task(tmp_path):
    ending_of(say_where, tmp_path)
    told = json.loads((tmp_path / "answer.json").read_text())
    assert Path(told["file"]).parent == tmp_path
    assert told["group"] != os.getpgid(0)


@linux
def test_a_small_log_that_needs_much_is_refused_in_one_sentence(log, monkeypatch):
    monkeypatch.setattr(confined, "fork_is_safe", lambda: True)
    monkeypatch.setattr(importing, "read", lambda *_, **__: [np.ones(MB) for _ in range(1000)])
    with pytest.raises(InputError, match=r"needs more memory than a log of 2.5 kB may take"):
        reading_process.read(log, NOTHING)
    monkeypatch.setattr(importing, "read", lambda *_, **__: time.sleep(1000))
    monkeypatch.setenv(reading_process.TIME_VARIABLE, "1")
    with pytest.raises(InputError, match=r"more time .* \(1 s\).*SIMCOMPARE_LOG_TIME_S=10$"):
        reading_process.read(log, NOTHING)
    monkeypatch.setattr(importing, "read", lambda *_, **__: os.kill(os.getpid(), 9))
    monkeypatch.delenv(reading_process.TIME_VARIABLE)
    with pytest.raises(InputError, match="signal 9"):
        reading_process.read(log, NOTHING)


def test_a_reader_that_fails_before_it_reads_says_why(log, monkeypatch):
    monkeypatch.setattr(confined, "fork_is_safe", lambda: True)
    monkeypatch.setattr(reading_process, "serve", fail)
    with pytest.raises(InputError, match=r"its reader failed \(ValueError: it does not work\)"):
        reading_process.read(log, NOTHING)


def test_a_log_that_is_still_written_is_refused(log, monkeypatch):
    read = importers.read

    def meanwhile(path, *rest):
        found = read(path, *rest)
        with log.open("a") as file:
            file.write("3.0,1\n")
        return found

    monkeypatch.setattr(importers, "read", meanwhile)
    with pytest.raises(InputError, match="changed while it was read"):
        importing.read(log, NOTHING)


def test_a_limit_that_is_no_number_is_refused(log, monkeypatch):
    monkeypatch.setenv(reading_process.MEMORY_VARIABLE, "much")
    with pytest.raises(InputError, match="'much'; expected a number"):
        reading_process.read(log, NOTHING)


def test_a_file_with_holes_is_as_large_as_what_is_in_it(tmp_path):
    path = tmp_path / "sparse.csv"
    with path.open("wb") as file:
        file.truncate(10**11)
    if path.stat().st_blocks * 512 == path.stat().st_size:
        pytest.skip("this file system keeps no holes")
    assert reading_process._size(path) < MB


@linux
def test_only_files_and_folders_are_read(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe.csv")
    listening = socket.socket(socket.AF_UNIX)
    listening.bind("socket.csv")
    Path("loop.csv").symlink_to("loop.csv")
    words = {
        "pipe.csv": "is a named pipe", "socket.csv": "is a socket", "/dev/zero": "is a device",
        "loop.csv": "cannot be read",
    }  # fmt: skip
    for name, said in words.items():
        with pytest.raises(InputError, match=said):
            reading_process.read(Path(name), NOTHING)
    listening.close()


def find_no_room(*_words, **_more):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.usefixtures("either_way")
def test_a_full_disk_is_told_from_other_failures(tmp_path):
    assert ending_of(find_no_room, tmp_path).is_full


def test_a_full_temporary_folder_is_told_with_its_cure(log, monkeypatch):
    monkeypatch.setattr(confined, "fork_is_safe", lambda: True)
    monkeypatch.setattr(importing, "read", find_no_room)
    with pytest.raises(InputError, match=r"is full.*name another folder, as in: TMPDIR=") as told:
        reading_process.read(log, NOTHING)
    assert told.value.where == tempfile.gettempdir()


def test_what_a_killed_process_has_left_goes_with_the_next_one(log):
    left = Path(tempfile.mkdtemp(prefix="simcompare-log-"))
    (left / "numbers").write_bytes(b"half")
    with whole.temporary("simcompare-log-") as lives:
        reading_process.read(log, NOTHING)
        assert lives.is_dir()
    assert not left.exists()
    assert not lives.exists()
