"""Drops of a ball from whatever was recorded.

Sound gives impact times; a stopwatch or phyphox's collision experiment gives them too; a video
gives height against time, whose arcs meet at the impacts; a table gives rebound heights.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from simcompare import units
from simcompare.errors import InputError
from simcompare.fitting.bounces import arcs, ordering
from simcompare.fitting.bounces.bounce_models import GRAVITY
from simcompare.fitting.bounces.flights import MIN_SAMPLES
from simcompare.fitting.bounces.impacts import CLOCKED, LOUDNESS, SOUND, TABLE, Impacts, Signal
from simcompare.hardware.recordings import bounce_table, published
from simcompare.inference import sources
from simcompare.model.recording import Recording
from simcompare.model.trajectory import Array

#: quantities of a table, and their units
_TABLE = {"restitution": "1", "rebound_height": "m", "impact_time": "s", "impact_speed": "m/s"}
#: part of the time from first to last impact for which the sound before and after is kept
_BESIDE = 0.12
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


def _of_table(table: bounce_table.BounceTable) -> list[Impacts]:
    """Impact times where the table has them, else rebound heights."""
    times = [quantity for quantity in table.quantities if quantity.name == "impact_time"]
    if not times:
        return [from_table(table)]
    u = [float("nan") if quantity.u is None else quantity.u for quantity in times]
    values = [quantity.value for quantity in times]
    return list(from_times(values, u, kind=CLOCKED, source=table.path.name))


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
    if name is None:
        raise InputError(source, [_what_is_there(recording)])
    stream, full = recording.find(name)
    seen = recording.streams[stream].channels[full]
    found = arcs.from_heights(
        recording.streams[stream].time_s, seen.values, seen.u, gravity_m_s2=gravity_m_s2,
        source=source,
    )  # fmt: skip
    return (found,)


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


def from_rebounds(
    heights_m: ArrayLike,
    u_m: ArrayLike | None = None,
    *,
    numbers: Sequence[int] | None = None,
    drop_height: tuple[float, float] | None = None,
    source: str = "",
) -> Impacts:
    """One drop from rebound heights.

    Args:
        heights_m: of the apexes above the floor (n,) [m].
        u_m: standard uncertainty, one or one each; ``None`` where unknown [m].
        numbers: after which impact each comes; 1, 2, 3, … where not given.
        drop_height: the drop's own height and its standard uncertainty, where it was measured [m].
        source: name of the file.

    Raises:
        InputError: a height is not positive, or a rebound is higher than what came before.
    """
    heights = np.asarray(heights_m, dtype=float)
    u = np.full(len(heights), np.nan)
    if u_m is not None:
        u[:] = u_m
    which = list(range(1, len(heights) + 1)) if numbers is None else [int(n) for n in numbers]
    if drop_height is not None:
        heights = np.concatenate(([drop_height[0]], heights))
        u, which = np.concatenate(([drop_height[1]], u)), [0, *which]
    order = np.argsort(which, kind="stable")
    heights, u, which = heights[order], u[order], [which[k] for k in order]
    faults = [f"rebound {n}: {h:g} m is not a height above the floor"
              for n, h in zip(which, heights, strict=True) if not h > 0]  # fmt: skip
    spread = np.where(np.isfinite(u), u, 0.0)
    for k in np.flatnonzero(np.diff(heights) > 4 * np.hypot(spread[1:], spread[:-1])).tolist():
        faults.append(
            f"rebound {which[k + 1]}: {heights[k + 1]:g} m is higher than the {heights[k]:g} m"
            " before it; a ball that is not struck cannot rise so high"
        )
    if len(heights) < 2:
        faults.append(f"{len(heights)} height; two at least tell a restitution: give the drop"
                      " height with its uncertainty, or more rebounds")  # fmt: skip
    if faults:
        raise InputError(source or "rebound heights", faults)
    missed = tuple(sorted(set(range(which[0], which[-1])) - set(which)))
    return Impacts(kind=TABLE, source=source, heights_m=heights, u_heights_m=u,
                   height_numbers=tuple(which), missed=missed)  # fmt: skip


def from_table(
    table: bounce_table.BounceTable, drop_height_m: float | None = None, u_m: float = 0.0
) -> Impacts:
    """One drop from a table of rebound heights.

    Args:
        table: as it was read.
        drop_height_m: height of the drop, where the table's head does not give it [m].
        u_m: its standard uncertainty; half a millimetre where it is 0 [m].

    Raises:
        InputError: the table holds no rebound heights, or they contradict each other.
    """
    rows = [q for q in table.quantities if q.name == "rebound_height"]
    name = table.path.name
    if not rows:
        held = ", ".join(sorted({q.name for q in table.quantities}))
        raise InputError(name, [f"holds {held}, but no rebound_height; a fit needs heights"])
    if drop_height_m is None and "drop_height" in table.parameters:
        drop_height_m = units.to_si(table.parameters["drop_height"], "m", f"{name}, drop_height")
    drop = None if drop_height_m is None else (drop_height_m, u_m or 5e-4)
    u = [np.nan if q.u is None else q.u for q in rows]
    found = from_rebounds(
        [q.value for q in rows], u, numbers=[q.bounce for q in rows], drop_height=drop, source=name
    )
    if drop is not None and not u_m:
        note = "the drop height has no stated uncertainty; half a millimetre was taken"
        found = replace(found, notes=(*found.notes, note))
    return found


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
        fitting = [full for full, short in found if short == name or short.endswith(f"_{name}")]
        if len(fitting) == 1:
            return fitting[0]
        if fitting:
            raise InputError(
                recording.provenance.file,
                [f"more than one channel may be the ball's height: {', '.join(fitting)}; name one"],
            )
    return found[0][0] if len(found) == 1 else None


def _count(number: int) -> str:
    return "1 impact was" if number == 1 else f"{number} impacts were"
