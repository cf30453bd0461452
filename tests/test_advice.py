"""Advice that is printed works when it is pasted: the verb that prints it has the option."""

from __future__ import annotations

import ast
import re
import shlex
import unittest.mock
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
import typer.main
from typer.core import TyperGroup

from simcompare import cli
from simcompare.engine import engines
from simcompare.hardware.raw import IMPORT

ROOT = Path(__file__).parent.parent
#: place of a message -> the verbs that may print it; the longest place that fits counts
PRINTED_BY = {
    "hardware/recordings/bounce_table.py": {"run", "fit"},
    "hardware/conditioning/strict.py": {"import", "validate"},
    "hardware": {"import", "fit", "validate"},
    "simcompare/inference": {"fit", "validate"},
    "simcompare/fitting": {"fit"},
    "simcompare/validation": {"validate"},
    "simcompare/tuning": {"tune"},
    "simcompare/characterization": {"characterize"},
    "simcompare/exporters": {"export"},
    "simcompare/engine/assist.py": {"run", "fit"},
    "simcompare/engine": {"run", "fit", "validate", "characterize", "tune"},
    "simcompare/comparison": {"run", "tune", "fit", "validate", "characterize", "export"},
    "simcompare/model": {"run", "fit", "validate", "characterize"},
    "simcompare/running": {"run", "fit", "validate", "characterize", "tune"},
    "simcompare/results/fit_file.py": {"run", "export"},
    "simcompare/results": {"run", "fit", "validate", "characterize"},
    "simcompare/verbs/run.py": {"run"},
    "simcompare/verbs/runs.py": {"runs"},
    "simcompare/verbs/fit": {"fit"},
    "simcompare/verbs/tune": {"tune"},
    "simcompare/verbs/validate": {"validate"},
    "simcompare/verbs/characterize": {"characterize"},
    "simcompare/verbs/levels.py": {"run"},
    "simcompare/verbs/request.py": {"run", "fit", "validate"},
    "simcompare/verbs/sensor": {"sensor"},
    "reports/sensor": {"sensor"},
    "simcompare/estimation": {"estimate"},
    "simcompare/verbs/estimate": {"estimate"},
    "reports/estimation": {"estimate"},
    "simcompare/cli/export.py": {"export"},
    "simcompare/cli/fit": {"fit", "run"},
    "simcompare/cli/tune": {"tune"},
    "simcompare/cli/runs.py": {"runs"},
    "simcompare/cli/console.py": {"run", "fit", "validate", "export", "tune"},
    "reports/fit": {"fit"},
    "backends": {"run", "fit", "validate", "characterize", "tune"},
    "scenarios": {"run", "fit", "validate", "export", "tune"},
}
#: options of programs, and those of tune that are called as engines call their numbers
FOREIGN = {
    "--version",
    *(f"--{getattr(engines.get(name), 'typed_as', '')}" for name in engines.names()),
}
#: places that put a command for another verb together
ELSEWHERE = (
    "reports/run/reproduce.py", "reports/characterization/page.py", "simcompare/verbs/request.py",
    "simcompare/cli/fit_tables.py", "simcompare/cli/toss_tables.py",
)  # fmt: skip
_OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*[a-z]")
_COMMAND = re.compile(r"simcompare ([a-z]+)((?: (?!simcompare)[^;,:)\n]+)?)")
#: commands of other programs
_OTHERS = re.compile(r"\b\w+\.py [^;]*")


@cache
def options() -> dict[str, frozenset[str]]:
    """Verb -> its options."""
    with unittest.mock.patch("typer.Typer.__call__"):
        cli.main()  # puts all verbs together
    group = typer.main.get_command(cli.app)
    assert isinstance(group, TyperGroup)
    found = {}
    for name, verb in group.commands.items():
        names = {o for p in verb.params for o in (*p.opts, *getattr(p, "secondary_opts", ()))}
        found[name] = frozenset({*names, "--help"})
    return found


