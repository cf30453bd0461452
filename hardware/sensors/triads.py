"""The three axes of one sensor in a recording: found, and corrected with a calibration."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.sensors.calibration import Calibration
from simcompare.model.recording import INFO, Recording, Repair
from simcompare.model.trajectory import Array


@dataclass(frozen=True, eq=False)
class Triad:
    """Channels of one sensor, in the order of its axes.

    Attributes:
        stream: where they are.
        channels: their names, three or one.
    """

    stream: str
    channels: tuple[str, ...]

    def values(self, recording: Recording) -> Array:
        """Readings (n, k)."""
        channels = recording.streams[self.stream].channels
        return np.column_stack([channels[name].values for name in self.channels])


def find(recording: Recording, unit: str, wanted: str = "") -> Triad:
    """The sensor of a recording that measures in a unit.

    Args:
        recording: where it is sought.
        unit: of a calibration, such as "m/s**2".
        wanted: begin of the names of its channels, such as "acc"; needed where there are several.

    Raises:
        InputError: there is none, or more than one.
    """
    found = {stem: triad for stem, triad in _triads(recording, unit) if stem.startswith(wanted)}
    if len(found) == 1:
        return next(iter(found.values()))
    if not found:
        axes = "" if unit == "Pa" else " with the axes x, y and z"
        text = f"has no sensor{axes} in {units.symbol(unit)}"
        cure = "name its columns in a mapping file (simcompare import LOG --template)"
        raise InputError(recording.provenance.file, [f"{text}; {cure}"])
    named = ", ".join(found)
    log = shlex.quote(recording.provenance.file)
    cure = f"name one: simcompare calibrate {log} --sensor {next(iter(found))}"
    raise InputError(
        recording.provenance.file, [f"has several sensors in {units.symbol(unit)}: {named}; {cure}"]
    )


def corrected(recording: Recording, triad: Triad, calibration: Calibration) -> Recording:
    """The same with this sensor's readings corrected; told in the recording's provenance."""
    stream = recording.streams[triad.stream]
    values = calibration.apply(triad.values(recording))
    channels = dict(stream.channels)
    for number, name in enumerate(triad.channels):
        channels[name] = replace(channels[name], values=values[:, number])
    told = Repair(
        "calibrated", INFO,
        f"corrected with the {calibration.kind} calibration: S⁻¹·(reading - O)",
        triad.stream, ", ".join(triad.channels), count=len(values),
    )  # fmt: skip
    about = recording.provenance
    return replace(
        recording,
        streams={**recording.streams, triad.stream: replace(stream, channels=channels)},
        provenance=replace(about, repairs=(*about.repairs, told)),
    )


def _triads(recording: Recording, unit: str) -> Iterator[tuple[str, Triad]]:
    """Sensors, by how the names of their channels begin."""
    ending = units.suffix_for(unit)
    for name, stream in recording.streams.items():
        for channel, content in stream.channels.items():
            stem = channel.removesuffix(f"x{ending}")
            every = tuple(f"{stem}{axis}{ending}" for axis in "xyz")
            if content.unit != unit:
                continue
            if unit == "Pa":
                yield channel, Triad(name, (channel,))
            elif stem != channel and all(one in stream.channels for one in every):
                yield stem.removesuffix("_") or channel, Triad(name, every)
