"""The three axes of one sensor in a recording: found, and corrected with a calibration."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors.calibration import Calibration
from simcompare.model.recording import INFO, Recording, Repair, Stream
from simcompare.model.trajectory import Array

#: unit of a calibration -> that of a channel, and the end of its name
_UNITS = {"m/s²": ("m/s**2", "m_s2"), "rad/s": ("rad/s", "rad_s"), "Pa": ("Pa", "Pa")}


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
        unit: of a calibration, such as "m/s²".
        wanted: begin of the names of its channels, such as "acc"; needed where there are several.

    Raises:
        InputError: there is none, or more than one.
    """
    found = {stem: triad for stem, triad in _triads(recording, unit) if stem.startswith(wanted)}
    if len(found) == 1:
        return next(iter(found.values()))
    if not found:
        text = f"has no sensor with the axes x, y and z in {unit}" if unit != "Pa" else "has no Pa"
        cure = "name its columns in a mapping file (simcompare import LOG --template)"
        raise InputError(recording.provenance.file, [f"{text}; {cure}"])
    named = ", ".join(found)
    log = shlex.quote(recording.provenance.file)
    cure = f"name one: simcompare calibrate {log} --sensor {next(iter(found))}"
    raise InputError(recording.provenance.file, [f"has several sensors in {unit}: {named}; {cure}"])


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
    si, ending = _UNITS[unit]
    for name, stream in recording.streams.items():
        if si == "Pa":
            for channel, content in stream.channels.items():
                if content.unit == si:
                    yield channel, Triad(name, (channel,))
            continue
        yield from _of_stream(name, stream, si, ending)


def _of_stream(name: str, stream: Stream, si: str, ending: str) -> Iterator[tuple[str, Triad]]:
    pattern = re.compile(rf"^(?P<stem>.*?)_?x_{ending}$", re.I)
    for channel, content in stream.channels.items():
        match = pattern.match(channel)
        if match is None or content.unit != si:
            continue
        place = channel.rindex(f"x_{ending}") if f"x_{ending}" in channel else -1
        every = tuple(channel[:place] + axis + channel[place + 1 :] for axis in "xyz")
        if place >= 0 and all(one in stream.channels for one in every):
            yield match["stem"] or channel, Triad(name, every)
