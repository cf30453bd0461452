"""Sensors of a run as tables of pandas: what was drawn, and what they read."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors.drawn_zones import ZoneReading
from simcompare.hardware.sensors.error_model import Reading
from simcompare.hardware.sensors.signals import owner_of
from simcompare.model.trajectory import Array
from simcompare.results import frames
from simcompare.results.records.run import RunRecord
from simcompare.results.run import Run

if TYPE_CHECKING:
    import pandas as pd

_DRAWN = ("term", "axis", "value", "unit", "kind", "u", "says", "source", "confirmed")


def sensors(run: Run) -> pd.DataFrame:
    """One row for each number of each device; no row where all sensors are ideal."""
    import pandas as pd

    found = run.record.sensing if isinstance(run.record, RunRecord) else None
    rows = [
        {"signal": one.signal, "chip": one.chip, **{name: getattr(term, name) for name in _DRAWN}}
        for one in (found.sensors if found else ())
        for term in one.terms
    ]
    return pd.DataFrame(rows, columns=["signal", "chip", *_DRAWN])


def readings(
    run: Run, signal: str | None = None, source: str | None = None, contact: str | None = None
) -> pd.DataFrame:
    """One row for each sample: whose it is, time, ideal, measured and saturated of each axis.

    Of many zones, one row for each zone of each frame, with the columns of zones.csv.

    Raises:
        UnknownName: no such signal, source or level was read.
        InputError: nothing was read.
    """
    import pandas as pd

    if not run.stored_readings:
        fault = "all sensors of this run are ideal; ask for a real one, such as"
        raise InputError("readings", [f'{fault} run(…, sensor={{"imu": "mpu6050"}})'])
    frames.check_names(run, source, contact)
    signals = [name for one in run.stored_readings for name in (one.signal, owner_of(one.signal))]
    if signal is not None and signal not in signals:
        raise UnknownName("signal that was read", signal, dict.fromkeys(signals))
    found = [
        pd.DataFrame(
            {"source": one.source, "contact": one.contact, "signal": one.signal}
            | columns(one.reading)
        )
        for one in run.stored_readings
        if signal in (None, one.signal, owner_of(one.signal))
        and source in (None, one.source)
        and contact in (None, one.contact)
    ]
    if not found:
        raise InputError("readings", ["no source gives this signal at this level"])
    return pd.concat(found, ignore_index=True)


def columns(reading: Reading | ZoneReading) -> dict[str, Array]:
    """Time, and ideal, measured and saturated, a column for each axis; of zones, a row for each."""
    if isinstance(reading, ZoneReading):
        return reading.columns()
    found = {"time_s": reading.time_s}
    for kind in ("ideal", "measured", "saturated"):
        values = np.asarray(getattr(reading, kind))
        axes = "xyz" if values.ndim > 1 else ""
        found |= {f"{kind}.{axis}": values[:, i] for i, axis in enumerate(axes)} or {kind: values}
    return found
