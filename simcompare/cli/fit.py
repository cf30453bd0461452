"""``simcompare fit``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from simcompare.cli import complete

if TYPE_CHECKING:
    from simcompare.results import Run


def fit(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario that bounces.", autocompletion=complete.scenarios
    ),
    recordings: list[str] = typer.Option(
        ...,
        "--recording",
        "-r",
        help="Sound, video track, stopwatch or table of a bouncing ball; several times.",
    ),
    hold_out: list[str] = typer.Option(
        [], "--hold-out", help="A recording that is not fitted but predicted; several times."
    ),
    engine: str = typer.Option(
        "all", help="'all' or names with commas.", autocompletion=complete.engines
    ),
    model: str = typer.Option("auto", help="Closed form, or the one that the data ask for."),
    unknowns: str = typer.Option(
        None, "--unknown", help="Further unknowns with commas: clock_skew, scale."
    ),
    fixed: list[str] = typer.Option(
        [], "--fix", metavar="P=V", help="A value that is not sought, such as terminal_speed=9m/s."
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
    step: str = typer.Option(None, help="Time between samples, such as 1ms."),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the run's own folder."),
    report: bool = typer.Option(True, help="Write report.html into the run's folder."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Fit contact parameters to measured bounces, on every engine, with uncertainty."""
    from simcompare import units
    from simcompare.cli import console
    from simcompare.fitting import fitting

    with console.progress_bar(scenario) as progress:
        result = fitting.fit(
            scenario,
            recordings=recordings,
            hold_out=hold_out,
            engine=engine,
            model=model,
            unknowns=[name.strip() for name in unknowns.split(",")] if unknowns else (),
            fixed=console.pairs(fixed, "--fix"),
            priors=_priors(priors),
            u_time_s=None if u_time is None else units.to_si(u_time, "s", "--u-time"),
            set=console.pairs(settings),
            preset=preset,
            mapping=mapping,
            step=step,
            out=out,
            time_limit_s=time_limit,
            progress=progress,
        )
    written = None
    if report and result.folder is not None:
        from simcompare.reports import builder

        written = builder.write_html([result], result.folder / "report.html")
    if as_json:
        console.print_json({**result.record["fit"], "run": str(result.folder)})
    else:
        _print(result, written)
    raise typer.Exit(130 if result.interrupted else result.exit_code)


def _priors(texts: list[str]) -> dict[str, tuple[float, float]]:
    """Reads ``drop_height=1m:2mm``."""
    from simcompare import units
    from simcompare.cli import console
    from simcompare.errors import InputError, UnknownName
    from simcompare.fitting.bounce_models import DEFAULTS

    found = {}
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
        found[name] = (
            units.to_si(value, unit, f"--prior {given}"), units.to_si(u, unit, f"--prior {given}")
        )  # fmt: skip
    return found


def _print(result: Run, written: Path | None) -> None:
    found = result.record["fit"]
    for sentence in found["told"]:
        typer.echo(sentence)
    if "choice" in found:
        _print_choice(found)
        _print_engines(found)
    else:
        _print_waves(found)
    for source in found["sources"]:
        if source["status"] != "ok":
            typer.echo(f"{source['name']}: {source['reason']}")
    typer.echo("")
    for sentence in found["sentences"]:
        typer.echo(sentence)
    if result.folder is not None:
        reuse = f"; reuse it with --contact {result.folder}/fit.json" if "choice" in found else ""
        typer.echo(f"Stored in {result.folder}{reuse}")
    if written is not None:
        typer.echo(f"Report: {written}")


def _print_waves(found: dict[str, Any]) -> None:
    """Parameters and what engines show with them, and how well they predict what was held out."""
    from simcompare.cli import console

    closed, names = found["closed_form"], found["closed_form"]["names"]
    held = found["holdout"]["streams"]
    lead = found["probes"][0]
    made = console.table(
        "engine", *names, *(f"rms {lead} {row['stream']}" for row in held), "simulations", "seconds"
    )
    for source in found["sources"]:
        if source["status"] != "ok":
            made.add_row(source["name"], source["status"])
            continue
        left = {row["source"]: row["rms"][lead] for row in source["holdout"]}
        made.add_row(
            f"{source['name']} {source['version'] or ''}",
            *_cells(source["parameters"], names),
            *(f"{left[row['stream']]:.3g}" if row["stream"] in left else "" for row in held),
            str(source["simulations"]), f"{source['wall_s']:.2f}",
        )  # fmt: skip
    made.add_row("closed form", *_cells(closed["parameters"], names),
                 *(f"{row['rms'][lead]:.3g}" for row in held), "", "")  # fmt: skip
    console.show_table(made)
    _print_holdout(held)


def _cells(parameters: dict[str, Any], names: list[str]) -> list[str]:
    from simcompare.cli import console

    return [console.number(parameters[name]["value"], parameters[name]["u"]) for name in names]


def _print_holdout(held: list[dict[str, Any]]) -> None:
    """E_n of each value of each stream, engine by engine."""
    from simcompare.cli import console

    engines = list(dict.fromkeys(name for row in held for name in row["engines"]))
    if not engines:
        return
    made = console.table("held out", "value", "measured", *(f"E_n {name}" for name in engines))
    for row in held:
        for i, value in enumerate(row["values"]):
            found = [row["engines"][n]["values"][i:] for n in engines if n in row["engines"]]
            scores = [own[0]["e_n"] if own else None for own in found]
            made.add_row(
                row["stream"], value["measure"], console.number(value["measured"], value["u_data"]),
                *("–" if score is None else f"{score:+.2f}" for score in scores),
            )  # fmt: skip
    console.show_table(made)


def _print_choice(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    criterion = found["choice"]["criterion"]
    made = console.table("closed form", "unknowns", "χ²", criterion, "BIC", "weight", "restitution")
    for row in found["choice"]["candidates"]:
        e = row["parameters"].get("restitution", {"value": None, "u": None})
        value = row[criterion.lower()]
        told = "–" if value is None else f"{value:.1f}"
        made.add_row(
            row["text"], f"{row['unknowns']:.1f}", f"{row['chi2']:.1f}", told, f"{row['bic']:.1f}",
            f"{row['weight']:.2f}", console.number(e["value"], e["u"]),
        )  # fmt: skip
    console.show_table(made)


def _print_engines(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    names = list(
        dict.fromkeys(name for source in found["sources"] for name in source["parameters"])
    )
    made = console.table("engine", *names, "effective restitution", "simulations", "seconds")
    closed = found["closed_form"]["parameters"]
    for source in found["sources"]:
        if source["status"] != "ok":
            made.add_row(source["name"], *[""] * len(names), source["status"], "", "")
            continue
        rows = [source["parameters"][name] for name in names]
        effective = source["effective"]["restitution"]
        made.add_row(
            f"{source['name']} {source['version'] or ''}",
            *(console.number(row["value"], row["u"]) for row in rows),
            console.number(effective["value"], effective["u"]),
            str(source["simulations"]), f"{source['wall_s']:.2f}",
        )  # fmt: skip
    none = {"value": None, "u": None}
    cells = [console.number(*(closed.get(n, none)[key] for key in ("value", "u"))) for n in names]
    made.add_row("closed form", *cells, "", "", "")
    console.show_table(made)
