"""The command line: one small file a verb; it parses, calls the API and prints.

Nothing heavy is imported here: ``--help``, ``list`` and completion must answer at once.
"""

from __future__ import annotations

import errno
import functools
import gc
import io
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer

from simcompare import arguments
from simcompare.cli import examples, manner, misplaced
from simcompare.errors import OutputError, SimcompareError

#: errors of the system that mean that a disk takes no more
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
#: new objects after which Python looks for circles of them
_COLLECTED = 100_000


class _Verbs(manner.Group):
    """Turns our own errors into one sentence on stderr and the right exit code."""

    def make_context(self, *words: Any, **extra: Any) -> Any:  # noqa: ANN401
        manner.reset()
        with _readers_may_leave():
            return super().make_context(*words, **extra)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:  # noqa: ANN401
        name, *rest = args
        if self.get_command(ctx, name) is None and not ctx.resilient_parsing:
            raise misplaced.unknown(name, rest, self.list_commands(ctx))
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401
        try:
            with _readers_may_leave(), arguments.given_as_options():
                return super().invoke(ctx)
        except SimcompareError as error:
            manner.show_error(error)
            raise typer.Exit(error.exit_code) from None
        except KeyboardInterrupt:
            typer.echo("simcompare: interrupted", err=True)
            raise typer.Exit(130) from None
        finally:
            manner.reset()


@contextmanager
def _readers_may_leave() -> Iterator[None]:
    """The reader of a pipe may go away, as in ``simcompare list | head -1``; that is no failure.

    A disk that is full, to which the output goes, is one.
    """
    try:
        yield
    except BrokenPipeError:
        _forget_stdout()
        raise typer.Exit(0) from None
    except OSError as error:
        if error.errno not in _FULL:
            raise
        _forget_stdout()
        text = f"the output cannot be written ({error.strerror}); free some space"
        typer.echo(f"simcompare: {text}", err=True)
        raise typer.Exit(OutputError.exit_code) from None


def _forget_stdout() -> None:
    """What is not printed yet goes nowhere, or Python would complain when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


app = typer.Typer(
    name="simcompare",
    cls=_Verbs,
    help="One scene, many physics engines, and the truth.",
    epilog="Begin with: simcompare run ball\n\n"
    "Exit codes: 0 fine, 1 a tolerance failed, 2 usage or file, 3 engine missing or broken.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@app.callback(invoke_without_command=True)
def _version(
    version: bool = typer.Option(False, "--version", help="Show the version and exit."),
) -> None:
    if version:
        import importlib.metadata

        typer.echo(importlib.metadata.version("simcompare"))
        raise typer.Exit


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def _verb(name: str, function: Callable[..., None], **settings: Any) -> None:  # noqa: ANN401
    app.command(name, cls=misplaced.Verb, epilog=examples.epilog(name), **settings)(function)


@functools.cache
def register() -> None:
    """Names the verbs; a verb more is a line more."""
    from simcompare.cli import (
        allan,
        calibrate,
        characterize,
        compare,
        data,
        doctor,
        estimate,
        explain,
        export,
        fit,
        gauge,
        import_,
        list_,
        report,
        run,
        runs,
        sensor,
        show,
        tune,
        uncertainty,
        validate,
    )

    _verb("run", run.run)
    _verb("list", list_.list_)
    _verb("show", show.show)
    _verb("doctor", doctor.doctor)
    _verb("explain", explain.explain)
    _verb("report", report.report)
    _verb("compare", compare.compare)
    _verb("runs", runs.runs)
    _verb("calibrate", calibrate.calibrate)
    _verb("characterize", characterize.characterize)
    _verb("sensor", sensor.sensor)
    _verb("estimate", estimate.estimate)
    _verb("gauge", gauge.gauge)
    _verb("allan", allan.allan)
    _verb("export", export.export)
    _verb("import", import_.import_)
    _verb("fit", fit.fit)
    # an engine's own numbers are options too, by the names that it has for them
    foreign = {"allow_extra_args": True, "ignore_unknown_options": True}
    _verb("tune", tune.tune, context_settings=foreign)
    _verb("validate", validate.validate)
    _verb("uncertainty", uncertainty.uncertainty)
    app.add_typer(data.data, name="data")


class _Forgiving(io.FileIO):
    """A file that loses what it cannot take: where errors cannot be told, exit codes still hold."""

    def write(self, data: Any) -> int:  # noqa: ANN401
        try:
            return int(super().write(data))
        except OSError:
            return len(data)


def _keep_streams() -> None:
    """Streams that can always be written to, also where the caller has closed them."""
    sys.stdout = sys.stdout or Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    given = sys.__stderr__
    if given is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    elif sys.stderr is given:
        raw = _Forgiving(given.fileno(), "w", closefd=False)
        sys.stderr = io.TextIOWrapper(io.BufferedWriter(raw), given.encoding, line_buffering=True)


def main() -> None:
    """Entry point of the ``simcompare`` command."""
    # a command makes many lasting objects and few circles: seldom looked for, these cost less
    gc.set_threshold(_COLLECTED)
    # an ended terminal or batch job stops a run as Ctrl-C does: workers ended, results kept
    signal.signal(signal.SIGTERM, _interrupt)
    register()
    _keep_streams()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal without the signs for ± and ζ
            stream.reconfigure(errors="replace")
    app()
