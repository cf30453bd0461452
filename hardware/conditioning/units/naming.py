"""What the columns of a log are called and in which unit they are."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware import joints
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping import ChannelMap, Mapping
from simcompare.hardware.raw import IMPORT, RawColumn, RawStream
from simcompare.model.recording import Conversion

#: columns whose name says that they measure an acceleration: there, g is no gram
_ACCELERATION = re.compile(
    r"acc|imu|specific.?force|(^|[_ ])a[xyz]?($|[_ ])|^g[xyz]?force", re.IGNORECASE
)
#: what the times of a stream are called
CLOCK = "time_s"
_NO_ACCELERATION = re.compile(r"gyr|mag|ang|rate|accura", re.IGNORECASE)


def prepare(work: Work) -> None:
    """Settles which column is the time, and the units that the mapping or the name give."""
    stream = work.stream
    names = [column.name for column in stream.columns]
    for name in dict.fromkeys(names):
        if names.count(name) > 1:
            work.fault("stands more than once; rename one of the columns", channel=name)
    _settle_time(work, names)
    if not len(stream):
        work.fault("holds no samples; expected at least two")
    for column in stream.columns:
        _settle_unit(work, column)


def _settle_time(work: Work, names: Sequence[str]) -> None:
    stream, time = work.stream, work.mapping.time
    if time is not None and time.rate_Hz is not None:
        stream.time, stream.increment_s = None, 1 / time.rate_Hz
    if time is not None and time.columns:
        here = [name for name in time.columns if name in names]
        if len(here) == 1:
            stream.time = here[0]
        elif len(names):
            wanted = " or ".join(time.columns)
            work.fault(f"there is no one column {wanted} for the time; it has {', '.join(names)}")
    if stream.time is None and stream.increment_s is None:
        likely = next((c.name for c in stream.columns if _increases(c)), "…")
        hint = f"; {likely!r} increases from row to row and may be it" if likely != "…" else ""
        work.fault(
            f"no column is a time (columns: {', '.join(names[:20])}){hint}. Write a mapping file"
            f" (--map) with time: {{column: {likely}, unit: s}} or time: {{rate_Hz: …}}"
        )


def _increases(column: RawColumn) -> bool:
    """Whether every value is larger than the one before."""
    return len(column.values) > 2 and bool((np.diff(column.values) > 0).all())


def _settle_unit(work: Work, column: RawColumn) -> None:
    wish, time = work.wishes(column), work.mapping.time
    if wish is not None:
        column.unit = wish.unit if wish.scale == 1.0 else column.unit
        column.limits = wish.limits or column.limits
        column.kind = wish.kind or column.kind
    elif column.name == work.stream.time and time is not None and time.unit is not None:
        column.unit = time.unit
    elif not column.unit:
        column.unit = units.unit_of(column.name) if units.suffix_of(column.name) else ""


def measures_acceleration(name: str) -> bool:
    """Whether a name says that its column is an acceleration."""
    return bool(_ACCELERATION.search(name)) and not _NO_ACCELERATION.search(name)


def unit_text(name: str, unit: str) -> str:
    """The unit as it is meant: in a column of accelerations g is standard gravity, no gram."""
    if unit in ("g", "G", "mg") and _ACCELERATION.search(name):
        return "g_0" if unit in ("g", "G") else "mg_0"
    return unit


def channels_of(work: Work, column: RawColumn) -> Sequence[tuple[ChannelMap | None, str]]:
    """Channels that a column becomes, as (wish, name without unit)."""
    wishes = work.mapping.of_column(work.stream.name, column.name)
    if wishes:
        return [(wish, name) for name, wish in wishes]
    return [(None, slug(column.name))]


def conversion(work: Work, column: RawColumn, wish: ChannelMap | None, name: str) -> Conversion:
    """How a column becomes SI; a fault, or an empty channel, where its unit is not known."""
    unit = unit_text(f"{column.name} {name}", wish.unit if wish else column.unit)
    odd = _odd_unit(column.name) if not unit else ""
    if odd and not work.mapping.channels:
        work.fault(
            f"has a unit that is not understood: {units.not_a_unit(odd)}", channel=column.name
        )
        return Conversion(column.name, odd, "", "", reason="has an unknown unit")
    if not unit and work.mapping.channels:
        return Conversion(column.name, "", "", "", reason="has no unit and is not in the mapping")
    if not unit:
        work.unitless.append(column.name)
        return Conversion(column.name, "", "", "", reason="has no unit")
    try:
        if unit == "g":
            raise InputError("", ["'g' may be gram or standard gravity; write gram or g_0"])
        factor, offset, si_unit = units.si_of(unit, "")
    except InputError as error:
        work.fault("; ".join(error.faults), channel=column.name)
        return Conversion(column.name, unit, "", "", reason="has an unknown unit")
    scale, sign = (wish.scale, wish.sign) if wish else (1.0, 1)
    added = wish.offset if wish else 0.0
    suffix = units.suffix_for(si_unit)
    full = name if not suffix or name.endswith(suffix) else f"{name}{suffix}"
    reason = "mapping" if wish else ""
    if full == CLOCK:  # the times of the stream are called so
        full, reason = f"recorded_{CLOCK}", f"{CLOCK} is the name of the clock"
    return Conversion(
        column.name, unit, full, si_unit, sign * scale * factor, added * factor + offset, reason
    )


def _odd_unit(name: str) -> str:
    """What stands in brackets at the end of a name, where a unit should."""
    match = re.search(r"[\[(]\s*([A-Za-zµμΩ°%][^()\[\]]{0,11}?)\s*[\])]\s*$", name)
    return match[1] if match and " " not in match[1] else ""


def unit_faults(work: Work) -> list[str]:
    """Faults of names and units of a stream that is refused for other reasons already."""
    before = len(work.faults)
    for column in work.data:
        for wish, name in channels_of(work, column):
            conversion(work, column, wish, name)
    return [fault for fault in work.faults[before:] if fault not in work.faults[:before]]


def without_unit(works: Sequence[Work]) -> list[str]:
    """One fault for all columns whose unit is not known anywhere."""
    open_ = {c.name: c for w in works for c in w.data if c.name in w.unitless and c.joint}
    asked = [joints.question([*open_.values()])] if open_ else []
    unitless = dict.fromkeys(name for work in works for name in work.unitless)
    names = [name for name in unitless if name not in open_]
    if not names:
        return asked
    shown = ", ".join(repr(name) for name in names[:8]) + (" …" if len(names) > 8 else "")
    have = "column has" if len(names) == 1 else "columns have"
    return [
        *asked,
        f"{len(names)} {have} no unit, neither in the name nor in the file: {shown};"
        f" {IMPORT} --template > map.yaml writes a mapping file with a line for each:"
        " put the units in and give it with --map",
    ]


def unused(mapping: Mapping, streams: Sequence[RawStream]) -> list[str]:
    """Columns that the mapping names and no stream has."""
    known = {c.name for s in streams for c in s.columns}
    known |= {f"{s.name}/{c.name}" for s in streams for c in s.columns}
    return [
        f"channels.{name}: there is no column {' or '.join(channel.columns)}; the log has"
        f" {', '.join(sorted({c.name for s in streams for c in s.columns}))[:400]}"
        for name, channel in mapping.channels.items()
        if not known & {*channel.columns}
    ]


def slug(name: str) -> str:
    """A name of small letters, digits and underscores."""
    # letters of units keep their case in a suffix such as _N_m or _V
    suffix = units.suffix_of(name)
    stem = name.removesuffix(suffix) if suffix else name
    plain = unicodedata.normalize("NFKD", stem).encode("ascii", "ignore").decode().lower()
    plain = re.sub(r"[^a-z0-9]+", "_", plain).strip("_") or "column"
    return (plain if plain[0].isalpha() else f"c_{plain}") + suffix
