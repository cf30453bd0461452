"""The terminal: options of every verb, opening a report, widths."""

from __future__ import annotations

import json
import os
import shlex
import struct
import subprocess
import sys
import webbrowser
from pathlib import Path

import pytest
from typer.main import get_command

from simcompare.cli import app, register
from simcompare.cli.examples import EXAMPLES

ROOT = Path(__file__).parents[1]


@pytest.fixture
def opened(monkeypatch):
    """Addresses that the browser was given; ``opened.works = False`` for a machine without one."""

    class Opened(list):
        works = True

        def __call__(self, address):
            self.append(address)
            return self.works

    addresses = Opened()
    monkeypatch.setattr(webbrowser, "open", addresses)
    return addresses


# --- opening a report -------------------------------------------------------------------------


def test_open_shows_the_report_in_the_browser(call, fall, add_engine, opened, tmp_path):
    add_engine("toy")
    words = ("run", fall, "--engine", "toy", "--contact", "assisted")
    assert call(*words)[0] == 0
    assert opened == [], "nothing opens by itself"
    _, out, _ = call(*words, "--open")
    (address,) = opened
    (place,) = [line.split(": ")[1] for line in out.splitlines() if line.startswith("Report: ")]
    assert address == (tmp_path / place).resolve().as_uri()
    assert call("report", Path(place).parent, "--open")[0] == 0
    assert opened == [address] * 2


def test_where_there_is_no_browser_the_page_is_named(call, fall, add_engine, opened):
    add_engine("toy")
    opened.works = False
    words = ("run", fall, "--engine", "toy", "--contact", "assisted", "--open")
    code, _, err = call(*words)
    assert code == 0
    assert "No browser was found; open runs" in err


def test_a_report_that_is_not_written_is_not_opened(call, fall, opened):
    code, out, err = call("run", fall, "--open", "--no-report")
    assert (code, out, opened) == (2, "", [])
    assert "--open: there is no page to open; leave out --no-report" in err


# --- options of every verb --------------------------------------------------------------------


def verbs():
    register()
    root = get_command(app)
    return {**root.commands, **root.commands["data"].commands}


def test_every_verb_takes_them():
    for name, verb in verbs().items():
        given = {word for param in verb.params for word in param.opts}
        assert {"--quiet", "-q", "--verbose", "-v", "--debug"} <= given, name


@pytest.mark.parametrize("words", [["-q", "list"], ["list", "-q"], ["data", "list", "--quiet"]])
def test_quiet_prints_nothing(call, words):
    assert call(*words) == (0, "", "")


def test_quiet_prints_errors_and_what_was_asked_for_as_text(call, fall, add_engine):
    add_engine("toy")
    words = ("run", fall, "--engine", "toy", "--contact", "assisted", "--no-report", "-q")
    assert call(*words) == (0, "", "")
    code, out, _ = call(*words, "--json")
    assert json.loads(out)["exit_code"] == code == 0
    code, out, err = call("-q", "show", "bal")
    assert (code, out) == (2, "")
    assert "did you mean ball?" in err
    _, script, _ = call("export", "pendulum", "-q")
    assert script.startswith("<?xml")


def test_tune_takes_them_beside_the_options_of_an_engine(call):
    words = ("tune", "--engine", "pymunk", "--elasticity", "0.8", "--speed", "2")
    code, out, err = call(*words, "-q")
    assert (code, out) == (0, ""), err
    assert call("-q", *words)[1] == ""


def test_debug_shows_where_an_error_comes_from(call):
    _, _, short = call("show", "bal")
    _, _, long = call("show", "bal", "--debug")
    assert "Traceback" not in short
    assert "Traceback" in long
    assert "catalogue.py" in long
    assert long.endswith(short)


def test_debug_shows_where_an_engine_failed(call, fall, add_engine):
    add_engine("raises", "raise RuntimeError('the solver gave up')")
    words = ("run", fall, "--engine", "raises", "--contact", "assisted", "--no-report")
    _, _, short = call(*words)
    _, _, long = call("--debug", *words)
    assert short == ""
    assert "raises_engine.py" in long
    assert "RuntimeError: the solver gave up" in long


# --- help -------------------------------------------------------------------------------------


def test_the_list_of_verbs_fits_80_columns_whole(call):
    _, out, _ = call("--help")
    rows = out[out.index("Commands:") :].splitlines()
    assert not [row for row in rows if row.endswith("...")]
    assert max(map(len, rows)) <= 80


@pytest.mark.parametrize("verb", EXAMPLES)
def test_examples_are_shown_and_can_be_parsed(call, verb):
    _, out, _ = call(verb, "--help")
    shown = out[out.index("Examples:") :].splitlines()[1:]
    assert [line.strip() for line in shown] == [*EXAMPLES[verb]]
    for line in EXAMPLES[verb]:
        program, name, *words = shlex.split(line)
        found = verbs()["fetch" if name == "data" else name]
        assert program == "simcompare"
        found.make_context(name, words[1:] if name == "data" else words)
        for word in words:
            assert not word.startswith("examples/") or Path(ROOT, word).is_file()


