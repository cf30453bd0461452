"""What ``simcompare fit`` prints of a fit by tosses."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare import notation
from simcompare.cli import console

if TYPE_CHECKING:
    from simcompare.results.records.fit_tosses import TossErrors, TossFit, TossMean
    from simcompare.results.run import Run


def show(result: Run, found: TossFit, written: Path | None) -> None:
    """Prints what was found, engine by engine, and where it is stored."""
    for sentence in found.told:
        typer.echo(sentence)
    if any(source.parameters for source in found.sources):
        _print_engines(found)
    for source in found.sources:
        if not source.parameters:
            typer.echo(f"{source.name}: {source.failure}")
    typer.echo("")
    for sentence in found.sentences:
        typer.echo(sentence)
    if result.folder is not None:
        able = any(source.parameters for source in found.sources)
        place = shlex.quote(str(result.folder / "fit.json"))
        step = f"--step {found.valid.engine_step_s!r}s"
        reuse = f"; reuse it with --contact {place} {step}" if able else ""
        typer.echo(f"Stored in {result.folder}{reuse}")
    if written is not None:
        typer.echo(f"Report: {written}")


def _print_engines(found: TossFit) -> None:
    made = console.Rows(
        "engine", "contact", *found.unknowns, "corners, fitted [%]", "position, held out [%]",
        "rotation, held out [°]", "simulations", "seconds",
    )  # fmt: skip
    for source in found.sources:
        if not source.parameters:
            made.add_row(source.name, source.contact, source.status)
            continue
        own = [source.parameters[name] for name in found.unknowns]
        made.add_row(
            f"{source.name} {source.version or ''}", source.contact,
            *(notation.number(one.value, one.u) for one in own), f"{source.cost:.2f}",
            *_held(source.holdout), str(source.simulations), f"{source.wall_s:.2f}",
        )  # fmt: skip
    console.show_table(made)
    typer.echo(
        "Lengths in % of the width; means over tosses with their 95 % intervals. corners: distance"
        " of the eight corners, which was fitted."
    )


def _held(own: TossErrors | None) -> tuple[str, str]:
    return ("", "") if own is None else (_mean(own.position), _mean(own.rotation))


def _mean(own: TossMean) -> str:
    low, high = own.interval95
    return f"{own.mean:.2f} ({low:.2f} to {high:.2f})"
