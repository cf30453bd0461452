"""``simcompare doctor``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from simcompare.cli import console

if TYPE_CHECKING:
    from collections.abc import Sequence

    from simcompare.engine.elsewhere import Elsewhere


def doctor(
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Test every engine, and say what is missing."""
    from simcompare.engine import elsewhere
    from simcompare.engine.helps import known
    from simcompare.model.plain import plain
    from simcompare.running import doctor as examination
    from simcompare.running.jobs import FAILED

    diagnoses = examination.doctor()
    not_here = elsewhere.others([diagnosis.engine for diagnosis in diagnoses])
    if as_json:
        console.print_json(
            {
                "engines": [
                    {"engine": one.engine, "status": one.status, "message": one.message,
                     **plain(one.facts)}
                    for one in diagnoses
                ],
                "engines_elsewhere": [engine.to_dict() for engine in not_here],
            }
        )  # fmt: skip
    else:
        for diagnosis in diagnoses:
            facts = diagnosis.facts
            named = f"{diagnosis.engine} {facts.version}" if facts.version else diagnosis.engine
            typer.echo(f"{named}: {diagnosis.message}")
            if facts.features:
                typer.echo(f"  can do: {', '.join(facts.features)}")
            for limit in facts.known_limits:
                typer.echo(f"  limit: {limit.text} [{limit.reference}]")
            if facts.mapping:
                typer.echo(f"  mapping: {facts.mapping}")
            if facts.helps:
                typer.echo(f"  helps: {known(facts.helps)}")
            for one in facts.variants:
                name = f"{diagnosis.engine}:{one.name}"
                typer.echo(f"  variant {name}: {one.text} [{one.reference}]")
        _show_elsewhere(not_here)
    raise typer.Exit(3 if any(diagnosis.status == FAILED for diagnosis in diagnoses) else 0)


def _show_elsewhere(engines: Sequence[Elsewhere]) -> None:
    """Engines that cannot run here: why, how a scene gets there, and how results come back."""
    from simcompare.engine import elsewhere

    typer.echo("\nEngines that cannot run here")
    typer.echo(elsewhere.UNTRIED)
    for engine in engines:
        typer.echo(f"{engine.name} ({engine.title})")
        typer.echo(f"  why: {engine.why} [{engine.why_reference}]")
        for line in engine.lines():
            typer.echo(f"  {line}")
    typer.echo("For all of these:")
    for sentence, commands in elsewhere.BACK:
        typer.echo(f"  {sentence}")
        for command in commands:
            typer.echo(f"    {command}")
