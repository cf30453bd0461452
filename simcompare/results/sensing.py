"""Sensors of a run that are not ideal: one device for all sources, and what it read of each."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from simcompare.hardware.sensors import reading as readings
from simcompare.hardware.sensors.drawn import DrawnSensor
from simcompare.hardware.sensors.drawn_zones import DrawnZones, ZoneReading
from simcompare.hardware.sensors.error_model import Reading
from simcompare.model.trajectory import Array
from simcompare.results.asked_sensors import Drawn
from simcompare.results.records.run import RunRecord
from simcompare.results.records.sensing import (
    AxisDeviation,
    Sensing,
    SensorRecord,
    SourceDeviation,
    ZoneSettings,
)
from simcompare.results.run import Run, Stored, StoredReading

AnyRun = TypeVar("AnyRun", bound=Run)


def sensed(run: AnyRun, devices: Sequence[Drawn], seed: int) -> AnyRun:
    """The run with what sensors read of its nominal repeats; its scores stay as they are."""
    assert isinstance(run.record, RunRecord)
    middle = run.record.repeats // 2
    nominal = (one for one in run.trajectories if one.repeat == middle)
    read = read_all(devices, nominal, seed)
    record = replace(run.record, sensing=record_of(devices, read, seed))
    return replace(run, record=record, stored_readings=read)


def read_all(
    devices: Sequence[Drawn], trajectories: Iterable[Stored], seed: int
) -> tuple[StoredReading, ...]:
    """What every device reads of every trajectory that has its signal."""
    found = []
    for one in trajectories:
        moved = one.trajectory
        for device in devices:
            read: Reading | ZoneReading | None
            if isinstance(device, DrawnZones):
                read = device.read(moved, seed)
            else:
                read = readings.read(device, moved.time_s, moved.signals, seed)
            if read is not None:
                found.append(StoredReading(one.source, one.contact, device.signal, read))
    return tuple(found)


def record_of(devices: Sequence[Drawn], read: Sequence[StoredReading], seed: int) -> Sensing | None:
    """What run.json says of it; ``None`` where there are no devices."""
    if not devices:
        return None
    records = (
        _record_of_zones(device, read) if isinstance(device, DrawnZones) else _record(device, read)
        for device in devices
    )
    return Sensing(seed, tuple(records))


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
                _deviations_of(one.reading, sensor.axes), one.reading.notes,
            )
            for one in read
            if one.signal == sensor.signal and isinstance(one.reading, Reading)
        ),
    )  # fmt: skip


def _record_of_zones(sensor: DrawnZones, read: Sequence[StoredReading]) -> SensorRecord:
    device = sensor.device
    return SensorRecord(
        signal=sensor.signal, unit="m", axes="", sheet=sensor.sheet.name, chip=sensor.sheet.chip,
        part="zones", document=sensor.sheet.document, rate_Hz=device.rate_Hz, bandwidth_Hz=np.inf,
        poles=0, full_scale=device.numbers.reach_m, resolution=device.numbers.count_m,
        temperature_C=device.temperature_C, latency_s=device.latency_s, jitter_s=0.0,
        terms=tuple(sensor.terms()),
        deviations=tuple(
            _deviation_of_zones(one, one.reading)
            for one in read
            if one.signal == sensor.signal and isinstance(one.reading, ZoneReading)
        ),
        zones=ZoneSettings(
            in_a_row=device.zones, ambient_klux=device.ambient_klux, crosstalk=device.crosstalk,
            order=device.order, reflectance=dict(sensor.reflectance),
        ),
    )  # fmt: skip


def _deviation_of_zones(one: StoredReading, reading: ZoneReading) -> SourceDeviation:
    """How far ranges are off where they can be trusted, and how often the chip says what."""
    frames = reading.frames
    off = (frames.range_m - reading.ideal)[frames.valid]
    codes, counts = np.unique(frames.status, return_counts=True)
    axes: tuple[AxisDeviation, ...] = ()
    if len(off):
        low, median, high = np.quantile(off, (0.16, 0.5, 0.84)).tolist()
        whole = float(off.mean()), float(off.std()), _rms(off)
        axes = (AxisDeviation("", *whole, 0, median, (high - low) / 2),)
    return SourceDeviation(
        one.source, one.contact, len(reading.time_s), axes,
        statuses={str(c): n for c, n in zip(codes.tolist(), counts.tolist(), strict=True)},
    )  # fmt: skip


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _deviations_of(reading: Reading, axes: str) -> tuple[AxisDeviation, ...]:
    """How far each axis of a reading is from the ideal signal."""
    count = len(reading.time_s)
    off = (reading.measured - reading.ideal).reshape(count, -1)
    cut = reading.saturated.reshape(count, -1)
    letters = axes if len(axes) == off.shape[1] else " " * off.shape[1]
    return tuple(
        AxisDeviation(
            letter.strip(), float(values.mean()), float(values.std()),
            _rms(values), int(cut[:, i].sum()),
        )
        for i, (letter, values) in enumerate(zip(letters, off.T, strict=True))
    )  # fmt: skip
