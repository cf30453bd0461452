"""``simcompare fit``."""

from __future__ import annotations

from pathlib import Path

import typer

from simcompare.cli import complete, console, ending, opening
from simcompare.errors import InputError, UnknownName


def fit(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario that says what of it can be fitted.",
        autocompletion=complete.scenarios,
    ),
    recordings: list[str] = typer.Option(
        ...,
        "--recording",
        "-r",
        help="Sound, video track, stopwatch or table of a bouncing ball; a log or public data set"
        " of signals or tosses; several times.",
    ),
    hold_out: list[str] = typer.Option(
        [], "--hold-out", help="A recording that is not fitted but predicted; several times."
    ),
    engine: str = typer.Option(
        "all", help="'all' or names with commas.", autocompletion=complete.engines
    ),
    model: str = typer.Option("auto", help="Closed form, or the one that the data ask for."),
    unknowns: str = typer.Option(
        None,
        "--unknown",
        help="Further unknowns with commas: clock_skew, scale; of signals and tosses, all that is"
        " sought.",
    ),
    fixed: list[str] = typer.Option(
        [],
        "--fix",
        metavar="P=V",
        help="A value that is exact, not sought, such as terminal_speed=9m/s. Of bounces, gravity"
        " and clock_skew are assumed with an uncertainty where nothing is said.",
    ),
    priors: list[str] = typer.Option(
        [],
        "--prior",
        metavar="P=V:U",
        help="What is known before: value and standard uncertainty, such as drop_height=1m:2mm.",
    ),
    u_time: str = typer.Option(
        None, help="Standard uncertainty of an impact time, where the recording does not say."
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="A parameter of the scenario, such as mass=2.7g."
    ),
    preset: str = typer.Option(None, help="Named set of parameters, applied before --set."),
    mapping: Path = typer.Option(None, "--map", help="Mapping file for the logs."),
    step: str = typer.Option(
        None, help="Step of your own loop, for which the engines are tuned, such as 1ms."
    ),
    assist: str = typer.Option(
        None,
        help="Fit engines together with our helps: all, none, or names with commas; bounces have"
        " none by default, signals and tosses all.",
    ),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the run's own folder."),
    report: bool = typer.Option(True, help="Write report.html into the run's folder."),
    opened: bool = opening.OPTION,
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Find the parameters with which engines move as measured."""
    from simcompare import units
    from simcompare.cli import fit_tables
    from simcompare.model.plain import plain
    from simcompare.reports.fit import fits
    from simcompare.verbs import fit as fitting

    opening.check(opened, report=report)
    with console.progress_bar(scenario) as progress:
        result = fitting.fit(
            scenario,
            recordings=recordings,
            hold_out=hold_out,
            engine=engine,
            model=model,
            unknowns=[name.strip() for name in unknowns.split(",")] if unknowns else (),
            fixed=console.pairs(fixed, "--fix"),
            priors=_priors(scenario, priors),
            u_time_s=None if u_time is None else units.to_si(u_time, "s", "--u-time"),
            set=console.pairs(settings),
            preset=preset,
            mapping=mapping,
            step=step,
            assist=assist,
            out=out,
            time_limit_s=time_limit,
            progress=progress,
        )
    ending.finish_run(
        result,
        lambda: {**plain(fits.of_any(result)), "run": str(result.folder)},
        lambda page: fit_tables.show(result, page),
        report=report,
        opened=opened,
        as_json=as_json,
    )


def _priors(scenario: str, texts: list[str]) -> dict[str, tuple[float, float]]:
    """Reads ``drop_height=1m:2mm``; what is fitted otherwise than by bounces takes none at all."""
    from simcompare import units
    from simcompare.fitting.bounces.bounce_models import DEFAULTS
    from simcompare.model.fittable import BOUNCES
    from simcompare.scenarios import catalogue

    by = catalogue.load(scenario).fit if texts else None
    if by is not None and by.by != BOUNCES:
        return dict.fromkeys(texts, (0.0, 0.0))  # the fit refuses them, whatever they say
    priors = {}
    for given, text in console.pairs(texts, "--prior").items():
        value, colon, u = str(text).partition(":")
        if not colon:
            raise InputError(
                "--prior",
                [f"{given}={text} has no uncertainty; expected {given}=VALUE:U"],
            )
        name = units.find_name(given, DEFAULTS)
        if name is None:
            raise UnknownName("unknown of a bounce", given, DEFAULTS)
        unit = units.unit_of(name)
        priors[name] = (
            units.to_si(value, unit, f"--prior {given}"), units.to_si(u, unit, f"--prior {given}")
        )  # fmt: skip
    return priors
