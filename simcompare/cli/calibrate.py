"""``simcompare calibrate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner, opening

if TYPE_CHECKING:
    from simcompare.results.records.calibration import CalibrationRecord


def calibrate(
    source: str = typer.Argument(
        None,
        help="Table of mean readings (pose,ax,ay,az), log or recording with still poses, or a"
        " stored calibration.json.",
        autocompletion=complete.recordings,
    ),
    kind: str = typer.Option(
        None, help="six-position, ellipsoid, rate-table or two-point; else what the readings allow."
    ),
    simulate: str = typer.Option(
        None,
        metavar="SHEET",
        help="Draw a device from a data sheet, lay it on its six sides, and show recovered beside"
        " true.",
        autocompletion=complete.sheets,
    ),
    gravity: str = typer.Option(None, help="Local g in m/s²; else that of anywhere at sea level."),
    gravity_u: str = typer.Option(None, help="Its standard uncertainty (0.001 m/s²)."),
    level: str = typer.Option(
        None, help="By how much poses are off the vertical at most (0.5 deg)."
    ),
    noise: str = typer.Option(
        None, help="Standard uncertainty of a mean reading, in SI; else told by the readings."
    ),
    sensor: str = typer.Option("", help="Begin of its channels' names, where there are several."),
    mapping: Path = typer.Option(None, "--map", help="YAML file with columns and units of a log."),
    apply: str = typer.Option(
        None, metavar="LOG", help="Also correct this log or recording, and store it."
    ),
    seed: int = typer.Option(0, help="Of a simulated device."),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the results' folder."),
    report: bool = typer.Option(True, help="Write report.html into the results' folder."),
    opened: bool = opening.OPTION,
    figures: str = typer.Option(
        None, metavar="FORMAT", help="Also write every picture as a file: pdf, png or svg."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Find what a sensor is off by, and correct it."""
    from simcompare.model.plain import plain
    from simcompare.reports.calibration import page
    from simcompare.verbs import calibrate as verb

    opening.check(opened, report=report, figures=figures)
    result = verb.calibrate(
        source, kind=kind, simulate=simulate, gravity=gravity, gravity_u=gravity_u, level=level,
        noise=noise, sensor=sensor, mapping=mapping, apply=apply, seed=seed, out=out,
    )  # fmt: skip
    ending.finish_block(
        lambda: page.block_of(result),
        result.folder,
        lambda: plain(result),
        lambda file: _show(result, file),
        report=report,
        opened=opened,
        as_json=as_json,
        figures=figures,
    )


def _show(result: CalibrationRecord, last_file: Path | None) -> None:
    """The answer, S and O, and what cannot be told apart."""
    from simcompare.reports.calibration import tables, words
    from simcompare.reports.render import numbers

    console.print_wrapped(map(numbers.tied, words.answer(result)))
    shown = [tables.terms(result), tables.truth(result)]
    if manner.is_verbose():
        shown += [tables.poses(result), tables.assumed(result), tables.shares(result)]
    for one in filter(None, shown):
        typer.echo()
        console.show_table(one)
    console.print_wrapped(words.notes(result))
    typer.echo("\nWhat these readings cannot tell apart:")
    console.print_wrapped(f"- {sentence}" for sentence in result.not_separable)
    if result.applied is not None:
        typer.echo(f"Corrected: {result.applied}")
    ending.show_places(result.folder, last_file)
