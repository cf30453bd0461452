"""Which channels of a recording are analysed, and over which stretch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.model.recording import Recording, Stream
from simcompare.model.trajectory import Array
from simcompare.statistics.stillness import longest_still

#: units of what an inertial sensor measures
INERTIAL = ("m/s**2", "rad/s")
#: readings below which there is nothing to say
_LEAST = 64
#: part of a stretch that is still where nothing is said of motion
_MOST = 0.8
#: standard deviation of the interval between readings, relative to the interval
_UNEVEN = 0.1


@dataclass(frozen=True, eq=False)
class Stretch:
    """Evenly spaced readings of some channels.

    Attributes:
        values: name -> readings (n,).
        units: name -> SI unit.
        rate_Hz: readings in a second.
        start_s: where it begins [s].
        length_s: of the whole record [s].
        chosen: "given", "whole", "still" or "all"; "gap" where a gap cut it short.
        still_s: the still part of a stretch that is given and in which something may move.
    """

    values: Mapping[str, Array]
    units: Mapping[str, str]
    rate_Hz: float
    start_s: float
    length_s: float
    chosen: str
    still_s: tuple[float, float] | None = None

    @property
    def count(self) -> int:
        """Number of readings."""
        return len(next(iter(self.values.values())))


def of_recording(
    recording: Recording, channels: Sequence[str], start_s: float | None, end_s: float | None
) -> Stretch:
    """The channels that are asked for, or those of an inertial sensor.

    All channels of the sensor judge whether it is still, also those that are not asked for.

    Raises:
        UnknownName: no channel is called so.
        InputError: too few readings, or readings that are not evenly spaced.
    """
    stream, names = _chosen(recording, channels)
    judges = [name for name, one in stream.channels.items() if one.unit in INERTIAL]
    every = list(dict.fromkeys([*names, *judges]))
    values = {name: stream.channels[name].values for name in every}
    of = {name: stream.channels[name].unit for name in every}
    found = of_values(stream.time_s, values, of, stream.gaps, start_s, end_s)
    still_s = None if found.chosen in ("still", "all") else _still(found)
    return replace(found, values={name: found.values[name] for name in names}, still_s=still_s)


def _still(found: Stretch) -> tuple[float, float] | None:
    """The still part, where it is less than most of a stretch."""
    first, end = longest_still(np.column_stack(list(found.values.values())), found.rate_Hz)
    if end - first >= _MOST * found.count or end - first < _LEAST:
        return None
    return found.start_s + first / found.rate_Hz, found.start_s + (end - 1) / found.rate_Hz


def of_values(
    time_s: Array, values: Mapping[str, Array], of: Mapping[str, str], gaps: Sequence[int],
    start_s: float | None, end_s: float | None,
) -> Stretch:  # fmt: skip
    """A stretch without gaps: the one that is asked for, or else the longest still one.

    Raises:
        InputError: too few readings, or readings that are not evenly spaced.
    """
    table = np.column_stack(list(values.values()))
    given = start_s is not None or end_s is not None
    low, high = _window(time_s, start_s, end_s)
    pieces = list(_pieces(table, gaps, low, high))
    if given:
        found = max(pieces, key=lambda one: one[1] - one[0], default=(low, low))
        whole = "whole" if found == (0, len(table)) else "given"
        chosen = whole if found == (low, high) else "gap"
    else:
        found = _stillest(table, time_s, pieces)
        chosen = "all" if found == (0, len(table)) else "still"
    first, end = found
    rate_Hz = _rate(time_s[first:end], float(time_s[low]) if low < len(time_s) else 0.0)
    parts = {name: table[first:end, i] for i, name in enumerate(values)}
    return Stretch(parts, of, rate_Hz, float(time_s[first]), float(time_s[-1]), chosen)


def _chosen(recording: Recording, channels: Sequence[str]) -> tuple[Stream, list[str]]:
    """Stream and names of channels; names may be beginnings, such as "acc"."""
    if not channels:
        return _inertial(recording)
    stream_name, names = "", list[str]()
    for asked in channels:
        place, found = _called(recording, asked)
        if stream_name and place != stream_name:
            text = f"{names[0]} and {asked} are of two streams; analyse one after the other"
            raise InputError("--channel", [text])
        stream_name, names = place, names + [one for one in found if one not in names]
    return recording.streams[stream_name], names


def _called(recording: Recording, asked: str) -> tuple[str, list[str]]:
    wanted, _, short = asked.rpartition("/")
    for name, stream in recording.streams.items():
        begun = [one for one in stream.channels if one.startswith(short)]
        if begun and wanted in ("", name):
            exact = units.find_name(short, stream.channels)
            return name, [exact] if exact is not None else begun
    known = [f"{s}/{c}" for s, content in recording.streams.items() for c in content.channels]
    raise UnknownName("channel", asked, known)


def _inertial(recording: Recording) -> tuple[Stream, list[str]]:
    """What an inertial sensor measures, in the first stream that has any."""
    for stream in recording.streams.values():
        names = [name for name, one in stream.channels.items() if one.unit in INERTIAL]
        if names:
            return stream, names
    first = next(iter(recording.streams.values()))
    return first, list(first.channels)


def _window(time_s: Array, start_s: float | None, end_s: float | None) -> tuple[int, int]:
    low = 0 if start_s is None else int(np.searchsorted(time_s, start_s))
    high = len(time_s) if end_s is None else int(np.searchsorted(time_s, end_s, "right"))
    if high - low < _LEAST:
        asked = f"{start_s or 0:g} s to {float(time_s[-1]) if end_s is None else end_s:g} s"
        text = f"{asked} holds {max(0, high - low)} of {len(time_s)} readings; expected {_LEAST}"
        raise InputError("--from, --until", [f"{text} or more; it lasts {time_s[-1]:g} s"])
    return low, high


def _pieces(table: Array, gaps: Sequence[int], low: int, high: int) -> Iterator[tuple[int, int]]:
    """Stretches without gaps and missing values."""
    good = np.asarray(np.isfinite(table).all(axis=1))
    good[:low] = good[high:] = False
    # a stretch goes on where this reading and the one before are good, and no gap is between
    joined = np.asarray(good[1:] & good[:-1])
    joined[[gap for gap in gaps if gap < len(joined)]] = False
    starts = np.flatnonzero(good & ~np.concatenate(([False], joined)))
    ends = np.flatnonzero(good & ~np.concatenate((joined, [False]))) + 1
    yield from zip(starts.tolist(), ends.tolist(), strict=True)


def _stillest(table: Array, time_s: Array, pieces: list[tuple[int, int]]) -> tuple[int, int]:
    best = (0, 0)
    for low, high in pieces:
        if high - low <= max(_LEAST, best[1] - best[0]):
            continue
        rate_Hz = (high - low - 1) / float(time_s[high - 1] - time_s[low])
        first, end = longest_still(table[low:high], rate_Hz)
        if end - first > best[1] - best[0]:
            best = (low + first, low + end)
    return best


def _rate(time_s: Array, start_s: float) -> float:
    if not len(time_s):
        cure = "record it at rest, or give a stretch with --from and --until"
        raise InputError("recording", [f"no still stretch is found in it; {cure}"])
    if len(time_s) < _LEAST:
        text = f"the longest still stretch without gaps has {len(time_s)} readings"
        cure = "record longer at rest, or give a stretch with --from and --until"
        raise InputError("recording", [f"{text} (from {start_s:g} s); expected {_LEAST}; {cure}"])
    steps = np.diff(time_s)
    spread = float(steps.std() / steps.mean())
    if spread > _UNEVEN:
        text = f"readings come {100 * spread:.0f} % unevenly; an Allan deviation needs even ones"
        raise InputError("recording", [f"{text}; give the sensor a clock, or take another stretch"])
    return float(1 / steps.mean())
