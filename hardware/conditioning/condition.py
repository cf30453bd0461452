"""From a raw log to a recording: every check in order, every fault at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from collections.abc import Mapping as MappingOf
from dataclasses import replace

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning.clock import (
    time_gaps,
    time_order,
    time_quantised,
    time_unit,
)
from simcompare.hardware.conditioning.strict import refused
from simcompare.hardware.conditioning.units import (
    attitude,
    gravity,
    inertial,
    left_out,
    naming,
    plausible_units,
)
from simcompare.hardware.conditioning.values import (
    angle_wrap,
    counter_wrap,
    fill_gaps,
    missing_values,
    saturation,
    truncated,
)
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping import ChannelMap, Mapping
from simcompare.hardware.raw import RawColumn, RawLog, RawStream, room
from simcompare.model.recording import (
    INFO,
    Channel,
    Conversion,
    Event,
    Provenance,
    Recording,
    Stream,
)
from simcompare.model.trajectory import Array

#: in the order in which they run: first what is missing, then the clock, then what the values
#: mean, then what can be filled
CHECKS: tuple[Callable[[Work], None], ...] = (
    missing_values.check,
    time_unit.check,
    time_order.check,
    time_quantised.check,
    time_gaps.check,
    counter_wrap.check,
    angle_wrap.check,
    saturation.check,
    gravity.check,
    attitude.check,
    plausible_units.check,
    inertial.check,
    truncated.check,
    fill_gaps.check,
)
#: what comes later needs a clock that is in order
_ALWAYS = (missing_values.check, time_unit.check)
_NOTHING = "holds no column of numbers beside its time; there is nothing to import"


def condition(
    raw: RawLog, mapping: Mapping, about: Provenance, *, assume_units: bool = False
) -> Recording:
    """Conditions every stream of a log.

    Args:
        raw: as it was read.
        mapping: what the user says of it.
        about: provenance with file, importer and mode; what is found out is added.
        assume_units: whether units that contradict physics are replaced by those that fit.

    Raises:
        InputError: what cannot be repaired, or with the mode "strict" whatever is not whole.
    """
    wanted = _wanted(raw, mapping, about.file)
    works = [_checked(stream, mapping, assume_units) for stream in wanted]
    repairs = [*raw.repairs, *(repair for work in works for repair in work.repairs)]
    faults = [fault for work in works if work.faults for fault in naming.all_faults(work)]
    faults += naming.unused(mapping, wanted)
    if about.mode == "strict":
        faults += [refused(repair) for repair in repairs if repair.severity != INFO]
    conversions: list[Conversion] = [
        Conversion(name, "", "", "", reason=why) for name, why in raw.ignored.items()
    ]
    streams = {}
    for work in works:
        if not work.faults:
            made = _stream(work, conversions)
            faults += work.faults  # such as a unit of the mapping that is none
            if made.channels or not work.data:
                streams[work.stream.name] = made
    told = {one.unit for made in streams.values() for one in made.channels.values()}
    if (about.mode == "strict" and not mapping.channels) or not (told - {"s"} or faults):
        faults += left_out.refused(conversions)
    if not (told or faults or raw.events):
        unsound = [
            f"column {n!r}: {why}; record again"
            for work in works
            for n, why in work.unsound.items()
        ]
        faults += unsound or [_NOTHING]
    if faults:
        raise InputError(about.file, faults)
    full = replace(
        about,
        conversions=tuple(conversions),
        repairs=tuple(repairs),
        about={**raw.about, **mapping.about, **about.about},
    )
    return Recording(streams, full, tuple(_on_clock(raw.events, streams)))


def _on_clock(events: Sequence[Event], streams: MappingOf[str, Stream]) -> Iterator[Event]:
    """Events on the clocks of their streams, which begin with 0 at the first sample."""
    for event in events:
        if event.stream in streams:
            yield replace(event, time_s=event.time_s - streams[event.stream].clock.first_s)
        elif not event.stream:
            yield event


def _wanted(raw: RawLog, mapping: Mapping, file: str) -> list[RawStream]:
    if not raw.streams:
        raise InputError(file, ["holds no samples"])
    names = [stream.name for stream in raw.streams]
    unknown = [name for name in mapping.streams if name not in names]
    if unknown:
        raise InputError(
            file, [f"has no stream {name!r}; it has {', '.join(names)}" for name in unknown]
        )
    return [s for s in raw.streams if not mapping.streams or s.name in mapping.streams]


def _checked(stream: RawStream, mapping: Mapping, assume_units: bool) -> Work:
    work = Work(stream, mapping, assume_units)
    naming.prepare(work)
    # numbers near the largest there are may overflow while they are looked at; that is no fault
    with np.errstate(all="ignore"):
        for check in CHECKS:
            if work.faults and check not in _ALWAYS:
                break
            check(work)
    return work


def _stream(work: Work, conversions: list[Conversion]) -> Stream:
    """Channels in SI; a column without a unit, or with too many holes, is left out."""
    channels: dict[str, Channel] = {}
    conversions += [Conversion(name, "", "", "", reason=why) for name, why in work.unsound.items()]
    for column in [one for one in work.data if one.name not in work.unsound]:
        wishes = naming.channels_of(work, column)
        for wish, name in wishes:
            made = naming.conversion(work, column, wish, name, channels)
            conversions.append(made)
            if made.channel:
                values = column.values if len(wishes) == 1 else _copy(column.values)
                channels[made.channel] = _channel(work, column, wish, made, values)
    clock = replace(work.stream.clock, u_s=work.u_time_s, resolution_s=work.resolution_s)
    clock = replace(clock, first_s=work.start_s + float(work.time_s[0]))
    first = float(work.time_s[0])
    work.time_s -= first
    return Stream(work.time_s, channels, clock, tuple(work.gaps))


def _channel(
    work: Work, column: RawColumn, wish: ChannelMap | None, made: Conversion, values: Array
) -> Channel:
    """The values in SI, in their own memory, with their uncertainty."""
    if (made.factor, made.offset) != (1.0, 0.0):
        values *= made.factor
        values += made.offset
    return Channel(
        values, made.unit, (wish.frame if wish else "") or column.frame,
        _uncertainty(column, wish, made), (wish.sensor if wish else "") or column.sensor,
        (wish.kind if wish else "") or column.kind, column.name, work.saturated.get(column.name),
    )  # fmt: skip


def _uncertainty(
    column: RawColumn, wish: ChannelMap | None, made: Conversion
) -> float | Array | None:
    """In SI: the mapping gives it in the mapping's unit, the log in the unit of the raw values."""
    if wish is not None and wish.u is not None:
        stated: float | Array | None = wish.u * units.si_of(made.raw_unit, "")[0]
    else:
        stated = None if column.u is None else column.u * abs(made.factor)
    if stated is None or column.added_u is None:
        return stated  # what is unknown does not become known by being interpolated
    return np.hypot(column.added_u * made.factor, stated)


def _copy(values: Array) -> Array:
    copied = room(len(values))
    copied[:] = values
    return copied
