"""``simcompare list``."""

from __future__ import annotations

import typer


def list_(
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Scenarios, engines and published measurements, a line each."""
    from simcompare.engine import elsewhere, engines
    from simcompare.scenarios import catalogue

    scenarios = catalogue.summaries()
    names = engines.names()
    not_here = elsewhere.names(names)
    if as_json:
        from simcompare.cli.console import print_json

        print_json(
            {
                "scenarios": [{"name": name, "summary": text} for name, text in scenarios],
                "engines": names,
                "variants": {name: [*engines.quick_variants(name)] for name in names},
                "engines_elsewhere": not_here,
                "measurements": _measurements(),
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
    for name in _measurements():
        typer.echo(f"  {name}")


def _measurements() -> list[str]:
    from simcompare.cli.complete import tables

    return tables("")
