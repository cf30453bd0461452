"""Sensors of a run that are not ideal: one device for all sources, and what it read of each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from simcompare.hardware.sensors import reading as readings
from simcompare.hardware.sensors.drawn import DrawnSensor, drawn
from simcompare.hardware.sensors.error_model import Reading
from simcompare.hardware.sensors.signals import chosen
from simcompare.model.scenario import Scenario
from simcompare.model.sensor_errors import SensorErrors
from simcompare.results.records.sensing import (
    AxisDeviation,
    Sensing,
    SensorRecord,
    SourceDeviation,
)
from simcompare.results.run import Stored, StoredReading


def devices_of(
    scenario: Scenario, asked: Mapping[str, SensorErrors], seed: int
) -> tuple[DrawnSensor, ...]:
    """The devices of a scenario's sensors, and of those that a user asks for.

    Args:
        scenario: the scene.
        asked: owner, signal or component -> errors, in place of those of the scenario.
        seed: of all streams.

    Raises:
        UnknownName: no such sensor, sheet or range.
        InputError: a sheet that does not fit.
    """
    found: dict[str, DrawnSensor] = {}
    for name, errors in {**scenario.sensor_errors(), **asked}.items():
        signals = chosen(name, scenario.signals(), scenario.name)
        found.update({one.signal: one for one in drawn(errors, signals, seed)})
    return tuple(found.values())


def read_all(
    devices: Sequence[DrawnSensor], trajectories: Iterable[Stored], seed: int
) -> tuple[StoredReading, ...]:
    """What every device reads of every trajectory that has its signal."""
    found = []
    for one in trajectories:
        moved = one.trajectory
        for device in devices:
            read = readings.read(device, moved.time_s, moved.signals, seed)
            if read is not None:
                found.append(StoredReading(one.source, one.contact, device.signal, read))
    return tuple(found)


def record_of(
    devices: Sequence[DrawnSensor], read: Sequence[StoredReading], seed: int
) -> Sensing | None:
    """What run.json says of it; ``None`` where there are no devices."""
    if not devices:
        return None
    return Sensing(seed, tuple(_record(device, read) for device in devices))


def _record(sensor: DrawnSensor, read: Sequence[StoredReading]) -> SensorRecord:
    device = sensor.device
    return SensorRecord(
        signal=sensor.signal, unit=sensor.unit, axes=sensor.axes, sheet=sensor.sheet,
        chip=sensor.chip, part=sensor.part, document=sensor.source, rate_Hz=device.rate_Hz,
        bandwidth_Hz=device.bandwidth_Hz, poles=device.poles, full_scale=device.full_scale,
        resolution=device.resolution, temperature_C=device.temperature_C,
        latency_s=device.latency_s, jitter_s=device.jitter_s, terms=sensor.terms,
        deviations=tuple(
            SourceDeviation(
                one.source, one.contact, len(one.reading.time_s),
                deviations_of(one.reading, sensor.axes), one.reading.notes,
            )
            for one in read
            if one.signal == sensor.signal
        ),
    )  # fmt: skip


def deviations_of(reading: Reading, axes: str) -> tuple[AxisDeviation, ...]:
    """How far each axis of a reading is from the ideal signal."""
    count = len(reading.time_s)
    off = (reading.measured - reading.ideal).reshape(count, -1)
    cut = reading.saturated.reshape(count, -1)
    letters = axes if len(axes) == off.shape[1] else " " * off.shape[1]
    return tuple(
        AxisDeviation(
            letter.strip(), float(values.mean()), float(values.std()),
            float(np.sqrt(np.mean(values**2))), int(cut[:, i].sum()),
        )
        for i, (letter, values) in enumerate(zip(letters, off.T, strict=True))
    )  # fmt: skip
