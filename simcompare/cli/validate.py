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


def _print_parameters(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    rows = [row for row in found["parameters"] if row["kind"] != "scenario"]
    if not rows:
        return
    made = console.table("parameter", "unit", "known before", "fitted", "from")
    for row in rows:
        before = console.number(row["known"], row["u_known"])
        after = "" if row["fitted"] is None else console.number(row["fitted"], row["u_fitted"])
        made.add_row(row["name"], _unit(row), before, after, row["source"])
    console.show_table(made)


def _unit(row: dict[str, Any]) -> str:
    from simcompare import units

    return "" if row["unit"] == "1" else units.symbol(row["unit"])


def _print_waveforms(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    rows = [row for row in found["waveforms"] if row["judged"]]
    heads = ("engine", "stream", "quantity", "parameters", "RMSE", "bias", "largest", "% of range")
    made = console.table(*heads, "magnitude", "phase")
    for row in rows:
        share = None if row["nrmse"] is None else 100 * row["nrmse"]
        made.add_row(
            row["source"], row["stream"], f"{row['probe']} [{_unit(row)}]", row["parameters"],
            *(_short(row[key]) for key in ("rmse", "bias", "max_abs")), _short(share),
            _short(row["magnitude"]), _short(row["phase"]),
        )  # fmt: skip
    console.show_table(made)


def _short(value: float | None) -> str:
    return "–" if value is None else f"{value:.3g}"


def _print_values(found: dict[str, Any]) -> None:
    from simcompare.cli import console

    if not found["values"]:
        return
    made = console.table("engine", "stream", "quantity", "simulated", "measured", "E_n", "verdict")
    for row in found["values"]:
        made.add_row(
            row["source"], row["stream"], f"{row['measure']} [{_unit(row)}]",
            console.number(row["simulated"], row["u_simulated"]),
            console.number(row["measured"], row["u_data"]), _short(row["e_n"]), row["words"],
        )  # fmt: skip
    console.show_table(made)
