"""``simcompare list``."""

from __future__ import annotations

import typer

from simcompare.cli import complete, console


def list_(
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Name all scenarios, engines and published measurements."""
    from simcompare.engine import elsewhere, engines
    from simcompare.scenarios import catalogue

    scenarios = catalogue.summaries()
    names = engines.names()
    not_here, measurements = elsewhere.names(names), complete.tables("")
    if as_json:
        console.print_json(
            {
                "scenarios": [{"name": name, "summary": text} for name, text in scenarios],
                "engines": names,
                "variants": {name: [*engines.quick_variants(name)] for name in names},
                "engines_elsewhere": not_here,
                "measurements": measurements,
            }
        )
        return
    typer.echo("Scenarios (simcompare show NAME):")
    width = max((len(name) for name, _ in scenarios), default=0)
    for name, text in scenarios:
        typer.echo(f"  {name:<{width}} {text}")
    typer.echo("Engines (simcompare doctor):")
    typer.echo(f"  {', '.join(names)}")
    for name in names:
        if variants := engines.quick_variants(name):
            typer.echo(f"  variants: {', '.join(f'{name}:{one}' for one in variants)}")
    typer.echo("Engines that cannot run here (why, and what to do: simcompare doctor):")
    typer.echo(f"  {', '.join(not_here)}")
    typer.echo("Published measurements (simcompare run SCENARIO --against NAME):")
    for name in measurements:
        typer.echo(f"  {name}")
