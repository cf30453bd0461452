"""``simcompare allan``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner, opening

if TYPE_CHECKING:
    from simcompare.results.records.allan import NoiseAnalysis


def allan(
    record: str = typer.Argument(
        help="A published recording, a stored recording, or a log.",
        autocompletion=complete.recordings,
    ),
    channel: str = typer.Option(
        None,
        help="Names with commas, or how they begin (acc); all inertial ones if left out.",
    ),
    start: str = typer.Option(
        None,
        "--from",
        help="Where it begins, such as 5s; the longest still stretch if left out, all in an audit.",
    ),
    until: str = typer.Option(None, help="Where the stretch ends."),
    mapping: Path = typer.Option(None, "--map", help="YAML file that says what the log cannot."),
    sheet: str = typer.Option(
        None, help="Data sheet to hold the noise against.", autocompletion=complete.sheets
    ),
    audit: bool = typer.Option(
        False, "--audit", help="For a simulator's stream: test it, and tell whose noise it is."
    ),
    again: str = typer.Option(
        None, metavar="RECORD", help="A second run of the same simulator, for the audit."
    ),
    claim: list[str] = typer.Option(
        [], metavar="NAME=VALUE", help="What it claims, in SI: density, or bias and bias_time."
    ),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the report."),
    report: bool = typer.Option(
        False, "--report/--no-report", help="Write an HTML page into the folder."
    ),
    opened: bool = opening.OPTION,
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Tell the noise of a sensor at rest from how it averages out."""
    from simcompare.model.plain import plain
    from simcompare.verbs import allan as verb

    found = verb.allan(
        record, channel=channel, start=start, until=until, mapping=mapping, sheet=sheet,
        audit=audit, again=again, claims=_claims(claim),
    )  # fmt: skip
    page = _write(found, out) if report or opened else None
    ending.finish(
        lambda: plain(found), lambda: _show(found, page), 0,
        page=page if opened else None, as_json=as_json,
    )  # fmt: skip


def _claims(given: list[str]) -> dict[str, float]:
    """Claims as numbers."""
    from simcompare import units

    pairs = console.pairs(given, "--claim", "NAME=VALUE, such as density=0.004")
    return {name: units.to_si(value, "1", f"--claim {name}") for name, value in pairs.items()}


def _write(found: NoiseAnalysis, out: Path) -> Path:
    from simcompare.reports import builder
    from simcompare.reports.allan import page
    from simcompare.results import store

    store.check_writable(out)
    name = "".join(one if one.isalnum() else "-" for one in Path(found.source).stem)
    return builder.write_html_of([page.block_of(found)], out / f"allan-{name}.html")


def _show(found: NoiseAnalysis, page: Path | None) -> None:
    from simcompare.reports.allan import tables, words
    from simcompare.reports.render import numbers

    said = [*words.audit(found), *words.answer(found), *words.against(found)]
    console.print_wrapped(map(numbers.tied, said))
    typer.echo("")
    made = tables.of_terms(found)._replace(title="")
    console.show_table(made if manner.is_verbose() else made.narrow())
    typer.echo("")
    console.print_wrapped(map(numbers.tied, words.notes(found)))
    if manner.is_verbose():
        for more in (tables.of_findings(found), tables.of_matches(found)):
            if more is not None:
                typer.echo(f"\n{more.title}")
                console.show_table(more._replace(title=""))
        typer.echo("")
        console.show_table(tables.of_deviations(found))
    ending.show_places(None, page)
