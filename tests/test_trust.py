"""Code beside a scenario from elsewhere runs only after a yes, and in a process of its own."""

from __future__ import annotations

import contextlib
import io
import os
import pty
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import simcompare
from simcompare.arguments import checked
from simcompare.cli import manner, trusting
from simcompare.errors import InputError, UntrustedCode
from simcompare.scenarios import catalogue, outside, trust
from tests.conftest import FALL_REFERENCE, FALL_YAML

TIMES = np.array([0.0, 1.0])
EASY = "def reference(parameters, time_s):\n    return {}\n"


@pytest.fixture(autouse=True)
def nobody_said_yes(tmp_path, monkeypatch, own_processes):
    """Memories of its own, and a folder from elsewhere whose code leaves a mark."""
    monkeypatch.setenv("SIMCOMPARE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(trust, "_allowed", set())


@pytest.fixture
def mark(tmp_path):
    return tmp_path / "it ran"


@pytest.fixture
def stranger(tmp_path, mark):
    """A scenario folder that tries all ways to have its code run."""
    folder = tmp_path / "strange" / "fall"
    (folder / "reference").mkdir(parents=True)
    evil = f"import os, pathlib; pathlib.Path({str(mark)!r}).write_text(str(os.getpid()))\n"
    (folder / "fall.yaml").write_text(FALL_YAML, encoding="utf-8")
    (folder / "reference.py").write_text(evil + FALL_REFERENCE, encoding="utf-8")
    for name in ("helper", "conftest", "numpy", "sitecustomize", "measures", "reference/__init__"):
        (folder / f"{name}.py").write_text(evil, encoding="utf-8")
    return folder


def said_yes(folder: Path, text: str) -> Any:
    """The reference of a folder in which somebody has said yes to a text."""
    (folder / "reference.py").write_text(text, encoding="utf-8")
    trust.allow(folder / "reference.py")
    return catalogue.reference_of(folder / "fall.yaml")


def test_only_a_yes_lets_it_run(call, stranger, mark):
    code, out, err = call(
        "run", stranger, "--engine", "pymunk", "--contact", "default", "--json", "--no-report"
    )
    assert (code, out) == (2, "")
    assert str(stranger / "reference.py") in err
    assert "add --trust once" in err
    assert not mark.exists()
    words = ("run", stranger, "--engine", "pymunk", "--contact", "default", "--json", "--no-report")
    assert call(*words, "--trust")[0] in (0, 1)
    assert int(mark.read_text()) != os.getpid(), "in a process of its own"
    assert call(*words)[0] in (0, 1), "it is remembered"
    (stranger / "helper.py").write_text("x = 1\n")
    assert call(*words)[0] == 2, "other code is asked for again"


@pytest.mark.parametrize(
    "words", [["show", "PATH"], ["show", "PATH", "--json"], ["list"], ["tune", "PATH", "--help"],
              ["run", "PATH", "--help"], ["explain", "fall"]],
)  # fmt: skip
def test_what_only_tells_runs_nothing(call, stranger, mark, monkeypatch, words):
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(stranger.parent))
    monkeypatch.chdir(stranger)
    call(*(str(stranger) if word == "PATH" else word for word in words))
    assert not mark.exists()


def test_a_shell_that_completes_runs_nothing(stranger, mark, monkeypatch):
    monkeypatch.setenv("SIMCOMPARE_SCENARIOS", str(stranger.parent))
    from simcompare.cli import complete

    assert complete.scenarios("fal") == ["fall"]
    assert not mark.exists()


def test_tags_of_yaml_run_nothing(call, stranger, mark):
    (stranger / "reference.py").unlink()
    text = f"!!python/object/apply:os.system ['touch \"{mark}\"']"
    (stranger / "fall.yaml").write_text(f"{FALL_YAML}x: {text}\n", encoding="utf-8")
    assert call("show", stranger)[0] == 2
    assert not mark.exists()


def test_a_scenario_without_code_needs_no_yes(call, stranger, mark):
    (stranger / "reference.py").unlink()
    assert call(
        "run", stranger, "--engine", "pymunk", "--contact", "default", "--json", "--no-report"
    )[0] in (0, 1)
    assert not mark.exists()


def test_python_says_yes_by_an_argument(stranger, mark):
    with pytest.raises(UntrustedCode, match="add trust once"):
        simcompare.run(stranger, engine="pymunk")
    assert not mark.exists()
    assert simcompare.run(stranger, engine="pymunk", contact="default", trust=True).record.sources
    assert mark.exists()


def test_what_is_shipped_needs_no_yes():
    for name, path in catalogue.files().items():
        assert not catalogue.has_reference(path) or catalogue.reference_of(path), name


def test_a_link_to_a_shipped_scenario_needs_no_yes_but_a_copy_does(tmp_path):
    own = catalogue.find("ball").parent
    (tmp_path / "ball").symlink_to(own)
    assert catalogue.reference_of(tmp_path / "ball" / "ball.yaml")
    shutil.copytree(own, tmp_path / "copy" / "ball")
    with pytest.raises(UntrustedCode):
        catalogue.reference_of(tmp_path / "copy" / "ball" / "ball.yaml")


