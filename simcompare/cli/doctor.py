"""``simcompare doctor``."""

from __future__ import annotations

import typer


def doctor(
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Engines found, versions, features, known limits, a self-test, and what is missing."""
    from simcompare import doctor as examination
    from simcompare.cli import console
    from simcompare.helps import known
    from simcompare.jobs import FAILED

    found = examination.doctor()
    if as_json:
        console.print_json({"engines": [diagnosis.to_dict() for diagnosis in found]})
    else:
        for diagnosis in found:
            facts = diagnosis.facts
            named = f"{diagnosis.engine} {facts.version}" if facts.version else diagnosis.engine
            typer.echo(f"{named}: {diagnosis.message}")
            if facts.features:
                typer.echo(f"  can do: {', '.join(facts.features)}")
            for text, reference in facts.known_limits:
                typer.echo(f"  limit: {text} [{reference}]")
            if facts.mapping:
                typer.echo(f"  mapping: {facts.mapping}")
            if facts.helps:
                typer.echo(f"  helps: {known(facts.helps)}")
    raise typer.Exit(3 if any(diagnosis.status == FAILED for diagnosis in found) else 0)