def messages() -> list[tuple[str, str]]:
    """Place and text of every string with an option in it, but not of docstrings."""
    found = []
    for top in ("simcompare", "hardware", "reports", "backends", "scenarios"):
        for path in sorted((ROOT / top).rglob("*.py")):
            place = str(path.relative_to(ROOT))
            if path.resolve() == path and place not in ELSEWHERE:
                tree = ast.parse(path.read_text(encoding="utf-8"))
                found += [(place, text) for text in _texts(tree) if "--" in text]
    return found


def _texts(tree: ast.AST) -> Iterator[str]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            continue  # a docstring
        if isinstance(node, ast.JoinedStr):
            yield "".join(map(_held, node.values))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        else:
            yield from _texts(node)


def _held(part: ast.expr) -> str:
    """A part of a text: what it says, the command that is named so, or a letter for a value."""
    if isinstance(part, ast.FormattedValue):
        return IMPORT if ast.unparse(part.value) == "IMPORT" else "X"
    return str(ast.literal_eval(part))


def printed_by(place: str) -> set[str]:
    fitting = [key for key in PRINTED_BY if place.startswith(key)]
    return PRINTED_BY[max(fitting, key=len)] if fitting else set(options())


def faults(place: str, text: str) -> list[str]:
    """Options in a message that the verb, by which it is printed or that it names, has not."""
    wrong, text = [], _OTHERS.sub("", text)
    for verb, rest in _COMMAND.findall(text):
        if verb in options():
            named = {*_OPTION.findall(rest)} - FOREIGN
            unknown = [option for option in named if option not in options()[verb]]
            wrong += [f"{verb} has no {option}" for option in unknown]
    rest = _COMMAND.sub("", text)
    for option in _OPTION.findall(rest):
        lacking = [v for v in sorted(printed_by(place)) if option not in options()[v]]
        # what the user typed may be named by the verbs that have it
        everywhere = place not in PRINTED_BY and not any(place.startswith(k) for k in PRINTED_BY)
        if option in FOREIGN or (everywhere and len(lacking) < len(options())):
            continue
        if text.strip() == option or text.startswith(option):  # where it stands: it was typed
            lacking = lacking if len(lacking) == len(printed_by(place)) else []
        wrong += [f"{verb} has no {option}" for verb in lacking]
    return wrong


def test_every_option_in_a_message_exists_where_it_is_printed():
    found = [(place, text, faults(place, text)) for place, text in messages()]
    assert len(found) > 60
    assert [one for one in found if one[2]] == []


@pytest.mark.parametrize(
    ("place", "text", "wrong"),
    [
        ("hardware/logs/a.py", "name it with --as", ["fit has no --as", "validate has no --as"]),
        ("hardware/logs/a.py", "name it: simcompare import LOG --as csv", []),
        ("hardware/logs/a.py", "simcompare import LOG --like csv", ["import has no --like"]),
        ("hardware/logs/a.py", "say it in a mapping file (--map)", []),
    ],
)
def test_an_option_that_is_not_there_is_found(place, text, wrong):
    assert faults(place, text) == wrong


@pytest.mark.parametrize(
    ("name", "content"),
    [("notes.md", "Words\n\nand more\n"), ("a b.bin", "\0\1\2\0" * 50)],
)
@pytest.mark.parametrize("verb", [("import",), ("fit", "ball", "-r"), ("validate", "ball", "-r")])
def test_the_command_that_a_message_gives_is_understood(
    call, tmp_path, monkeypatch, name, content, verb
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(content, encoding="utf-8")
    code, _, err = call(*verb, name)
    assert code == 2
    command = re.search(r"simcompare (import .* --as) FORMAT", err)
    assert command, err
    words = shlex.split(command[1])
    assert words == ["import", name, "--as"]
    # it is read as what the user calls it, and that is another fault
    code, _, err = call(*words, "csv")
    assert code == 2
    assert "no such option" not in err.lower()
    assert name in err
