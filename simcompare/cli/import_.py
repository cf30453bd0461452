"""``simcompare import``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from simcompare.cli import console

if TYPE_CHECKING:
    from simcompare.model.recording import Provenance, Recording

#: rows of a repair that are printed; recording.json has all
_SHOWN = 5


def _formats(incomplete: str) -> list[str]:
    from simcompare.hardware.logs.importers import targets

    return [name for name in targets() if name.startswith(incomplete)]


def import_(
    log: Path = typer.Argument(help="File or folder that a device, or its program, has written."),
    kind: str = typer.Option(
        None, "--as", help="Format; recognised by content.", autocompletion=_formats
    ),
    mapping: Path = typer.Option(
        None, "--map", help="YAML file with columns, units, frames, signs and the clock."
    ),
    strict: bool = typer.Option(
        False, "--strict", help="Refuse a log with any defect instead of repairing it."
    ),
    assume_units: bool = typer.Option(
        False, "--assume-units", help="Replace a unit that contradicts physics, and record it."
    ),
    template: bool = typer.Option(
        False, "--template", help="Print a mapping file for this log, to be filled in, and stop."
    ),
    out: Path = typer.Option(
        None, "--out", "-o", help="Folder of the recording (the log's name with .rec by default)."
    ),
    as_json: bool = typer.Option(False, "--json", help="Print one JSON object."),
) -> None:
    """Read a log of a device; what was repaired is recorded."""
    from simcompare.hardware import reading_process
    from simcompare.model.plain import plain
    from simcompare.verbs.import_log import facts, import_log

    if template:
        console.print_wanted(reading_process.template(log, kind=kind), nl=False)
        return
    place = out or Path(f"{log.stem or log.name}.rec")
    recording = import_log(
        log, kind=kind, mapping=mapping, strict=strict, assume_units=assume_units, out=place
    )
    if as_json:
        console.print_json(plain(facts(recording, place)))
        return
    _print(recording, log)
    typer.echo(f"Stored in {place}")


def _print(recording: Recording, log: Path) -> None:
    import numpy as np

    from simcompare import units
    from simcompare.hardware.conditioning.units.left_out import told
    from simcompare.hardware.importing import with_path

    about = recording.provenance
    typer.echo(f"{about.file}: {about.importer}, {about.size_bytes / 1e6:.3g} MB")
    table = console.Rows("stream", "samples", "seconds", "channel", "unit", "from", "range")
    for name, stream in recording.streams.items():
        start = [name, str(len(stream.time_s)), f"{stream.time_s[-1]:.6g}"]
        for channel, content in stream.channels.items():
            known = content.values[np.isfinite(content.values)]
            span = f"{known.min():.4g} … {known.max():.4g}" if len(known) else "nothing measured"
            unit = units.symbol(content.unit)
            table.add_row(*start, channel, "" if unit == "1" else unit, content.raw, span)
            start = ["", "", ""]
    console.show_table(table)
    if recording.events:
        console.print_wrapped([f"{len(recording.events)} events: {_times(recording)}"])
    left_out = [with_path(f"left out: {text}", log) for text in told(about.conversions)]
    console.print_wrapped(left_out)
    _print_repairs(about)


def _times(recording: Recording) -> str:
    shown = [f"{event.name} {event.time_s:.4f} s" for event in recording.events[:_SHOWN]]
    return ", ".join(shown) + (" …" if len(recording.events) > _SHOWN else "")


def _print_repairs(about: Provenance) -> None:
    """Everything noticed or changed, a line each."""
    for repair in about.repairs:
        where = "/".join(part for part in (repair.stream, repair.channel) if part)
        rows = ", ".join(f"{a}" if a == b else f"{a}-{b}" for a, b in repair.rows[:_SHOWN])
        more = " …" if len(repair.rows) > _SHOWN else ""
        place = f" [rows {rows}{more}]" if rows else ""
        text = f"{repair.severity}: {where + ': ' if where else ''}{repair.text}{place}"
        console.print_wrapped([text])
