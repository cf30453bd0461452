"""``simcompare show``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console

if TYPE_CHECKING:
    from simcompare.verbs.show import ScenarioFacts


def show(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Show what a scenario asks, its parameters and tolerances."""
    from simcompare.model.plain import plain
    from simcompare.verbs.show import show as verb

    facts = verb(scenario)
    if as_json:
        console.print_json(plain(facts))
        return
    typer.echo(f"{facts.title} ({facts.name}): {facts.question}")
    _show_parameters(facts)
    for name, preset in facts.presets.items():
        values = ", ".join(f"{key} = {value:g}" for key, value in preset.set.items())
        typer.echo(f"--preset {name}: {preset.text}\n    {values}")
    world = facts.world
    typer.echo(
        f"World: gravity {list(world.gravity_m_s2)} m/s²,"
        f" {world.duration_s:g} s in steps of {world.step_s:g} s"
        + (f", each of {world.substeps} engine steps" if world.substeps > 1 else "")
    )
    for part, parts in (
        ("Body", facts.bodies), ("Joint", facts.joints), ("Actuator", facts.actuators),
        ("Sensor", facts.sensors),
    ):  # fmt: skip
        for name, words in parts.items():
            typer.echo(f"{part} {name}: {words}")
    typer.echo(f"Signals: {', '.join(facts.signals)}")
    typer.echo(f"Needs: {', '.join(facts.needs)}")
    for engine, lacking in facts.engines.items():
        able = f"lacks {', '.join(lacking)}" if lacking else "can run it"
        if facts.variants[engine] and not lacking:
            able += f"; variants: {', '.join(facts.variants[engine])}"
        typer.echo(f"  {engine}: {able}")
    typer.echo(f"Truth: {facts.truth}")
    for measure, tolerance in facts.tolerances.items():
        bound = tolerance.relative or tolerance.absolute
        kind = "relative" if tolerance.relative else "absolute"
        typer.echo(f"Tolerance of {measure}: {bound:g} {kind}. {tolerance.reason}")


def _show_parameters(facts: ScenarioFacts) -> None:
    table = console.Rows("parameter", "value", "unit", "from", "to", "what it is")
    for name, parameter in facts.parameters.items():
        value, low, high = (f"{n:.6g}" for n in (parameter.value, parameter.min, parameter.max))
        table.add_row(name, value, parameter.unit, low, high, parameter.text)
    console.show_table(table)
