"""WHAT was measured: a recording with its clock, its uncertainty and all that was done to it.

A recording holds one or more streams, each with its own clock: a log may hold an accelerometer at
400 Hz beside a position sensor at 10 Hz. All values are SI; what is missing is NaN and stays so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.model.plain import Finite
from simcompare.model.trajectory import Array

#: INFO: no defect; WARNING: a defect that was left and marked; REPAIR: something was changed
INFO, WARNING, REPAIR = "info", "warning", "repair"


@dataclass(frozen=True)
class Clock:
    """Where the times of a stream come from.

    Attributes:
        name: what stamped the samples ("column time", "header.stamp", "44100 Hz").
        start: when the first sample was taken, ISO 8601, empty where the log does not say.
        first_s: the log's own time of the first sample [s]; times of the stream begin with 0.
        u_s: standard uncertainty of one stamp [s].
        resolution_s: smallest step that the stamps can show [s], 0 where none is seen.
    """

    name: str
    start: str = ""
    first_s: float = 0.0
    u_s: float = 0.0
    resolution_s: float = 0.0


@dataclass(frozen=True)
class Channel:
    """One measured quantity.

    Attributes:
        values: (n,), NaN where nothing was measured.
        unit: SI unit as pint writes it, "1" for a number.
        frame: frame in which a component is given ("sensor", "world", a body's name), or empty.
        u: standard uncertainty in the same unit: one number, one per sample, or ``None`` (unknown).
        sensor: what measured it.
        kind: what a number alone does not say, such as "specific_force" or "gravity_removed".
        raw: name of the column in the log.
        saturated: samples at which the sensor was at its end (n,), ``None`` where none was.
    """

    values: Array
    unit: str
    frame: str = ""
    u: float | Array | None = None
    sensor: str = ""
    kind: str = ""
    raw: str = ""
    saturated: NDArray[np.bool_] | None = None


@dataclass(frozen=True)
class Event:
    """Something that happened at one instant, such as an impact.

    Attributes:
        name: what it was.
        time_s: when, on the clock of its stream [s].
        stream: name of the stream.
        u_s: standard uncertainty of the time [s], ``None`` where unknown.
        value: a number that belongs to it (a peak), ``None`` where there is none.
    """

    name: str
    time_s: float
    stream: str
    u_s: float | None = None
    value: float | None = None


@dataclass(frozen=True)
class Repair:
    """One thing that was noticed or changed on the way from the log to the recording.

    Attributes:
        rule: short name of the defect ("duplicate_time").
        severity: INFO, WARNING or REPAIR.
        text: one sentence: what was found, and what was done.
        stream: where; empty for the whole file.
        channel: raw name of the column, empty for whole rows.
        rows: rows of the log (lines, messages, samples; counted from 1) as (first, last) ranges.
        count: number of rows, also where ``rows`` is shortened.
        before: numbers that describe the data before ("max", "median_dt_s", …).
        after: the same afterwards.
    """

    rule: str
    severity: str
    text: str
    stream: str = ""
    channel: str = ""
    rows: tuple[tuple[int, int], ...] = ()
    count: int = 0
    before: Mapping[str, Finite] = field(default_factory=dict)
    after: Mapping[str, Finite] = field(default_factory=dict)


@dataclass(frozen=True)
class Conversion:
    """How a raw column became a channel: value = factor·raw + offset.

    Attributes:
        raw: column of the log.
        raw_unit: its unit as the log, or the mapping file, writes it.
        channel: name of the channel, empty for a column that was left out.
        unit: SI unit of the channel.
        factor: what the raw values were multiplied by; a sign is in it.
        offset: what was added afterwards, in the SI unit.
        reason: why a column was left out, or where factor and offset come from.
        cure: the line of a mapping file that keeps a column that was left out.
    """

    raw: str
    raw_unit: str
    channel: str
    unit: str
    factor: float = 1.0
    offset: float = 0.0
    reason: str = ""
    cure: str = ""


@dataclass(frozen=True)
class Provenance:
    """Where a recording comes from and everything that was done to it.

    Attributes:
        file: name of the log.
        sha256: of the log (of all its files, in order, where it is a folder).
        size_bytes: its size.
        importer: which reader read it.
        version: version of simcompare that read it.
        mode: "strict" or "repair".
        conversions: every column of the log.
        repairs: everything noticed or changed.
        about: what the log or the mapping says of itself (device, licence, citation, …).
    """

    file: str
    sha256: str
    size_bytes: int
    importer: str
    version: str
    mode: str
    conversions: tuple[Conversion, ...] = ()
    repairs: tuple[Repair, ...] = ()
    about: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Stream:
    """Channels that were sampled together.

    Attributes:
        time_s: (n,), increasing, 0 at the first sample [s].
        channels: name (with the unit at its end) -> channel.
        clock: where the times come from.
        gaps: pairs (i, i+1) of neighbouring samples between which some are missing.
    """

    time_s: Array
    channels: Mapping[str, Channel]
    clock: Clock
    gaps: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        for name, channel in self.channels.items():
            if len(channel.values) != len(self.time_s):
                raise ValueError(f"{name}: {len(channel.values)} values, {len(self.time_s)} times")


@dataclass(frozen=True, repr=False)
class Recording:
    """A log from a real device, in SI.

    Attributes:
        streams: name -> stream.
        provenance: where it comes from.
        events: instants that were found in it.
    """

    streams: Mapping[str, Stream]
    provenance: Provenance
    events: tuple[Event, ...] = ()

    def __repr__(self) -> str:
        streams = (
            f"{name}: {len(one.time_s)} samples of {', '.join(one.channels)}"
            for name, one in self.streams.items()
        )
        return "\n  ".join(["Recording", *streams])

    def find(self, name: str) -> tuple[str, str]:
        """Stream and full name of a channel that is called with or without unit, or stream.

        "angle", "angle_rad" and "swing_2/angle_rad" may all mean the same channel.

        Raises:
            UnknownName: no channel is called so.
            InputError: channels of several streams are; or it is a column that was left out.
        """
        wanted, _, short = name.rpartition("/")
        places = [
            (stream, full)
            for stream, content in self.streams.items()
            if not wanted or stream == wanted
            for full in [units.find_name(short, content.channels)]
            if full is not None
        ]
        if len(places) > 1:
            full = ", ".join("/".join(place) for place in places)
            text = f"is the name of {len(places)} channels ({full}); write {places[0][0]}/{short}"
            raise InputError(name, [f"{text}, or another stream"])
        if not places:
            self._tell_left_out(short)
            known = [f"{s}/{c}" for s, content in self.streams.items() for c in content.channels]
            raise UnknownName("channel", name, known)
        return places[0]

    def _tell_left_out(self, name: str) -> None:
        for one in self.provenance.conversions:
            if not one.channel and one.cure and one.raw.lower() == name.lower():
                text = f"{one.reason}, so it was left out; a mapping file keeps it"
                raise InputError(f"column {one.raw!r}", [f"{text}; cure: {one.cure}"])


def ranges(rows: Iterable[int]) -> tuple[tuple[int, int], ...]:
    """Increasing row numbers as (first, last) ranges: 3, 4, 5, 9 becomes (3, 5), (9, 9)."""
    numbers = np.asarray(list(rows) if not isinstance(rows, np.ndarray) else rows, dtype=np.int64)
    if not len(numbers):
        return ()
    cuts = np.flatnonzero(np.diff(numbers) != 1)
    first = numbers[np.concatenate(([0], cuts + 1))]
    last = numbers[np.concatenate((cuts, [len(numbers) - 1]))]
    return tuple(zip(first.tolist(), last.tolist(), strict=True))