def test_every_verb_has_examples():
    register()
    assert set(EXAMPLES) == set(get_command(app).commands) - {"data"}


# --- words that stand where they cannot -------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run ball mujoco", "'mujoco' must stand behind an option; write: simcompare run ball"
         " --engine mujoco"),
        ("run ball mujoco:rk4,ode mass=1g --seeds 2", "'mujoco:rk4,ode' and 'mass=1g' must stand"
         " behind an option; write: simcompare run ball --seeds 2 --engine mujoco:rk4,ode"
         " --set mass=1g"),
        ("run ball --engine mujoco pymunk", "write: simcompare run ball --engine mujoco,pymunk"),
        ("run ball mujoco pymunk a=1 b=2", "write: simcompare run ball --engine mujoco,pymunk"
         " --set a=1 --set b=2"),
        ("run ball --contact=tuned default", "write: simcompare run ball --contact tuned,default"),
        ("run ball tuned", "write: simcompare run ball --contact tuned"),
        ("run ball heavy ode", "run: nothing is known of 'heavy' and 'ode' here; all options:"
         " simcompare run --help"),
        ("show ball ode", "show: nothing is known of 'ode' here"),
        ("ball --engine ode", "ball: is a scenario; write: simcompare run ball --engine ode"),
        ("ode", "ode: is an engine; write, such as: simcompare run ball --engine ode"),
        ("run --seeds 2", "run: which scenario? simcompare list names all, simcompare run --help"
         " has examples"),
        ("-v charcterize", "no command is called 'charcterize'; did you mean characterize or"
         " calibrate?"),
    ],
)  # fmt: skip
def test_a_word_too_many_says_where_it_belongs(call, words, said):
    code, out, err = call(*words.split())
    assert (code, out) == (2, "")
    assert said in err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run ball --preset golf --preset tennis", "--preset is given twice: golf, tennis; give"
         " one"),
        ("run ball --engine ode --engine=pymunk", "--engine is given twice: ode, pymunk; write"
         " --engine ode,pymunk"),
        ("run ball --out a -o b -o c", "--out is given several times: a, b, c; give one"),
        ("runs --clean --keep 0 --keep 5", "--keep is given twice: 0, 5; give one"),
        ("validate ball --contact tuned --contact default", "--contact is given twice: tuned,"
         " default; give one"),
    ],
)  # fmt: skip
def test_an_option_that_takes_one_value_is_given_once(call, words, said):
    code, out, err = call(*words.split())
    assert (code, out) == (2, "")
    assert said in err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("run ball --engin ode", "no option of run is called '--engin'; did you mean --engine"),
        ("run ball --no-repor", "did you mean --no-report"),
        ("run ball -x", "no option of run is called '-x'; known: --against"),
        ("run ball --seeds", "run: --seeds needs a value behind it; all options: simcompare run"
         " --help"),
        ("run ball --json=3", "run: --json takes no value; all options: simcompare run --help"),
        ("fit ball", "fit: --recording is missing (Sound,"),
        ("import", "import: LOG is missing ("),
    ],
)  # fmt: skip
def test_what_the_parser_finds_wrong_is_one_sentence(call, words, said):
    code, out, err = call(*words.split())
    assert (code, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1


# --- widths -----------------------------------------------------------------------------------


def in_terminal(columns, folder, *words):
    """What a command prints in a terminal of so many columns."""
    pty = pytest.importorskip("pty")
    import fcntl
    import termios

    mine, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
    env = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    process = subprocess.Popen(
        [sys.executable, "-m", "simcompare", *words],
        stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs, cwd=folder,
        env={**env, "TERM": "dumb"},
    )  # fmt: skip
    os.close(theirs)
    parts = []
    while True:
        try:
            part = os.read(mine, 65536)
        except OSError:  # the other side is closed
            break
        if not part:
            break
        parts.append(part)
    os.close(mine)
    assert process.wait() == 0
    return b"".join(parts).decode()


@pytest.mark.parametrize(("columns", "most"), [(60, 60), (80, 80), (200, 200)])
def test_a_terminal_is_filled_and_never_overrun(columns, most, tmp_path):
    shown = in_terminal(columns, tmp_path, "show", "ball")
    assert max(map(len, shown.splitlines())) <= most
    assert {"drop_height_m", "0.01…20", "release.", "settling_time"} <= set(shown.split())


def test_in_a_pipe_a_table_has_a_line_for_each_row(command):
    env = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    out = command("show", "ball", env=env).stdout
    (row,) = [line for line in out.splitlines() if line.startswith("drop_height_m")]
    assert row.endswith("above the floor at release.")
    narrow = command("show", "ball", env={**env, "COLUMNS": "70"}).stdout
    assert max(map(len, narrow.splitlines())) <= 70
