"""Drops of a ball from whatever was recorded.

Sound gives impact times; a stopwatch or phyphox's collision experiment gives them too; a video
gives height against time, whose arcs meet at the impacts. Tables of bounces are read in ``tables``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from simcompare import units
from simcompare.errors import InputError
from simcompare.fitting.bounces import arcs, ordering, tables
from simcompare.fitting.bounces.bounce_models import GRAVITY
from simcompare.fitting.bounces.flights import MIN_SAMPLES
from simcompare.fitting.bounces.impacts import CLOCKED, LOUDNESS, MAX_COUNT, SOUND, Impacts, Signal
from simcompare.hardware.logs import tracker_
from simcompare.hardware.mapping_lines import channels_line, quoted
from simcompare.hardware.recordings import published
from simcompare.inference import sources
from simcompare.model.recording import Recording
from simcompare.model.trajectory import Array

#: part of the time from first to last impact for which the sound before and after is kept
_BESIDE = 0.12
#: factor by which what falls in assumed metres may miss free fall
_FALLS = 3.0
#: part of the fastest speeds above which a ball moves
_MOVES = 0.2
_INTO_MAP = "into map.yaml, and add --map map.yaml"
#: what is said of a track whose units are assumed
_METRES = "Tracker writes no units: lengths were taken as metres, and times as seconds"
#: names that a height may have, best first
_HEIGHT_NAMES = ("height", "y", "z", "position_y", "position_z")


def drops_of(
    name: str | Path, mapping: str | Path | None, u_s: float | None, gravity_m_s2: float
) -> list[Impacts]:
    """Every drop in a recording, a log, or a table of bounces.

    Raises:
        InputError: nothing that bounces is in it.
    """
    path = published.tables().get(str(name), Path(name))
    if tables.is_table(path):
        return [tables.read(path, u_s)]
    if mapping is None:
        tables.check_headings(path)
    source = sources.find(str(name), mapping=mapping)
    return list(from_recording(source.recording, u_s=u_s, gravity_m_s2=gravity_m_s2))


def from_recording(
    recording: Recording,
    *,
    u_s: float | None = None,
    gravity_m_s2: float = GRAVITY,
) -> tuple[Impacts, ...]:
    """Every drop that a recording holds.

    Impacts that were heard come first, then instants of a stopwatch, then height against time.

    Args:
        recording: what was measured.
        u_s: standard uncertainty of the instants, in place of the recording's own [s].
        gravity_m_s2: free fall, for the arcs of a video.

    Raises:
        InputError: there is nothing that bounces in it, or too little of it.
    """
    source = recording.provenance.file
    times, u = _instants(recording)
    if len(times):
        kind = SOUND if any(e.name == "impact" for e in recording.events) else CLOCKED
        given = np.full(len(times), u_s) if u_s is not None else u
        return _heard(recording, from_times(times, given, kind=kind, source=source))
    name = _height_channel(recording)
    if name is not None and u_s is not None:
        text = "is of impact times, but the recording is a height over time; leave it out"
        raise InputError(f"--u-time, {source}", [text])
    if name is None:
        raise InputError(source, [_what_is_there(recording)])
    stream, full = recording.find(name)
    seen = recording.streams[stream].channels[full]
    time_s = recording.streams[stream].time_s
    guessed = [r.channel for r in recording.provenance.repairs if r.rule == tracker_.NO_UNITS]
    assumed = seen.raw in guessed
    _check_moves(seen.values, name, source)
    _check_scale(time_s, seen.values, gravity_m_s2, source, seen.raw, assumed=assumed)
    found = arcs.from_heights(time_s, seen.values, seen.u, gravity_m_s2=gravity_m_s2, source=source)
    return (replace(found, notes=(*found.notes, _METRES)) if assumed else found,)


def _check_moves(height: Array, name: str, source: str) -> None:
    """Raises ``InputError`` where nothing moves: a column that was not tracked, say."""
    seen = height[np.isfinite(height)]
    if len(seen) and np.ptp(seen) == 0:
        raise InputError(source, [
            f"{name} is {seen[0]:g} m in all samples, so nothing moves in it; a fit needs the"
            " height of the ball: export the column that holds it"
        ])  # fmt: skip


def _check_scale(
    time_s: Array, height: Array, gravity_m_s2: float, source: str, column: str, *, assumed: bool
) -> None:
    """Raises ``InputError`` where a height does not fall as one in metres and seconds does."""
    whole = np.isfinite(time_s) & np.isfinite(height)
    if np.count_nonzero(whole) < 2 * MIN_SAMPLES:
        return
    if assumed and np.all(np.diff(time_s) == 1):
        raise InputError(source, [
            'the time counts 0, 1, 2, …: these are frames, not seconds. Write the line "time:'
            f' {{rate_Hz: 30}}" with the frames in a second {_INTO_MAP}'
        ])  # fmt: skip
    fall = _fall(time_s[whole], height[whole]) / gravity_m_s2
    far = assumed and not 1 / _FALLS < abs(fall) < _FALLS
    unit, of_unit = ("cm", " with the right unit") if far else ("m", "")
    line = f"channels: {{height: {{column: {column}, unit: {unit}"
    if fall < -1 / _FALLS:
        text = (f'{column} grows downwards: the ball falls where it becomes larger. Write the line'
                f' "{line}, sign: -1}}}}"{of_unit} {_INTO_MAP}')  # fmt: skip
        raise InputError(source, [text])
    if far and fall > 0:
        raise InputError(source, [
            f"a ball falls with {gravity_m_s2:.3g} m/s², but {column} as metres falls with"
            f" {fall * gravity_m_s2:.3g} m/s²; the lengths are in another unit, or the clip is in"
            f' slow motion. Write the line "{line}}}}}"{of_unit} {_INTO_MAP}'
        ])  # fmt: skip


def _fall(time_s: Array, height: Array) -> float:
    """Acceleration downwards while the ball moves: in a hand and at rest it does not fall."""
    steps = np.diff(time_s)
    speed = np.diff(height) / steps
    fastest = np.sort(np.abs(speed))[-min(10, len(speed))]
    moves = np.abs(speed) > _MOVES * fastest
    bends = np.diff(speed) / ((steps[1:] + steps[:-1]) / 2)
    own = bends[moves[1:] & moves[:-1]]
    return -float(np.median(own)) if len(own) else 0.0


def _heard(recording: Recording, drops: tuple[Impacts, ...]) -> tuple[Impacts, ...]:
    """The same drops, each with the sound about its impacts."""
    found = next((one for one in recording.provenance.repairs if one.rule == "onsets"), None)
    stream = None if found is None else recording.streams.get(found.stream)
    if found is None or stream is None:
        return drops
    names = [name for name, one in stream.channels.items() if found.channel in (one.raw, name)]
    if not names:
        return drops
    values = stream.channels[names[0]].values
    return tuple(replace(drop, signal=_about(drop, stream.time_s, values)) for drop in drops)


def _about(drop: Impacts, time_s: Array, values: Array) -> Signal:
    """The part of a sound in which the impacts of a drop lie, those that were left out too."""
    instants = [*drop.times_s.tolist(), *(one.time_s for one in drop.dropped)]
    before = _BESIDE * (max(instants) - min(instants))
    inside = (time_s >= min(instants) - before) & (time_s <= max(instants) + before)
    return Signal(LOUDNESS, time_s[inside], np.nan_to_num(values[inside]))


def from_times(
    times_s: ArrayLike, u_s: ArrayLike | None = None, *, kind: str = SOUND, source: str = ""
) -> tuple[Impacts, ...]:
    """Drops from impact times; missed and spurious impacts are found and told.

    Args:
        times_s: in order, one or more drops after each other (n,) [s].
        u_s: standard uncertainty, one or one each; ``None`` where unknown [s].
        kind: where they come from.
        source: name of the file.

    Raises:
        InputError: times out of order, too few, or no two flights of them belong together.
    """
    times = np.asarray(times_s, dtype=float)
    u = np.full(len(times), np.nan)
    if u_s is not None:
        u[:] = u_s
    _check(times, u, source)
    found = []
    for part in ordering.split(times):
        ordered = ordering.order(times[part], u[part], source, first=part.start)
        kept = np.array(ordered.kept) + part.start
        found.append(
            Impacts(times[kept], u[kept], ordered.numbers, kind, source,
                    dropped=ordered.dropped, missed=ordered.missed)
        )  # fmt: skip
    return tuple(found)


def _instants(recording: Recording) -> tuple[Array, Array]:
    """Times and uncertainties of the events that are impacts."""
    heard = [e for e in recording.events if e.name == "impact"]
    if not heard:
        words = ("bounce", "start", "stop")
        heard = [e for e in recording.events if e.name.split(" ")[0] in words]
    streams = list(dict.fromkeys(e.stream for e in heard))
    # the longest series, should several streams of one log hold instants
    if streams:
        best = max(streams, key=lambda s: sum(e.stream == s for e in heard))
        heard = sorted((e for e in heard if e.stream == best), key=lambda e: e.time_s)
    u = [np.nan if e.u_s is None or e.u_s <= 0 else e.u_s for e in heard]
    return np.array([e.time_s for e in heard]), np.array(u)


def _what_is_there(recording: Recording) -> str:
    names = [f"{s}/{c}" for s, content in recording.streams.items() for c in content.channels]
    shown = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
    return (
        f"holds no impacts and no height; found the channels {shown or 'none'}. A fit of a ball"
        " needs a sound recording, instants of a stopwatch, or the ball's height (a channel in"
        " metres; name it if it is not called height, y or z)"
    )


def _check(times: Array, u: Array, source: str) -> None:
    faults = []
    if not np.all(np.isfinite(times)):
        faults.append("an impact time is missing or infinite")
    for k in np.flatnonzero(np.diff(times) <= 0)[:5].tolist():
        faults.append(f"impact {k + 2} at {times[k + 1]:g} s is not after impact {k + 1}"
                      f" at {times[k]:g} s")  # fmt: skip
    if np.any(u <= 0):
        faults.append("a standard uncertainty of an impact time is not above 0")
    if len(times) > MAX_COUNT:
        faults.append(
            f"{len(times)} impacts; a fit takes {MAX_COUNT} at most: cut out the part with the"
            " bounces"
        )
    if len(times) < 2:
        faults.append(
            f"{_count(len(times))} found; two at least are needed with a known drop height, three"
            " without: record closer to the ball, or lower the other noise"
        )
    if faults:
        raise InputError(source or "impacts", faults)


def _height_channel(recording: Recording) -> str | None:
    """Full name of the channel that is a height, ``None`` where there is none."""
    found = [
        (f"{stream}/{name}", name.removesuffix(units.suffix_of(name)).split(".")[-1])
        for stream, content in recording.streams.items()
        for name, channel in content.channels.items()
        if channel.unit == "m" and len(content.time_s) >= 2 * MIN_SAMPLES
    ]
    for name in _HEIGHT_NAMES:
        fitting = [full for full, short in found if short == name]
        fitting = fitting or [full for full, short in found if short.endswith(f"_{name}")]
        if len(fitting) == 1:
            return fitting[0]
        if fitting:
            raise InputError(recording.provenance.file, [_several(recording, fitting)])
    return found[0][0] if len(found) == 1 else None


def _several(recording: Recording, names: Sequence[str]) -> str:
    """What is said of several heights: the line that chooses the first of them."""
    stream, full = recording.find(names[0])
    column = recording.streams[stream].channels[full].raw
    conversions = recording.provenance.conversions
    unit = next((c.raw_unit for c in conversions if c.channel == full), "m")
    place = quoted(column if len(recording.streams) == 1 else f"{stream}/{column}")
    line = channels_line(f"height: {{column: {place}, unit: {quoted(unit)}}}")
    return (
        f"more than one channel may be the ball's height: {', '.join(names)}. Write the line"
        f" '{line}', with the column of your ball, {_INTO_MAP}"
    )


def _count(number: int) -> str:
    return "1 impact was" if number == 1 else f"{number} impacts were"
