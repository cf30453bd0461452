"""``simcompare validate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from simcompare.cli import complete

if TYPE_CHECKING:
    from simcompare.results import Run


def _recordings(incomplete: str) -> list[str]:
    from simcompare.hardware.recordings import registry

    return [name for name in registry.files() if name.startswith(incomplete)]


def validate(
    scenario: str = typer.Argument(
        help="Name, folder or file of a scenario.", autocompletion=complete.scenarios
    ),
    recording: str = typer.Option(
        ...,
        "--recording",
        "-r",
        help="A public recording (simcompare data list), an imported one, or a log.",
        autocompletion=_recordings,
    ),
    engine: str = typer.Option(
        "all", help="'all' or names with commas.", autocompletion=complete.engines
    ),
    contact: str = typer.Option(
        "mapped", help="One contact mode.", autocompletion=complete.contact_modes
    ),
    mapping: Path = typer.Option(
        None, "--map", help="YAML file that says which channel is which quantity (validate:)."
    ),
    settings: list[str] = typer.Option(
        [], "--set", metavar="P=V", help="Replace what is known of a parameter, such as mass=0.5kg."
    ),
    streams: str = typer.Option(None, help="Streams that are judged, with commas."),
    step: str = typer.Option(None, help="Time between samples, such as 1ms."),
    strict: bool = typer.Option(False, "--strict", help="Refuse a log with any defect."),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the run's own folder."),
    report: bool = typer.Option(True, help="Write report.html into the run's folder."),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
    time_limit: float = typer.Option(120.0, help="Longest time for one simulation, in seconds."),
) -> None:
    """Hold simulations against a recording of a real device, with uncertainty."""
    from simcompare.cli import console
    from simcompare.validation import validating

    with console.progress_bar(scenario) as progress:
        result = validating.validate(
            scenario,
            recording=recording,
            engine=engine,
            contact=contact,
            mapping=mapping,
            set=console.pairs(settings),
            streams=streams.split(",") if streams else (),
            step=step,
            strict=strict,
            out=out,
            time_limit_s=time_limit,
            progress=progress,
        )
    written = None
    if report and result.folder is not None:
        from simcompare.reports import builder

        written = builder.write_html([result], result.folder / "report.html")
    if as_json:
        console.print_json({**result.record, "exit_code": result.exit_code})
    else:
        _print(result, written)
    raise typer.Exit(130 if result.interrupted else result.exit_code)


def _print(result: Run, written: Path | None) -> None:
    from simcompare.cli import console

    record = result.record
    found = record["validation"]
    for key in ("title", "citation"):
        if found["about"].get(key):
            typer.echo(found["about"][key])
    _print_parameters(found)
    _print_waveforms(found)
    _print_values(found)
    for source in record["sources"]:
        if source["status"] != "ok":
            typer.echo(f"{source['name']}, {source['contact']}: {source['reason']}")
    typer.echo("")
    for sentence in found["sentences"]:
        typer.echo(sentence)
    if result.interrupted:
        typer.echo("Interrupted: what had finished is kept.", err=True)
    if result.folder is not None:
        typer.echo(f"Stored in {result.folder}")
    if written is not None:
        typer.echo(f"Report: {written}")
    _ = console


def _print_parameters(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    rows = [row for row in found["parameters"] if row["kind"] != "scenario"]
    if not rows:
        return
    made = console.table("parameter", "unit", "known before", "fitted", "from")
    for row in rows:
        unit = "" if row["unit"] == "1" else row["unit"]
        fitted = console.number(row["fitted"], row["u_fitted"]) if row["fitted"] is not None else ""
        made.add_row(row["name"], unit, console.number(row["known"], row["u_known"]), fitted, row["source"])
    console.show_table(made)


def _print_waveforms(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    rows = [row for row in found["waveforms"] if row["judged"]]
    several = len({row["stream"] for row in rows}) > 1
    made = console.table(
        "engine", *(["stream"] if several else []), "quantity", "parameters", "RMSE", "bias", "largest",
        "% of range", "magnitude", "phase",
    )  # fmt: skip
    for row in rows:
        made.add_row(
            row["source"], *([row["stream"]] if several else []), f"{row['probe']} [{row['unit']}]",
            row["parameters"], f"{row['rmse']:.3g}", f"{row['bias']:+.3g}", f"{row['max_abs']:.3g}",
            f"{100 * row['nrmse']:.2f}", f"{row['magnitude']:+.3f}", f"{row['phase']:.3f}",
        )  # fmt: skip
    console.show_table(made)


def _print_values(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    if not found["values"]:
        return
    several = len({row["stream"] for row in found["values"]}) > 1
    made = console.table(
        "engine", *(["stream"] if several else []), "quantity", "simulated", "measured", "E_n", "verdict"
    )  # fmt: skip
    for row in found["values"]:
        e_n = "–" if row["e_n"] is None else f"{row['e_n']:+.2f}"
        made.add_row(
            row["source"], *([row["stream"]] if several else []), f"{row['measure']} [{row['unit']}]",
            console.number(row["simulated"], row["u_simulated"]),
            console.number(row["measured"], row["u_data"]), e_n, row["words"],
        )  # fmt: skip
    console.show_table(made)
