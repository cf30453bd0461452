"""``simcompare run``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from simcompare import notation
from simcompare.cli import complete, console, ending, manner, misplaced, opening
from simcompare.errors import InputError

if TYPE_CHECKING:
    from simcompare.comparison.against import Match
    from simcompare.model.plain import Plain
    from simcompare.results.records.run import Measurement
    from simcompare.results.run import Run
    from simcompare.verbs.request import RunRequest


#: options that the API calls otherwise
_FIELDS = {"settings": "set"}
_OWN = "ENGINE.VALUE=number, such as pymunk.elasticity=0.9"


def run(
    ctx: typer.Context,
    scenario: str = typer.Argument(
        None, help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    engine: str = typer.Option(
        "all",
        help="Names with commas; ENGINE:VARIANT for a variant (simcompare list -v).",
        autocompletion=complete.engines,
    ),
    contact: str = typer.Option(
        "default,tuned,assisted",
        help="Of default, coefficients, tuned and assisted, some with commas (simcompare explain"
        " tuned); or the fit.json of a fit.",
        autocompletion=complete.contact_levels,
    ),
    assist: str = typer.Option("all", help="Our helps: all, none, or names with commas."),
    judge: str = typer.Option(
        "assisted", help="With tuned, tolerances that tuned misses count for the exit code."
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="Change a parameter, such as drop_height=30cm."
    ),
    own: list[str] = typer.Option(
        [],
        metavar="ENGINE.VALUE=V",
        help="Run an engine with a contact value of its own, such as pymunk.elasticity=0.9.",
        autocompletion=complete.own_values,
    ),
    robot: Path = console.ROBOT,
    preset: str = typer.Option(None, help="Named set of parameters, applied before --set."),
    step: str = typer.Option(
        None,
        help="Time step of the engines, such as 1ms; several with commas.",
    ),
    seeds: int = typer.Option(None, help="Number of repeats, each with a slightly other start."),
    against: str = typer.Option(
        None,
        help="Measured bounces: a CSV file or a published table.",
        autocompletion=complete.tables,
    ),
    sensor: list[str] = typer.Option(
        [],
        metavar="NAME=SHEET",
        help="Read a sensor or signal as a real one does, such as imu=mpu6050; and its settings,"
        " such as imu.rate_Hz=100.",
        autocompletion=complete.sensors,
    ),
    seed: int = typer.Option(0, help="Of all that is drawn for sensors."),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the run's own folder."),
    report: bool = typer.Option(True, help="Write report.html into the run's folder."),
    opened: bool = opening.OPTION,
    details: bool = typer.Option(False, "--details", help="Print a table of every measure."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
    resume: Path = typer.Option(
        None,
        metavar="RUN",
        help="Go on with a run that was ended early, such as runs/20260101-120000-ball.",
    ),
) -> None:
    """Simulate a scenario in many engines and compare them."""
    from simcompare.verbs import run as experiment

    opening.check(opened, report=report)
    asked: Plain = {
        "engine": engine, "contact": contact, "assist": assist, "judge": judge,
        "set": console.pairs(settings), "own": console.pairs(own, "--own", _OWN),
        "robot": robot, "preset": preset, "step": step, "seeds": seeds, "against": against,
        "sensor": _sheets(sensor), "seed": seed,
    }  # fmt: skip
    if resume is not None:
        _check_same(ctx, resume, experiment.request_of(scenario or "", **asked))
    elif scenario is None:
        raise misplaced.which_scenario("run")
    how: Plain = {"time_limit_s": time_limit}
    with console.progress_bar(scenario or str(resume)) as progress:
        if resume is None:
            result = experiment.run(scenario, **asked, out=out, progress=progress, **how)
        else:
            result = experiment.resume(resume, progress=progress, **how)
    ending.finish_run(
        result,
        lambda: _plain(result),
        lambda page: _show(result, page, details=details),
        report=report,
        opened=opened,
        as_json=as_json,
    )


def _check_same(ctx: typer.Context, place: Path, now: RunRequest) -> None:
    """Refuses options that ask something else than the run that is to go on was asked.

    Raises:
        InputError: which do.
    """
    from simcompare.verbs import kept

    then = kept.request_of(place)
    typed = [one for one in ctx.command.params if _is_typed(ctx, one)]
    fields = {one.name: _FIELDS.get(str(one.name), str(one.name)) for one in typed}
    faults = [
        f"{one.opts[0]} is not what the run was begun with; leave it out"
        for one in typed
        if getattr(now, fields[one.name], None) != getattr(then, fields[one.name], None)
    ]
    if any(one.name == "out" for one in typed):
        faults.append("the run stays in its folder; drop --out")
    if faults:
        raise InputError(f"--resume {place}", faults)


def _is_typed(ctx: typer.Context, param: Any) -> bool:  # noqa: ANN401
    source = ctx.get_parameter_source(str(param.name))
    return source is not None and source.name == "COMMANDLINE"


def _sheets(given: list[str]) -> dict[str, str]:
    """Sensor or signal -> data sheet."""
    form = "NAME=SHEET, such as imu=mpu6050, or NAME.SETTING=VALUE, such as imu.rate_Hz=100"
    pairs = console.pairs(given, "--sensor", form)
    return {name: str(sheet) for name, sheet in pairs.items()}


def _plain(result: Run) -> Plain:
    from simcompare.model.plain import plain
    from simcompare.reports.run import answer

    more = {"headline": answer.sentences(result), "exit_code": result.exit_code}
    return {**plain(result.record), **more}


def _show(result: Run, page: Path | None, *, details: bool) -> None:
    """The answer, the leading measure level by level, and what its words mean."""
    from simcompare import glossary
    from simcompare.reports.run import lead_table, remarks, runs, short
    from simcompare.reports.sections.measurement import sentences

    console.print_wrapped(short.short(result))
    tables = lead_table.lead_tables(result, every=details or manner.is_verbose())
    for table in tables:
        typer.echo("\n".join(["", *lead_table.text(table, console.table_width())]))
    against = runs.run_record(result).against
    if against is not None:
        _show_against(against)
        console.print_wrapped(sentences(result))
    _show_sensing(result)
    typer.echo()
    words = lead_table.legend_words(tables)
    console.print_wrapped(glossary.legend([*words, "E_n"] if against else words))
    _show_not_run(result)
    if runs.run_record(result).assist == "none":
        typer.echo("--assist none: assisted has none of our helps, so it is the same as tuned.")
    if manner.is_verbose():
        _show_all(result)
    else:
        cautions = (f"Caution: {caution}" for caution in runs.run_record(result).cautions)
        console.print_wrapped([*cautions, *remarks.failures(result)])
    ending.show_places(result.folder, page)
    _show_left(result.folder)


def _show_left(folder: Path | None) -> None:
    """Names the runs in the same place that were ended before they could say so."""
    from simcompare.results import stored_runs, unfinished

    for place in [] if folder is None else stored_runs.left(folder.parent):
        typer.echo(f"{place} was ended early; go on with: {unfinished.resuming(place)}")


def _show_sensing(result: Run) -> None:
    """What sensors that are not ideal read."""
    from simcompare.reports.run import runs
    from simcompare.reports.sensing import words

    sensing = runs.run_record(result).sensing
    if sensing is not None:
        typer.echo()
        console.print_wrapped(words.lines(sensing))


def _show_not_run(result: Run) -> None:
    """What did not run and why; what an engine cannot do is only named where others can."""
    from simcompare.reports.run.not_run import not_run
    from simcompare.running.jobs import UNSUPPORTED

    rows = not_run(result)
    some_ran = any(source.ran for source in result.record.sources)
    is_brief = some_ran and not manner.is_verbose()
    short = [row.name for row in rows if is_brief and row.status == UNSUPPORTED]
    if short:
        names = ", ".join(dict.fromkeys(short))
        console.print_wrapped([f"unsupported: {names} (-v tells why)"])
    told = [row for row in rows if not is_brief or row.status != UNSUPPORTED]
    console.print_wrapped(f"{row.name} ({row.modes}): {row.reason}" for row in told)


def _show_all(result: Run) -> None:
    """What else is known: the whole answer, remarks on it, and versions."""
    from simcompare.reports.run import answer, remarks

    console.print_wrapped([*answer.sentences(result), *remarks.remarks(result)])
    known = [source for source in result.record.sources if source.version]
    # one engine may stand in several rows, each with its step behind an @
    versions = {source.name.partition("@")[0]: source.version for source in known}
    if versions:
        named = ", ".join(f"{name} {version}" for name, version in versions.items())
        console.print_wrapped([f"Versions: {named}."])


def _show_against(against: Measurement) -> None:
    head = against.head
    typer.echo(f"\nAgainst {head.get('title', against.file)}")
    said = (head.get("citation", "no citation given"), against.caution)
    console.print_wrapped(f"  {text}" for text in said if text)
    table = console.Rows("engine", "contact", "quantity", "simulated", "measured", "E_n", "inside")
    for match in against.matches:
        inside = {True: "yes", False: "no", None: "no uncertainty is known"}[match.inside]
        inside = "–" if match.value is None else inside
        table.add_row(
            match.source,
            match.contact,
            f"{match.quantity} {match.bounce} [{match.unit}]",
            notation.number(match.value, match.scatter, _places(match)),
            _measured(match),
            "–" if match.e_n is None else notation.fixed(match.e_n, 2),
            inside,
        )
    console.show_table(table)


def _places(match: Match) -> int | None:
    """Decimals that the measurement is worth."""
    band = (match.high or 0.0) - (match.low or 0.0)
    return notation.places(match.u_measured or band / 10)


def _measured(match: Match) -> str:
    if match.low is not None:
        return f"{match.low:.5g} to {match.high:.5g}"
    return notation.number(match.measured, match.u_measured)
