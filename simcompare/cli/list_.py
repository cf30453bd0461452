"""``simcompare list``."""

from __future__ import annotations

import typer


def list_(
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Scenarios, engines and published measurements, a line each."""
    from simcompare import catalogue, engines

    scenarios = catalogue.summaries()
    if as_json:
        from simcompare.cli.console import print_json

        print_json(
            {
                "scenarios": [{"name": name, "summary": text} for name, text in scenarios],
                "engines": engines.names(),
                "measurements": _measurements(),
            }
        )
        return
    typer.echo("Scenarios (simcompare show NAME):")
    width = max((len(name) for name, _ in scenarios), default=0)
    for name, text in scenarios:
        typer.echo(f"  {name:<{width}} {text}")
    typer.echo("Engines (simcompare doctor):")
    typer.echo(f"  {', '.join(engines.names())}")
    typer.echo("Published measurements (simcompare run SCENARIO --against NAME):")
    for name in _measurements():
        typer.echo(f"  {name}")


def _measurements() -> list[str]:
    from simcompare.cli.complete import tables

    return tables("")
