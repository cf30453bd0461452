"""``simcompare show``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import typer

from simcompare.cli import complete

if TYPE_CHECKING:
    from simcompare.engine.features import Feature
    from simcompare.model.scenario import Joint
    from simcompare.scenarios.scenario_file import ScenarioFile


def show(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """One scenario: question, parameters and bounds, presets, world, truth, tolerances, needs."""
    from simcompare.cli import console
    from simcompare.scenarios import catalogue

    file = catalogue.load(scenario)
    facts = _facts(file)
    if as_json:
        console.print_json(facts)
        return
    typer.echo(f"{facts['title']} ({facts['name']}): {facts['question']}")
    _show_parameters(facts)
    for name, preset in facts["presets"].items():
        values = ", ".join(f"{key} = {value:g}" for key, value in preset["set"].items())
        typer.echo(f"--preset {name}: {preset['text']}\n    {values}")
    world = facts["world"]
    typer.echo(
        f"World: gravity {world['gravity_m_s2']} m/s²,"
        f" {world['duration_s']:g} s in steps of {world['step_s']:g} s"
        + (f", each of {world['substeps']} engine steps" if world["substeps"] > 1 else "")
    )
    for part in ("body", "joint", "actuator", "sensor"):
        for name, words in facts[_PLURALS[part]].items():
            typer.echo(f"{part.capitalize()} {name}: {words}")
    typer.echo(f"Signals: {', '.join(facts['signals'])}")
    typer.echo(f"Needs: {', '.join(facts['needs'])}")
    for engine, lacking in facts["engines"].items():
        said = f"lacks {', '.join(lacking)}" if lacking else "can run it"
        if facts["variants"][engine] and not lacking:
            said += f"; variants: {', '.join(facts['variants'][engine])}"
        typer.echo(f"  {engine}: {said}")
    typer.echo(f"Truth: {facts['truth']}")
    for measure, tolerance in facts["tolerances"].items():
        bound = tolerance["relative"] or tolerance["absolute"]
        kind = "relative" if tolerance["relative"] else "absolute"
        typer.echo(f"Tolerance of {measure}: {bound:g} {kind}. {tolerance['reason']}")


def _facts(file: ScenarioFile) -> dict[str, Any]:
    from simcompare import units
    from simcompare.engine import engines
    from simcompare.engine.features import needs
    from simcompare.scenarios import catalogue
    from simcompare.scenarios.scenario_checks import recorded_signals

    scenario = file.resolve()
    wanted = needs(scenario)
    plain = scenario.model_dump(mode="json")
    return {
        "name": scenario.name,
        "title": scenario.title,
        "question": scenario.question,
        "file": str(file.path),
        "parameters": {
            name: {**parameter.model_dump(), "unit": units.symbol(units.unit_of(name))}
            for name, parameter in file.parameters.items()
        },
        "presets": {name: preset.model_dump(mode="json") for name, preset in file.presets.items()},
        "world": plain["world"],
        "bodies": {
            name: "fixed" if body.fixed else f"{body.mass_kg:g} kg at {list(body.position_m)} m"
            for name, body in scenario.bodies.items()
        },
        "joints": {name: _joint_words(joint) for name, joint in scenario.joints.items()},
        "actuators": {
            name: f"{actuator.type} on {actuator.joint}, input {actuator.input}"
            f" ({scenario.inputs[actuator.input].signal})"
            for name, actuator in scenario.actuators.items()
        },
        "sensors": {
            name: f"{sensor.type} of {sensor.body or sensor.joint or '-'.join(sensor.pair or ())}"
            for name, sensor in scenario.sensors.items()
        },
        "signals": recorded_signals(scenario),
        "needs": sorted(wanted.required | wanted.optional),
        "engines": {name: _lacking(name, wanted.required) for name in engines.names()},
        "variants": {name: [*engines.quick_variants(name)] for name in engines.names()},
        "truth": "closed form or reference in reference.py"
        if catalogue.reference_of(file.path)
        else "none: engines are compared with each other only",
        "tolerances": plain["tolerances"],
    }


_PLURALS = {"body": "bodies", "joint": "joints", "actuator": "actuators", "sensor": "sensors"}


def _joint_words(joint: Joint) -> str:
    own = {
        part: value
        for part in ("stiffness", "damping", "friction", "armature", "rate")
        if (value := getattr(joint, part))
    }
    axis = "" if joint.type in ("fixed", "ball") else f" about {list(joint.axis)}"
    axis = axis.replace("about", "along") if joint.type == "slider" else axis
    more = "".join(f", {part} {value:g}" for part, value in own.items())
    return f"{joint.type}{axis}, {joint.child} on {joint.parent}{more}"


def _lacking(engine: str, wanted: frozenset[Feature]) -> list[str]:
    """Features that an engine lacks, or the one reason why it cannot be asked."""
    from simcompare.engine import engines
    from simcompare.errors import SimcompareError

    try:
        return sorted(wanted - engines.get(engine).features)
    except SimcompareError as error:
        return [str(error)]


def _show_parameters(facts: dict[str, Any]) -> None:
    from simcompare.cli import console

    made = console.table("parameter", "value", "unit", "from", "to", "what it is")
    for name, parameter in facts["parameters"].items():
        cells = (f"{parameter[key]:.6g}" for key in ("value", "min", "max"))
        value, low, high = cells
        made.add_row(name, value, parameter["unit"], low, high, parameter["text"])
    console.show_table(made)
