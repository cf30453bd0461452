"""Files and folders are written whole or not at all, whoever else writes there."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from simcompare.model import whole

ROOT = Path(__file__).parent.parent


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def put(place, text):
    with whole.folder(place) as made:
        (made / "a").write_text(text)
        (made / "b").write_text(text)


def test_a_folder_takes_its_place_when_it_is_complete(tmp_path):
    place = tmp_path / "x"
    with whole.folder(place) as made:
        (made / "a").write_text("1")
        assert not place.exists()
    assert names(tmp_path) == ["x"]
    assert names(place) == ["a"]


def test_a_folder_that_is_there_is_replaced_by_the_whole_new_one(tmp_path):
    put(tmp_path / "x", "old")
    with whole.folder(tmp_path / "x") as made:
        (made / "a").write_text("new")
        assert (tmp_path / "x" / "b").read_text() == "old"
    assert names(tmp_path / "x") == ["a"]
    assert names(tmp_path) == ["x"]


@pytest.mark.parametrize("can", [True, False])
def test_a_folder_is_replaced_also_where_the_system_cannot_exchange_two(tmp_path, monkeypatch, can):
    if not can:
        monkeypatch.setattr(whole, "_exchanged", lambda *_: False)
    put(tmp_path / "x", "old")
    put(tmp_path / "x", "new")
    assert (tmp_path / "x" / "b").read_text() == "new"
    assert names(tmp_path) == ["x"]


@pytest.mark.parametrize("error", [OSError, KeyboardInterrupt, SystemExit])
def test_an_error_leaves_what_was_there_and_nothing_else(tmp_path, error):
    def fail():
        with whole.folder(tmp_path / "x") as made:
            (made / "a").write_text("new")
            raise error

    put(tmp_path / "x", "old")
    with pytest.raises(error):
        fail()
    assert (tmp_path / "x" / "a").read_text() == "old"
    assert names(tmp_path) == ["x"]


def test_a_file_is_no_place_for_a_folder(tmp_path):
    (tmp_path / "x").write_text("theirs")
    with pytest.raises(OSError, match="x"):
        put(tmp_path / "x", "ours")
    assert (tmp_path / "x").read_text() == "theirs"
    assert names(tmp_path) == ["x"]


def test_of_folders_and_files_written_at_once_one_whole_one_wins(tmp_path):
    def write(i):
        put(tmp_path / "x", str(i))
        whole.write(tmp_path / "y", str(i).encode() * 1000)

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(write, range(10, 40)))
    assert (tmp_path / "x" / "a").read_text() == (tmp_path / "x" / "b").read_text()
    assert len(set(zip(*[iter((tmp_path / "y").read_text())] * 2, strict=True))) == 1
    assert names(tmp_path) == ["x", "y"]


def test_what_a_killed_writer_has_left_goes_with_the_next_one_and_what_a_living_one_has_stays(
    tmp_path,
):
    code = """
    import os, signal, sys, time
    from pathlib import Path
    from simcompare.model import whole
    with whole.folder(Path(sys.argv[1]) / "x") as made:
        (made / "a").write_text("half")
        print("ready", flush=True)
        time.sleep(60)
    """
    writer = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(code), str(tmp_path)], stdout=subprocess.PIPE,
        cwd=ROOT,
    )  # fmt: skip
    assert writer.stdout.readline() == b"ready\n"
    whole.write(tmp_path / "y", b"1")
    assert len(names(tmp_path)) == 2
    writer.send_signal(signal.SIGKILL)
    writer.communicate()
    assert len(names(tmp_path)) == 2
    whole.write(tmp_path / "y", b"2")
    assert names(tmp_path) == ["y"]


def test_what_is_called_nearly_as_ours_is_left_alone(tmp_path):
    for name in (".simcompare-0.partial", ".x.partial", ".simcompare-0123456789abcdef.partial.old"):
        (tmp_path / name).mkdir()
    whole.write(tmp_path / "y", b"1")
    assert len(names(tmp_path)) == 4


def test_a_name_may_be_as_long_as_the_system_takes_it(tmp_path):
    put(tmp_path / ("n" * 255), "1")
    whole.write(tmp_path / ("m" * 255), b"1")
    assert len(names(tmp_path)) == 2


def test_a_link_a_pipe_and_a_device_are_no_files_of_ours(tmp_path):
    (tmp_path / "file").write_text("1")
    (tmp_path / "link").symlink_to("file")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    with whole.opened(tmp_path / "file") as file:
        assert file.read() == b"1"
    for name in ("link", "pipe", "zero", "."):
        with pytest.raises(OSError, match="it is no file"), whole.opened(tmp_path / name):
            pass


def test_where_nobody_can_know_who_lives_everything_stays(tmp_path, no_locks):
    (tmp_path / ".simcompare-0123456789abcdef.partial").write_text("a living writer's")
    with whole.folder(tmp_path / "x") as made:
        (made / "a").write_text("1")
        whole.write(tmp_path / "y", b"2")
    assert names(tmp_path) == [".simcompare-0123456789abcdef.partial", "x", "y"]
    assert names(tmp_path / "x") == ["a"]
