"""``simcompare list``."""

from __future__ import annotations

from collections.abc import Sequence

import typer

from simcompare.cli import complete, console, manner


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
    _show(scenarios, names, not_here, measurements)


def _show(
    scenarios: Sequence[tuple[str, str]],
    names: Sequence[str],
    not_here: Sequence[str],
    measurements: Sequence[str],
) -> None:
    from simcompare.engine import engines

    typer.echo("Scenarios (simcompare show NAME tells more)")
    table = console.Rows("name", "question" if manner.is_verbose() else "title")
    for name, text in scenarios:
        table.add_row(name, text if manner.is_verbose() else text.partition(":")[0])
    console.show_table(table)
    typer.echo()
    lines = [
        f"Engines: {', '.join(names)} (simcompare doctor tests them)",
        f"Not to be run here: {', '.join(not_here)} (simcompare doctor -v tells why)",
        f"Measurements for --against: {', '.join(measurements)}",
    ]
    if manner.is_verbose():
        variants = [f"{name}:{one}" for name in names for one in engines.quick_variants(name)]
        lines.append(f"Variants for --engine: {', '.join(variants)}")
    else:
        lines.append("simcompare list -v tells the questions, and variants of engines.")
    console.print_wrapped(lines)
