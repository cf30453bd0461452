"""``simcompare sensor``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import complete, console, ending, manner, opening

if TYPE_CHECKING:
    from simcompare.verbs.sensor_shown import SensorAnswer, SensorSheets


def sensor(
    name: str = typer.Argument(
        None,
        help="Such as mpu6050, or a YAML file of your own; all sheets where it is left out.",
        autocompletion=complete.sheets,
    ),
    part: str = typer.Option(
        None, help="Of a chip with several sensors, such as gyroscope; the first if left out."
    ),
    range_: str = typer.Option(None, "--range", help="Full scale, such as '4 g'."),
    rate: str = typer.Option(None, help="Output data rate, such as 100Hz."),
    bandwidth: str = typer.Option(None, help="-3 dB bandwidth, such as 44Hz."),
    temperature: float = typer.Option(25.0, help="Of the device, in °C."),
    reading: str = typer.Option(None, help="True value, such as '0.5 g'."),
    across: str = typer.Option(None, help="True value along another axis, such as '1 g'."),
    axis: str = typer.Option(None, help="x, y or z; the least certain one if left out."),
    draw: int = typer.Option(0, metavar="N", help="Also show N drawn devices."),
    seed: int = typer.Option(0, min=0, help="Of all draws."),
    typ_is_sigma: float = typer.Option(
        1.0, help="Which part of a typical value is one standard deviation."
    ),
    rules: bool = typer.Option(False, "--rules", help="How values become distributions, in words."),
    template: bool = typer.Option(False, "--template", help="Print a data sheet to fill in."),
    out: Path = typer.Option(Path("runs"), "--out", "-o", help="Folder for the report."),
    report: bool = typer.Option(
        False, "--report/--no-report", help="Write an HTML page into the folder."
    ),
    opened: bool = opening.OPTION,
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Show what a data sheet says, and how uncertain a reading is."""
    from simcompare.model.plain import plain
    from simcompare.verbs import sensor as verb
    from simcompare.verbs.sensor_shown import SensorAnswer

    if template:
        console.print_wanted(verb.template(), nl=False)
        return
    found = verb.sensor(
        name, part=part, range=range_, rate=rate, bandwidth=bandwidth, temperature=temperature,
        reading=reading, across=across or 0.0, axis=axis, draw=draw, seed=seed,
        typ_is_sigma=typ_is_sigma,
    )  # fmt: skip
    if not isinstance(found, SensorAnswer):
        ending.finish(
            lambda: plain(found), lambda: _show_sheets(found, rules=rules), 0, as_json=as_json
        )
    page = _write(found, out) if report or opened else None
    ending.finish(
        lambda: plain(found), lambda: _show(found, page, rules=rules), 0,
        page=page if opened else None, as_json=as_json,
    )  # fmt: skip


def _write(found: SensorAnswer, out: Path) -> Path:
    from simcompare.reports import builder
    from simcompare.reports.sensor import page
    from simcompare.results import store
    from simcompare.verbs import sensor as verb

    store.check_writable(out)
    block = page.block_of(found, verb.rules())
    return builder.write_html_of([block], out / f"sensor-{found.name}-{found.part}.html")


def _show_sheets(found: SensorSheets, *, rules: bool) -> None:
    from simcompare.reports.sensor import tables

    if rules:
        _show_rules()
        return
    console.show_table(tables.of_sheets(found)._replace(title=""))
    console.print_wrapped(
        [
            "Confirmed: read in the maker's own text. More: simcompare sensor NAME,"
            " simcompare sensor --rules, simcompare sensor --template"
        ]
    )


def _show(found: SensorAnswer, page: Path | None, *, rules: bool) -> None:
    from simcompare import glossary
    from simcompare.reports.render import numbers
    from simcompare.reports.sensor import tables, words

    console.print_wrapped([numbers.tied(words.answer(found))])
    typer.echo("")
    lines = tables.of_entries(found)._replace(title="")
    console.show_table(lines if manner.is_verbose() else lines.narrow())
    typer.echo("")
    console.print_wrapped(map(numbers.tied, words.further(found)))
    if manner.is_verbose():
        console.print_wrapped([*words.notes(found), *glossary.legend(tables.WORDS)])
    if found.devices:
        typer.echo("\nDrawn devices")
        console.show_table(tables.of_devices(found)._replace(title=""))
    if rules:
        typer.echo("")
        _show_rules()
    others = [name for name in found.parts if name != found.part]
    if others:
        console.print_wrapped(
            [f"More: simcompare sensor {found.name} --part {name}" for name in others]
        )
    ending.show_places(None, page)


def _show_rules() -> None:
    from simcompare.verbs import sensor as verb

    for rule in verb.rules():
        kinds = f" ({', '.join(rule.kinds)})" if rule.kinds else ""
        console.print_wrapped([f"{rule.name}{kinds}: {rule.words} [{rule.source}]"])
