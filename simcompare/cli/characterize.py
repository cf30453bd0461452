"""``simcompare characterize``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner, opening

if TYPE_CHECKING:
    from simcompare.results.records.characterization import Characterization


def characterize(
    experiments: str = typer.Argument(
        "all",
        help="'all', or some of bounce, friction, joint and force, with commas.",
        autocompletion=complete.experiments,
    ),
    engine: str = typer.Option(
        "all", help="'all' or names with commas.", autocompletion=complete.engines
    ),
    contact: str = typer.Option(
        "default,coefficients,tuned,assisted",
        help="Contact levels with commas, as for run.",
        autocompletion=complete.contact_levels,
    ),
    step: str = typer.Option(
        "1ms", help="The engine's step; each experiment is also done over steps of 0.25 to 8 ms."
    ),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the results' folder."),
    report: bool = typer.Option(True, help="Write report.html into the results' folder."),
    opened: bool = opening.OPTION,
    figures: str = typer.Option(
        None, metavar="FORMAT", help="Also write every picture as a file: pdf, png or svg."
    ),
    details: bool = typer.Option(False, "--details", help="Print the tables of the report, too."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one experiment, in seconds."),
) -> None:
    """Measure how engines bounce, stick, swing and tell forces."""
    from simcompare.model.plain import plain
    from simcompare.reports.characterization import page
    from simcompare.verbs import characterize as verb

    opening.check(opened, report=report, figures=figures)
    with console.progress_bar("characterize") as progress:
        result = verb.characterize(
            experiments,
            engine=engine,
            contact=contact,
            step=step,
            out=out,
            time_limit_s=time_limit,
            progress=progress,
        )
    ending.finish_block(
        lambda: page.block_of(result),
        result.folder,
        lambda: {**plain(result), "exit_code": result.exit_code},
        lambda file: _show(result, file, details=details),
        result.exit_code,
        report=report,
        opened=opened,
        as_json=as_json,
        figures=figures,
    )


def _show(result: Characterization, last_file: Path | None, *, details: bool) -> None:
    """The answer in sentences, what did not run, and the tables where they are wanted."""
    from simcompare.reports.characterization import tables as characterized_tables
    from simcompare.reports.render import numbers

    sentences = [one.text for one in result.sentences if one.leads]
    console.print_wrapped(map(numbers.tied, sentences))
    for name in result.experiments:
        if details or manner.is_verbose():
            _show_table(result, name)
        console.print_wrapped(characterized_tables.reasons(result, name))
    ending.show_places(result.folder, last_file)


def _show_table(result: Characterization, name: str) -> None:
    from simcompare.reports.characterization import tables

    typer.echo(f"\n{name}, at {1e3 * result.step_s:g} ms")
    console.show_table(tables.of(result, name))
