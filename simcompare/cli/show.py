"""``simcompare show``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, manner

if TYPE_CHECKING:
    from simcompare.verbs.show import ScenarioFacts


def show(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    picture: Path = typer.Option(
        None, help="PNG file to write: the scene at several instants of its truth."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Show what a scenario asks, its parameters and tolerances."""
    from simcompare.model.plain import plain
    from simcompare.verbs.show import show as verb

    facts = verb(scenario)
    if picture is not None:
        _draw(facts, picture)
    if as_json:
        console.print_json(plain(facts))
        return
    console.print_wrapped([f"{facts.title} ({facts.name})", facts.question])
    typer.echo()
    _show_parameters(facts)
    typer.echo()
    lines = [f"Truth: {facts.truth}", *_tolerances(facts), *_engines(facts)]
    console.print_wrapped([*_presets(facts), *lines])
    if manner.is_verbose():
        console.print_wrapped(_scene(facts))
    else:
        more = f"simcompare show {facts.name} -v tells the presets, tolerances and the scene."
        console.print_wrapped([more])


def _draw(facts: ScenarioFacts, place: Path) -> None:
    """Writes what the scene looks like."""
    from simcompare.errors import InputError
    from simcompare.reports.render import matplotlib_replay, output

    if place.suffix.lower() != ".png":
        raise InputError("--picture", [f"{place} ends in no .png; a picture is a PNG file"])
    content = matplotlib_replay.png(facts.plot())
    typer.echo(f"Picture: {output.write(place, content, output.MARKS['png'])}", err=True)


def _show_parameters(facts: ScenarioFacts) -> None:
    from simcompare.reports.render import numbers

    table = console.Rows("parameter", "value", "range", "what it is")
    for name, parameter in facts.parameters.items():
        bounds = (parameter.value, parameter.min, parameter.max)
        value, low, high = (numbers.plain(number, 6) for number in bounds)
        unit = f" {parameter.unit}".removesuffix(" 1")
        table.add_row(name, f"{value}{unit}", f"{low}…{high}", parameter.text)
    console.show_table(table)


def _presets(facts: ScenarioFacts) -> Iterator[str]:
    """What --preset takes."""
    if not manner.is_verbose():
        yield from [f"Presets: {', '.join(facts.presets)}"] if facts.presets else []
        return
    for name, preset in facts.presets.items():
        values = ", ".join(f"{key} = {value:g}" for key, value in preset.set.items())
        yield f"--preset {name}: {preset.text} ({values})"


def _tolerances(facts: ScenarioFacts) -> Iterator[str]:
    """What is accepted of each measure, with -v also why."""
    bounds = {name: _bound(facts, name) for name in facts.tolerances}
    if not manner.is_verbose():
        named = ", ".join(f"{name} {bound}" for name, bound in bounds.items())
        yield from [f"Tolerances: {named}"] if bounds else []
        return
    for name, bound in bounds.items():
        yield f"Tolerance of {name}: {bound}. {facts.tolerances[name].reason}"


def _bound(facts: ScenarioFacts, measure: str) -> str:
    tolerance = facts.tolerances[measure]
    if tolerance.relative is not None:
        return f"{100 * tolerance.relative:g} %"
    unit = facts.units.get(measure, "1")
    return f"{tolerance.absolute:.3g} {unit}".removesuffix(" 1")


def _engines(facts: ScenarioFacts) -> Iterator[str]:
    """Which engines can run it, and what the others lack."""
    able = [name for name, lacking in facts.engines.items() if not lacking]
    yield f"Engines that can run it: {', '.join(able) or 'none'}"
    for name, lacking in facts.engines.items():
        if lacking:
            yield f"  {name} lacks {', '.join(lacking)}"


def _scene(facts: ScenarioFacts) -> Iterator[str]:
    """What is in the scene, and what is recorded."""
    world = facts.world
    more = f", each of {world.substeps} engine steps" if world.substeps > 1 else ""
    yield (
        f"World: gravity {list(world.gravity_m_s2)} m/s²,"
        f" {world.duration_s:g} s in steps of {world.step_s:g} s{more}"
    )
    for part, parts in (
        ("Body", facts.bodies), ("Joint", facts.joints), ("Actuator", facts.actuators),
        ("Sensor", facts.sensors),
    ):  # fmt: skip
        yield from (f"{part} {name}: {words}" for name, words in parts.items())
    yield f"Signals: {', '.join(facts.signals)}"
    yield f"Needs: {', '.join(facts.needs)}"
    for engine, variants in facts.variants.items():
        if variants and not facts.engines[engine]:
            yield f"Variants of {engine}: {', '.join(variants)}"
    yield f"File: {facts.file}"
