"""``simcompare explain``."""

from __future__ import annotations

import dataclasses

import typer

from simcompare.cli import complete, console


def explain(
    word: list[str] = typer.Argument(
        None,
        help="Such as E_n, tuned or closed form; all words where it is left out.",
        autocompletion=complete.words,
    ),
    language: str = typer.Option(
        None, help="'en' or 'de'; that of your computer where it is left out."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Explain a word of the output, in English or German."""
    from simcompare.verbs.explain import explain as verb

    found = verb(" ".join(word) if word else None, language=language)
    if as_json:
        console.print_json({"terms": [dataclasses.asdict(term) for term in found.terms]})
        return
    for line in found.lines(console.width()):
        typer.echo(line)
