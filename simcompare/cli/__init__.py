"""The command line: one small file a verb; it parses, calls the API and prints.

Nothing heavy is imported here: ``--help``, ``list`` and completion must answer at once.
"""

from __future__ import annotations

import functools
import gc
from collections.abc import Callable
from typing import Any

import typer

from simcompare import arguments
from simcompare.cli import examples, manner, misplaced, streams
from simcompare.errors import INTERRUPTED, SimcompareError
from simcompare.running import interruption

#: new objects after which Python looks for circles of them
_COLLECTED = 100_000


class _Verbs(manner.Group):
    """Turns our own errors into one sentence on stderr and the right exit code."""

    def make_context(self, *words: Any, **extra: Any) -> Any:  # noqa: ANN401
        manner.reset()
        try:
            with streams.readers_may_leave():
                return super().make_context(*words, **extra)
        except KeyboardInterrupt:
            raise _interrupted() from None

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:  # noqa: ANN401
        name, *rest = args
        if self.get_command(ctx, name) is None and not ctx.resilient_parsing:
            raise misplaced.unknown(name, rest, self.list_commands(ctx))
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: Any) -> Any:  # noqa: ANN401
        try:
            with streams.readers_may_leave(), arguments.given_as_options():
                return super().invoke(ctx)
        except SimcompareError as error:
            manner.show_error(error)
            raise typer.Exit(error.exit_code) from None
        except KeyboardInterrupt as stop:
            raise _interrupted(str(stop)) from None
        except Exception as error:
            # an import that is cut short ends in any error
            if isinstance(error, typer.Exit) or not interruption.came():
                raise
            raise _interrupted() from None
        finally:
            manner.reset()


def _interrupted(more: str = "") -> typer.Exit:
    """Says so; gives what ends the command."""
    typer.echo(f"simcompare: interrupted{more and '; '}{more}", err=True)
    return typer.Exit(INTERRUPTED)


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
        lab,
        list_,
        report,
        robot,
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
    _verb("robot", robot.robot)
    _verb("import", import_.import_)
    _verb("fit", fit.fit)
    # an engine's own numbers are options too, by the names that it has for them
    foreign = {"allow_extra_args": True, "ignore_unknown_options": True}
    _verb("tune", tune.tune, context_settings=foreign)
    _verb("validate", validate.validate)
    _verb("uncertainty", uncertainty.uncertainty)
    _verb("lab", lab.lab)
    app.add_typer(data.data, name="data")


def main() -> None:
    """What the command does; it is begun in ``simcompare/__main__.py``."""
    # a command makes many lasting objects and few circles: seldom looked for, these cost less
    gc.set_threshold(_COLLECTED)
    interruption.take_over()
    try:
        register()
        streams.keep()
        app()
    except KeyboardInterrupt:
        raise SystemExit(_interrupted().exit_code) from None
    finally:
        interruption.leave()
