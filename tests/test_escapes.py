"""Names and messages from elsewhere steer no terminal and hide nothing."""

from __future__ import annotations

import io
import json
import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from simcompare.cli import streams
from tests.conftest import FALL_YAML

ROOT = str(Path(__file__).parents[1])
EVIL = "\x1b]0;pwn\x07\x1b[31m\x9b5m\u202edrows\u200b\x7f"


#: of C0 and C1 all but ends of lines and tabs, marks of direction, and what has no width
HIDDEN = [*range(9), *range(11, 32), *range(0x7F, 0xA0), 0xAD, 0x61C, *range(0x200B, 0x2010),
          *range(0x2028, 0x202F), *range(0x2060, 0x2070), 0xFEFF,
          *range(0xE0000, 0xE0080)]  # fmt: skip


def test_all_that_steers_or_hides_is_escaped_and_all_else_is_not():
    for code in HIDDEN:
        assert streams.escaped(chr(code)).startswith(("\\x", "\\u")), hex(code)
    kept = "".join(chr(code) for code in range(0x10000) if chr(code).isprintable()) + "\n\t"
    assert streams.escaped(kept) == kept


def test_json_still_says_the_same():
    text = json.dumps({EVIL: EVIL + "\U000e0041"}, ensure_ascii=False)
    assert json.loads(streams.escaped(text)) == {EVIL: EVIL + "\U000e0041"}


def test_what_we_draw_is_left_alone():
    stream = streams._Escaping(io.BytesIO(), "utf-8")
    stream.write(EVIL)
    streams.Steering(stream).write("\x1b[2K")
    stream.flush()
    assert stream.buffer.getvalue().endswith(b"\x1b[2K")
    assert stream.buffer.getvalue().count(b"\x1b") == 1


def seen(*words, cwd):
    """What a command writes to a terminal."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "simcompare", *map(str, words)],
        stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs, cwd=cwd,
        env={**os.environ, "PYTHONPATH": ROOT},
    )  # fmt: skip
    os.close(theirs)
    text = b""
    while True:
        try:
            text += (more := os.read(ours, 4096))
        except OSError:  # the other end is closed
            break
        if not more:
            break
    os.close(ours)
    process.wait()
    return text.decode()


def is_clean(text):
    return text and text == streams.escaped(text.replace("\r\n", "\n")).replace("\n", "\r\n")


def test_a_hostile_log_is_told_of_in_plain_signs(tmp_path):
    path = tmp_path / f"a{EVIL}.csv"
    path.write_text(f"t (s),{EVIL} (m)\n" + "".join(f"{i},{i}\n" for i in range(9)))
    told = seen("import", path, "-o", "x.rec", cwd=tmp_path)
    assert is_clean(told)
    assert "\\x1b]0;pwn" in told
    told = seen("import", path.with_name(f"no{EVIL}\nStored in x.csv"), cwd=tmp_path)
    assert is_clean(told)
    assert "\nStored" not in told


@pytest.mark.parametrize("words", [["export", "--engine"], ["show", "--json"], ["list"]])
def test_a_hostile_scenario_is_told_of_in_plain_signs(tmp_path, monkeypatch, words):
    folder = tmp_path / "mine" / "fall"
    folder.mkdir(parents=True)
    title = json.dumps("Fall" + EVIL)
    text = FALL_YAML.replace("title: Free fall", f"title: {title}")
    (folder / "fall.yaml").write_text(text, encoding="utf-8")
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(folder.parent))
    verb, *options = words
    more = [] if verb == "list" else [folder]
    options = [f"--engine=no{EVIL}"] if options == ["--engine"] else options
    assert is_clean(seen(verb, *more, *options, cwd=tmp_path))


def test_a_closed_output_is_told_where_the_result_is():
    code = (
        "from simcompare.cli import streams\n"
        "streams.keep()\n"
        "with streams.readers_may_leave(0, 'stored in runs/7'): print('the answer')\n"
    )
    command = ["sh", "-c", 'exec "$0" -c "$1" >&-', sys.executable, code]
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False,
        env={**os.environ, "PYTHONPATH": ROOT},
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, b"simcompare: stored in runs/7\n")
