"""Sensors of a run that are not ideal: one device for all sources, and what it read of each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from simcompare.errors import InputError, SimcompareError
from simcompare.hardware.sensors import reading as readings
from simcompare.hardware.sensors.drawn import DrawnSensor, drawn
from simcompare.hardware.sensors.error_model import Reading
from simcompare.hardware.sensors.signals import chosen
from simcompare.model.scenario import Scenario
from simcompare.model.sensor_errors import SensorErrors
from simcompare.results.records.run import RunRecord
from simcompare.results.records.sensing import (
    AxisDeviation,
    Sensing,
    SensorRecord,
    SourceDeviation,
)
from simcompare.results.run import Run, Stored, StoredReading

AnyRun = TypeVar("AnyRun", bound=Run)


def asked_devices(
    scenario: Scenario, sheets: Mapping[str, str | Path], seed: int
) -> tuple[DrawnSensor, ...]:
    """One device for each signal that a real sensor is to read.

    Args:
        scenario: the scene, which may say more of its sensors.
        sheets: owner, signal or component -> data sheet.
        seed: of all streams.

    Raises:
        InputError: unknown sensors, and sheets that do not exist or do not fit; all of them.
    """
    if seed < 0:
        raise InputError("--seed", [f"{seed} is below 0; expected a whole number from 0 on"])
    faults, found = [], {}
    for name, sheet in sheets.items():
        errors = SensorErrors.model_validate({"sheet": str(sheet)})
        try:
            devices_of(scenario, {name: errors}, seed)
        except SimcompareError as error:
            faults.append(f"{name}={sheet}: {error}")
            continue
        found[name] = errors
    if faults:
        raise InputError("--sensor", faults)
    return devices_of(scenario, found, seed)


def sensed(run: AnyRun, devices: Sequence[DrawnSensor], seed: int) -> AnyRun:
    """The run with what sensors read of its nominal repeats; its scores stay as they are."""
    assert isinstance(run.record, RunRecord)
    middle = run.record.repeats // 2
    nominal = (one for one in run.trajectories if one.repeat == middle)
    read = read_all(devices, nominal, seed)
    record = replace(run.record, sensing=record_of(devices, read, seed))
    return replace(run, record=record, stored_readings=read)


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
                _deviations_of(one.reading, sensor.axes), one.reading.notes,
            )
            for one in read
            if one.signal == sensor.signal
        ),
    )  # fmt: skip


def _deviations_of(reading: Reading, axes: str) -> tuple[AxisDeviation, ...]:
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
