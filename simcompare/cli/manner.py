"""How much is told: -q, -v and --debug, which every verb takes and which may stand before it."""

from __future__ import annotations

import logging
import os
import sys
import traceback
from pathlib import Path
from typing import Any, TextIO

import typer
from typer.core import TyperGroup

#: what all of simcompare tells those who search for a fault
_LOG = logging.getLogger("simcompare")

_wanted: set[str] = set()
_stdout: list[TextIO] = []


def is_quiet() -> bool:
    """Whether nothing but errors and what was asked for as text is printed."""
    return "quiet" in _wanted


def is_verbose() -> bool:
    """Whether all that is known is printed."""
    return "verbose" in _wanted


def is_trusting() -> bool:
    """Whether code beside a scenario may run."""
    return "trust" in _wanted


def out() -> TextIO:
    """Where text goes that was asked for, such as JSON, also where all else is quiet."""
    return _stdout[0] if _stdout else sys.stdout


def show_error(error: Exception) -> None:
    """Prints an error in a sentence; below ``--debug`` first where it comes from."""
    if "debug" in _wanted:
        traceback.print_exception(error)
    typer.echo(f"simcompare: {error}", err=True)


def reset() -> None:
    """Forgets what the last command was told."""
    _wanted.clear()
    _LOG.handlers.clear()
    if _stdout:
        sys.stdout.close()
        sys.stdout = _stdout.pop()


class Group(TyperGroup):
    """Verbs which all take the options of this module."""

    def __init__(self, **settings: Any) -> None:  # noqa: ANN401
        super().__init__(**settings)
        own = [one for one in self.commands.values() if not isinstance(one, TyperGroup)]
        for command in (self, *own):
            takes_scenario = any(param.name == "scenario" for param in command.params)
            command.params.extend(_options() + (_of_scenarios() if takes_scenario else []))


def _take(param: typer.CallbackParam, value: bool) -> None:
    if not value or param.name in _wanted:
        return
    _wanted.add(str(param.name))
    if param.name == "quiet":
        _stdout.append(sys.stdout)
        sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    elif param.name == "debug":
        _LOG.addHandler(logging.StreamHandler())
        _LOG.setLevel(logging.DEBUG)


def _flag(*names: str, help: str) -> Any:  # noqa: ANN401
    return typer.Option(False, *names, help=help, callback=_take, expose_value=False)


def _options() -> list[Any]:
    """The options as the parser wants them."""
    one = typer.Typer(add_completion=False)

    @one.command()
    def _(
        quiet: bool = _flag("--quiet", "-q", help="Print nothing but errors."),
        verbose: bool = _flag("--verbose", "-v", help="Print all that is known."),
        debug: bool = _flag("--debug", help="Print where errors come from, and engines' output."),
    ) -> None: ...

    return typer.main.get_command(one).params


def _of_scenarios() -> list[Any]:
    """Those of verbs that take a scenario."""
    one = typer.Typer(add_completion=False)

    @one.command()
    def _(
        trust: bool = _flag("--trust", help="Run Python files beside the scenario, now and later."),
    ) -> None: ...

    return typer.main.get_command(one).params
