"""``simcompare run``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from simcompare.cli import complete

if TYPE_CHECKING:
    from simcompare.results import Run

#: scores of the whole run that the table shows, in this order, where the scenario measures them
_SHOWN = 4


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
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Simulate a scenario on engines, compare, store, and write a report."""
    from simcompare import experiment
    from simcompare.cli import console

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
    written = _write_report(result) if report else None
    if as_json:
        console.print_json({**result.record, "exit_code": result.exit_code})
    else:
        _print(result, written)
    raise typer.Exit(130 if result.interrupted else result.exit_code)


def _write_report(result: Run) -> Path | None:
    from simcompare.reports import builder

    if result.folder is None:
        return None
    return builder.write_html([result], result.folder / "report.html")


def _print(result: Run, written: Path | None) -> None:
    from simcompare import notation
    from simcompare.cli import console

    record = result.record
    judged = list(dict.fromkeys(s.measure for s in result.scores if s.index is None))[:_SHOWN]
    units = {s.measure: s.unit for s in result.scores}
    judged = judged[: 2 if console.is_narrow() else _SHOWN]
    heads = [f"{name} [{units[name]}]" for name in judged]
    made = console.table("engine", "contact", *heads, "verdict")
    for source in record["sources"]:
        made.add_row(*_row(result, source, judged))
    known = [s for s in result.scores[::-1] if s.index is None and s.truth is not None]
    truths = {score.measure: score.truth for score in known}  # at the first of several steps
    if record["truth"] is not None and truths:
        cells = [notation.number(truths.get(name)) for name in judged]
        made.add_row(record["truth"], "", *cells, "")
    console.show_table(made)
    if record["repeats"] > 1:
        typer.echo(
            f"Means over {record['repeats']} repeats; in brackets their standard deviation in the"
            " last digits."
        )
    typer.echo(_levels(record))
    _print_remarks(record)
    if result.interrupted:
        typer.echo("Interrupted: what had finished is kept.", err=True)
    if result.folder is not None:
        typer.echo(f"Stored in {result.folder}")
    if written is not None:
        typer.echo(f"Report: {written}")


def _levels(record: Mapping[str, Any]) -> str:
    """What the levels of the table are, in a sentence each."""
    asked = dict.fromkeys(source["contact"] for source in record["sources"])
    said = dict(_LEVELS)
    if record.get("assist") == "none":
        said["assisted"] = "here with none of our helps, so the same as tuned."
    return "\n".join(f"{level}: {said[level]}" for level in asked if level in said)


#: level -> what stands in its rows
_LEVELS = {
    "default": "the engine as it comes; shown, not judged.",
    "coefficients": "as it comes, with the scenario's restitution and friction; not judged.",
    "tuned": "the engine in a plain loop, everything typed in; what it misses is its own.",
    "assisted": "the same with our helps (the report names them, and what each changes).",
    "fitted": "with the parameters and numbers of the fit, at the level that it was made for.",
}


def _print_remarks(record: Mapping[str, Any]) -> None:
    """What did not run, what was held against, and what lies outside of a fit's range."""
    for source in record["sources"]:
        if source["status"] != "ok":  # not in a cell: a command to copy must not be folded
            typer.echo(f"{source['name']}, {source['contact']}: {source['reason']}")
    if record["against"] is not None:
        _print_against(record["against"])
    for sentence in record.get("cautions", ()):
        typer.echo(f"Caution: {sentence}")


def _row(result: Run, source: dict[str, Any], judged: list[str]) -> list[str]:
    from simcompare import notation
    from simcompare.compare import FAIL, PASS

    start = [f"{source['name']} {source['version'] or ''}", source["contact"]]
    if source["status"] != "ok":
        return [*start, *[""] * len(judged), source["status"]]
    own = {
        score.measure: score
        for score in result.scores
        if score.index is None
        and (score.source, score.contact) == (source["name"], source["contact"])
    }
    cells = [notation.number(own[n].value, own[n].u) if n in own else "–" for n in judged]
    verdicts = [score.verdict for score in own.values()]
    failed = [score.measure for score in own.values() if score.verdict == FAIL]
    verdict = f"fail: {', '.join(failed)}" if failed else "pass" if PASS in verdicts else "info"
    return [*start, *cells, verdict]


def _measured(match: dict[str, Any]) -> str:
    from simcompare import notation

    if match["low"] is not None:
        return f"{match['low']:.5g} to {match['high']:.5g}"
    return notation.number(match["measured"], match["u_measured"])


def _print_against(against: dict[str, Any]) -> None:
    from simcompare import notation
    from simcompare.cli import console

    head = against["head"]
    typer.echo(f"Against {head.get('title', against['file'])}")
    typer.echo(f"  {head.get('citation', 'no citation given')}")
    if against["caution"]:
        typer.echo(f"  {against['caution']}")
    made = console.table("engine", "contact", "quantity", "simulated", "measured", "E_n", "inside")
    for match in against["matches"]:
        inside = {True: "yes", False: "no", None: "no uncertainty is known"}[match["inside"]]
        made.add_row(
            match["source"],
            match["contact"],
            f"{match['quantity']} {match['bounce']} [{match['unit']}]",
            notation.number(match["value"], match["u"]),
            _measured(match),
            "–" if match["e_n"] is None else f"{match['e_n']:+.2f}".replace("-0.00", "+0.00"),
            inside,
        )
    console.show_table(made)
