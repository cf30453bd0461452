"""``simcompare run``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare import notation
from simcompare.cli import complete, console, ending, opening

if TYPE_CHECKING:
    from simcompare.comparison.against import Match
    from simcompare.model.plain import Plain
    from simcompare.results.records.run import Measurement, Record
    from simcompare.results.run import Run


def run(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    engine: str = typer.Option(
        "all",
        help="'all' or names with commas; ENGINE:VARIANT is a variant (see simcompare list).",
        autocompletion=complete.engines,
    ),
    contact: str = typer.Option(
        "default,tuned,assisted",
        help="'default': the engine as it comes; 'coefficients': with the scenario's restitution"
        " and friction; 'tuned': all that the scenario states typed in, in a plain loop;"
        " 'assisted': the same with our helps.",
        autocompletion=complete.contact_levels,
    ),
    assist: str = typer.Option("all", help="Helps of 'assisted': all, none, or names with commas."),
    judge: str = typer.Option(
        "assisted", help="'tuned': a tolerance that is missed by 'tuned' fails the run as well."
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="Change a parameter, such as drop_height=30cm."
    ),
    preset: str = typer.Option(None, help="Named set of parameters, applied before --set."),
    step: str = typer.Option(
        None,
        help="The engine's step, such as 1ms; samples may be coarser. With commas, each step is a"
        " source of its own.",
    ),
    seeds: int = typer.Option(None, help="Number of dithered repeats (the scenario's own: 9)."),
    against: str = typer.Option(
        None,
        help="Measured bounces: a CSV file or a published table.",
        autocompletion=complete.tables,
    ),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the run's own folder."),
    report: bool = typer.Option(True, help="Write report.html into the run's folder."),
    opened: bool = opening.OPTION,
    details: bool = typer.Option(
        False, "--details", help="Print a table of every measure, not only of the leading one."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Simulate a scenario on engines, compare, store, and write a report."""
    from simcompare.verbs import run as experiment

    opening.check(opened, report=report)
    with console.progress_bar(scenario) as progress:
        result = experiment.run(
            scenario,
            engine=engine,
            contact=contact,
            assist=assist,
            judge=judge,
            set=console.pairs(settings),
            preset=preset,
            step=step,
            seeds=seeds,
            against=against,
            out=out,
            time_limit_s=time_limit,
            progress=progress,
        )
    ending.finish_run(
        result,
        lambda: _plain(result),
        lambda page: _show(result, page, details=details),
        report=report,
        opened=opened,
        as_json=as_json,
    )


def _plain(result: Run) -> Plain:
    from simcompare.model.plain import plain
    from simcompare.reports.run import answer

    more = {"headline": answer.sentences(result), "exit_code": result.exit_code}
    return {**plain(result.record), **more}


def _show(result: Run, page: Path | None, *, details: bool) -> None:
    """The answer, the leading measure level by level, and what the reader must know of both."""
    from simcompare.reports.run import answer, lead_table, remarks

    console.print_wrapped(answer.sentences(result))
    for table in lead_table.lead_tables(result, every=details):
        typer.echo("\n".join(["", *lead_table.text(table, console.table_width())]))
    typer.echo()
    console.print_wrapped([*remarks.remarks(result), *_levels(result.record)])
    _show_remarks(result)
    ending.show_end(result, page)


def _levels(record: Record) -> list[str]:
    """What the levels of the table are, in a sentence each, and what was run."""
    levels = dict.fromkeys(source.contact for source in record.sources)
    texts = dict(_LEVELS)
    if record.assist == "none":
        texts["assisted"] = "here with none of our helps, so the same as tuned."
    # one engine may stand in several rows, each with its step behind an @
    known = [source for source in record.sources if source.version]
    versions = {source.name.partition("@")[0]: source.version for source in known}
    sentences = [f"{level}: {texts[level]}" for level in levels if level in texts]
    if versions:
        named = ", ".join(f"{name} {version}" for name, version in versions.items())
        sentences.append(f"Versions: {named}.")
    return sentences


#: level -> what stands in its rows
_LEVELS = {
    "default": "the engine as it comes; shown, not judged.",
    "coefficients": "as it comes, with the scenario's restitution and friction; not judged.",
    "tuned": "the engine in a plain loop, everything typed in; what it misses is its own.",
    "assisted": "the same with our helps (the report names them, and what each changes).",
    "fitted": "with the parameters and numbers of the fit, at the level that it was made for.",
}


def _show_remarks(result: Run) -> None:
    """What did not run, what was held against, and what lies outside of a fit's range."""
    from simcompare.reports.run import runs
    from simcompare.reports.run.not_run import not_run

    console.print_wrapped(f"{row.name} ({row.modes}): {row.reason}" for row in not_run(result))
    record = runs.run_record(result)
    if record.against is not None:
        _show_against(record.against)
    console.print_wrapped(f"Caution: {caution}" for caution in record.cautions)


def _measured(match: Match) -> str:
    if match.low is not None:
        return f"{match.low:.5g} to {match.high:.5g}"
    return notation.number(match.measured, match.u_measured)


def _show_against(against: Measurement) -> None:
    head = against.head
    typer.echo(f"Against {head.get('title', against.file)}")
    typer.echo(f"  {head.get('citation', 'no citation given')}")
    if against.caution:
        typer.echo(f"  {against.caution}")
    table = console.Rows("engine", "contact", "quantity", "simulated", "measured", "E_n", "inside")
    for match in against.matches:
        inside = {True: "yes", False: "no", None: "no uncertainty is known"}[match.inside]
        table.add_row(
            match.source,
            match.contact,
            f"{match.quantity} {match.bounce} [{match.unit}]",
            notation.number(match.value, match.scatter),
            _measured(match),
            "–" if match.e_n is None else f"{match.e_n:+.2f}".replace("-0.00", "+0.00"),
            inside,
        )
    console.show_table(table)