@pytest.mark.parametrize("name", ["lib.so", "more.pyc", "deep/down/x.py", "x.zip", "linked/a.py"])
def test_all_code_below_the_folder_counts(stranger, tmp_path, name):
    before = trust.digest_of(stranger / "reference.py")
    if name.startswith("linked"):
        (tmp_path / "far").mkdir()
        (stranger / "linked").symlink_to(tmp_path / "far")
    path = stranger / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("x")
    with_it = trust.digest_of(stranger / "reference.py")
    path.write_text("y")
    assert len({before, with_it, trust.digest_of(stranger / "reference.py")}) == 3


def test_a_folder_that_holds_itself_has_an_end(stranger):
    (stranger / "again").symlink_to(stranger)
    os.mkfifo(stranger / "pipe.py")
    assert len(trust.digest_of(stranger / "reference.py")) == 64


@pytest.mark.parametrize(
    ("limit", "most", "said"),
    [
        ("_MOST_PLACES", 15, "15 files beside the scenario, most of them in data"),
        ("_MOST_FILES", 15, "15 files of code beside the scenario, most of them in data"),
        ("_MOST_BYTES", 9000, "of code beside the scenario, most of them in data"),
    ],
)
def test_a_folder_with_too_much_is_refused_and_says_where_it_is(
    stranger, monkeypatch, limit, most, said
):
    (stranger / "data").mkdir()
    for number in range(20):
        (stranger / "data" / f"{number}.py").write_text("x" * 1000)
    monkeypatch.setattr(trust, limit, most)
    with pytest.raises(InputError, match=said):
        trust.digest_of(stranger / "reference.py")


def test_what_is_no_code_does_not_count(stranger, monkeypatch):
    before = trust.digest_of(stranger / "reference.py")
    monkeypatch.setattr(trust, "_MOST_FILES", 10)
    for folder in ("runs/20260101-000000-fall", ".git/objects", ".venv/lib", "env/lib"):
        (stranger / folder).mkdir(parents=True)
        for number in range(20):
            (stranger / folder / f"{number}.json").touch()
    for folder in (".git/objects", ".venv/lib", "env/lib"):
        for number in range(20):
            (stranger / folder / f"{number}.py").touch()
    (stranger / "env" / "pyvenv.cfg").touch()
    assert trust.digest_of(stranger / "reference.py") == before


@pytest.mark.parametrize("place", [".hidden", "env", "__pycache__"])
@pytest.mark.parametrize("way", ["path", "open", "link"])
def test_code_that_was_not_looked_at_does_not_run(stranger, mark, tmp_path, place, way):
    folder = stranger / place
    folder.mkdir()
    (folder / "pyvenv.cfg").touch()
    (folder / "evil.py").write_text(f"import pathlib; pathlib.Path({str(mark)!r}).touch()\n")
    (tmp_path / "way").symlink_to(folder)
    ways = {
        "path": f"import sys; sys.path.insert(0, {str(folder)!r}); import evil",
        "open": f"exec(open({str(folder / 'evil.py')!r}).read())",
        "link": f"import sys; sys.path.insert(0, {str(tmp_path / 'way')!r}); import evil",
    }
    reference = said_yes(stranger, f"{ways[way]}\n{EASY}")
    with pytest.raises(InputError, match=r"evil\.py is none of the code that you said yes to"):
        reference({}, TIMES, {})
    assert not mark.exists()


def test_an_installation_that_runs_is_open_also_in_the_folder(stranger, monkeypatch):
    site = stranger / ".venv" / "site-packages"
    site.mkdir(parents=True)
    (site / "numbers_of_theirs.py").write_text("A = 3.0\n")
    monkeypatch.setattr(sys, "path", [*sys.path, str(site)])
    text = "import numbers_of_theirs as n\ndef reference(p, t):\n    return {'a': n.A * t}\n"
    assert said_yes(stranger, text)({}, TIMES, {})["a"] == pytest.approx([0.0, 3.0])


@pytest.mark.parametrize("when", ["before it is loaded", "before it is imported"])
def test_code_that_changes_after_the_yes_does_not_run(stranger, mark, when):
    helper = stranger / "helper.py"
    helper.write_text("x = 1\n")
    text = (
        f"import sys; sys.path.insert(0, {str(stranger)!r})\n"
        "def reference(parameters, time_s):\n"
        "    if parameters:\n        import helper\n    return {}\n"
    )
    reference = said_yes(stranger, text)
    if when == "before it is imported":
        assert reference({}, TIMES, {}) == {}
    helper.write_text(f"import pathlib; pathlib.Path({str(mark)!r}).touch()\n")
    with pytest.raises(InputError, match="changed since you said yes"):
        reference({"late": 1.0}, TIMES, {})
    assert not mark.exists()


def test_a_yes_is_one_to_what_was_shown(stranger, monkeypatch):
    with pytest.raises(UntrustedCode) as shown:
        catalogue.reference_of(stranger / "fall.yaml")
    (stranger / "helper.py").write_text("x = 'put there while the question stood'\n")
    monkeypatch.setattr(manner, "is_trusting", lambda: True)
    assert trusting.agreed(shown.value)
    with pytest.raises(UntrustedCode):
        catalogue.reference_of(stranger / "fall.yaml")


