"""``simcompare doctor``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from simcompare.cli import console, manner

if TYPE_CHECKING:
    from collections.abc import Sequence

    from simcompare.engine.elsewhere import Elsewhere
    from simcompare.running.doctor import Diagnosis


def doctor(
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Test every engine, and say what is missing."""
    from simcompare.engine import elsewhere
    from simcompare.model.plain import plain
    from simcompare.running import doctor as examination
    from simcompare.running.jobs import FAILED

    with console.progress_bar("doctor") as progress:
        diagnoses = examination.doctor(progress)
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
    elif manner.is_verbose():
        for diagnosis in diagnoses:
            _show_all(diagnosis)
        _show_elsewhere(not_here)
    else:
        _show(diagnoses, not_here)
    raise typer.Exit(3 if any(diagnosis.status == FAILED for diagnosis in diagnoses) else 0)


def _show(diagnoses: Sequence[Diagnosis], not_here: Sequence[Elsewhere]) -> None:
    """One line for each engine, then what is wrong with some, and where to read more."""
    from simcompare.running.jobs import OK

    table = console.Rows("engine", "version", "state", "known limits", "variants")
    for one in diagnoses:
        counts = [str(len(found)) for found in (one.facts.known_limits, one.facts.variants)]
        state = "works" if one.status == OK else one.status
        table.add_row(one.engine, one.facts.version or "–", state, *counts)
    console.show_table(table)
    typer.echo()
    console.print_wrapped(f"{one.engine}: {one.message}" for one in diagnoses if one.status != OK)
    working = sum(one.status == OK for one in diagnoses)
    console.print_wrapped(
        [
            f"{working} of {len(diagnoses)} engines work: each let a ball fall for 0.2 s.",
            f"Not to be run here: {', '.join(engine.name for engine in not_here)}.",
            "simcompare doctor -v tells what each engine can do, its known limits and variants,"
            " and how scenes get to the others.",
        ]
    )


def _show_all(diagnosis: Diagnosis) -> None:
    """What an engine can do and what is known of it."""
    from simcompare.engine.helps import known

    facts = diagnosis.facts
    named = f"{diagnosis.engine} {facts.version}" if facts.version else diagnosis.engine
    lines = [f"{named}: {diagnosis.message}"]
    lines += [f"can do: {', '.join(facts.features)}"] if facts.features else []
    lines += [f"limit: {limit.text} [{limit.reference}]" for limit in facts.known_limits]
    lines += [f"mapping: {facts.mapping}"] if facts.mapping else []
    lines += [f"helps: {known(facts.helps)}"] if facts.helps else []
    lines += [
        f"variant {diagnosis.engine}:{one.name}: {one.text} [{one.reference}]"
        for one in facts.variants
    ]
    console.print_wrapped(lines)


def _show_elsewhere(engines: Sequence[Elsewhere]) -> None:
    """Engines that cannot run here: why, how a scene gets there, and how results come back."""
    from simcompare.engine import elsewhere

    typer.echo("\nEngines that cannot run here")
    console.print_wrapped([elsewhere.UNTRIED])
    for engine in engines:
        typer.echo(f"{engine.name} ({engine.title})")
        console.print_wrapped([f"  why: {engine.why} [{engine.why_reference}]"])
        for line in engine.lines():
            typer.echo(f"  {line}")
    typer.echo("For all of these:")
    for sentence, commands in elsewhere.BACK:
        console.print_wrapped([f"  {sentence}"])
        for command in commands:
            typer.echo(f"    {command}")
