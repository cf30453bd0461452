"""Drops of a ball from whatever was recorded: sound, video, stopwatch, or a table of bounces."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.fitting.bounces.impacts import (
    CLOCKED,
    Impacts,
    from_recording,
    from_table,
    from_times,
)

if TYPE_CHECKING:
    from simcompare.hardware.recordings.bounce_table import BounceTable

_TABLE = {"restitution": "1", "rebound_height": "m", "impact_time": "s", "impact_speed": "m/s"}


def drops_of(
    name: str | Path, mapping: str | Path | None, u_s: float | None, gravity_m_s2: float
) -> list[Impacts]:
    """Every drop in a recording, a log, or a table of bounces.

    Raises:
        InputError: nothing that bounces is in it.
    """
    from simcompare.hardware.recordings import bounce_table
    from simcompare.inference import sources

    path = bounce_table.facts().get(str(name), Path(name))
    if _is_table(path):
        return _of_table(bounce_table.read(path, _TABLE))
    source = sources.find(str(name), mapping=mapping)
    return list(from_recording(source.recording, u_s=u_s, gravity_m_s2=gravity_m_s2))


def _is_table(path: Path) -> bool:
    """Whether a file is a table of bounces: its first heading is "bounce"."""
    try:
        with path.open("rb") as file:
            lines = file.read(4096).decode("utf-8-sig", errors="replace").splitlines()
    except OSError:
        return False
    heads = [line for line in lines if line.strip() and not line.startswith("#")]
    return bool(heads) and heads[0].replace(";", ",").replace("\t", ",").split(",")[0] == "bounce"


def _of_table(table: BounceTable) -> list[Impacts]:
    """Impact times where the table has them, else rebound heights."""
    times = [quantity for quantity in table.quantities if quantity.name == "impact_time"]
    if not times:
        return [from_table(table)]
    u = [float("nan") if quantity.u is None else quantity.u for quantity in times]
    values = [quantity.value for quantity in times]
    return list(from_times(values, u, kind=CLOCKED, source=table.path.name))