def test_compiled_code_that_does_not_belong_to_the_source_is_not_used(stranger):
    """Python would take it: its time and size are those of the source."""
    source = stranger / "reference.py"
    source.write_text(source.read_text().replace("write_text", "write_nope"))
    subprocess.run([sys.executable, "-m", "py_compile", source], check=True)
    kept = source.stat()
    source.write_text(EASY.ljust(kept.st_size))
    os.utime(source, ns=(kept.st_atime_ns, kept.st_mtime_ns))
    trust.allow(source)
    reference = catalogue.reference_of(stranger / "fall.yaml")
    assert reference is not None
    assert reference({}, TIMES, {}) == {}


@checked
def limited(reference: Any, *, time_limit_s: float) -> None:
    """A verb, as far as code beside a scenario is concerned."""
    reference({"bad": 1.0}, TIMES, {})


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("import time; time.sleep(600)", "no answer within 0.5 s"),
        ("import os; os.abort()", "killed by SIGABRT"),
        ("import os; os.closerange(3, 4096)", "connection to simcompare is broken"),
        ("return {'a': ['x', 'y']}", "reference"),
        ("return {'a': time_s[:1]}", "1 samples"),
        ("raise SystemExit('bye')", "bye"),
        ("return 3", "TypeError"),
    ],
)
def test_a_reference_that_breaks_is_one_sentence_and_may_be_asked_again(stranger, body, expected):
    source = stranger / "reference.py"
    source.write_text(
        "def reference(parameters, time_s):\n"
        f"    if parameters:\n        {body}\n    return {{'a': 2 * time_s}}\n"
    )
    reference = outside._Outside(source, trust.digest_of(source))
    assert reference({}, TIMES, {})["a"] == pytest.approx([0.0, 2.0])
    # the limit is that of what is called; the first call, which starts a process, had more
    with pytest.raises(InputError, match=expected) as error:
        limited(reference, time_limit_s=0.5 if "sleep" in body else 120.0)
    assert error.value.where == str(source)
    assert reference({}, TIMES, {})["a"] == pytest.approx([0.0, 2.0])


def test_two_threads_get_each_its_own_numbers(stranger):
    source = stranger / "reference.py"
    source.write_text(
        "def reference(parameters, time_s):\n    return {'a': parameters['a'] * time_s}\n"
    )
    reference = outside._Outside(source, trust.digest_of(source))

    def last(number):
        return reference({"a": float(number)}, TIMES, {})["a"][1]

    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(last, range(100))) == list(range(100))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_a_copy_of_this_process_asks_a_process_of_its_own_and_leaves_ours_alone(stranger):
    source = stranger / "reference.py"
    source.write_text("import os\ndef reference(parameters, time_s):\n    return {'a': time_s}\n")
    reference = outside._Outside(source, trust.digest_of(source))
    reference({}, TIMES, {})
    ours = reference._process
    if (copy := os.fork()) == 0:
        with contextlib.suppress(BaseException):
            reference({}, TIMES, {})
            os._exit(int(reference._process is ours or ours.lives))
        os._exit(1)
    assert os.waitpid(copy, 0)[1] == 0
    assert ours.lives
    assert reference({}, TIMES, {})["a"] == pytest.approx(TIMES)
    assert reference._process is ours


WORDS = ("run", "PATH", "--engine", "pymunk", "--contact", "default", "--no-report", "--json")


def answered(stranger: Path, answer: bytes) -> tuple[int, str]:
    """A run on a terminal on which somebody types an answer: its exit code and what was seen."""
    ours, theirs = pty.openpty()
    words = [str(stranger) if word == "PATH" else word for word in WORDS]
    process = subprocess.Popen(
        [sys.executable, "-m", "simcompare", *words, "--out", str(stranger.parent / "runs")],
        stdin=theirs, stdout=subprocess.DEVNULL, stderr=theirs,
    )  # fmt: skip
    os.close(theirs)
    os.write(ours, answer)
    seen = b""
    with contextlib.suppress(OSError):  # the other end is closed
        while more := os.read(ours, 4096):
            seen += more
    os.close(ours)
    return process.wait(), seen.decode()


def test_a_terminal_is_asked_and_its_yes_is_remembered(stranger, mark):
    code, seen = answered(stranger, b"y\n")
    assert code in (0, 1)
    assert trust.digest_of(stranger / "reference.py")[:12] in seen
    assert mark.exists()
    assert trust.require(stranger / "reference.py")


def test_a_no_on_a_terminal_runs_nothing(call, stranger, mark, monkeypatch):
    monkeypatch.setattr(trusting, "_is_on_a_terminal", lambda: True)
    monkeypatch.setattr("sys.stdin", io.StringIO("n\n"))
    code, _, err = call(*(stranger if word == "PATH" else word for word in WORDS))
    assert code == 2
    assert "may all Python files of its folder run" in err
    assert not mark.exists()
