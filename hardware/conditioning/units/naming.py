"""What the columns of a log are called and in which unit they are."""

from __future__ import annotations

import re
from collections.abc import Container, Sequence

import numpy as np

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware import proposed_time
from simcompare.hardware.conditioning.units import endings, quantity
from simcompare.hardware.conditioning.units.left_out import UNKNOWN, left_out, with_channels
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping import ChannelMap, Mapping
from simcompare.hardware.raw import RawColumn, RawStream
from simcompare.model.recording import Conversion

#: what the times of a stream are called
CLOCK = "time_s"


def prepare(work: Work) -> None:
    """Settles which column is the time, and the units that the mapping or the name give."""
    stream = work.stream
    names = [column.name for column in stream.columns]
    _settle_time(work, names)
    if not len(stream):
        work.fault("holds no samples; expected at least two")
    for column in stream.columns:
        _settle_unit(work, column, names)


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
        work.fault(proposed_time.no_time(stream))


def _settle_unit(work: Work, column: RawColumn, names: Sequence[str]) -> None:
    wish, time = work.wishes(column), work.mapping.time
    if wish is not None:
        column.unit = wish.unit if wish.scale == 1.0 else column.unit
        column.limits = wish.limits or column.limits
        column.kind = wish.kind or column.kind
    elif column.name == work.stream.time and time is not None and time.unit is not None:
        column.unit = time.unit
    elif not column.unit:
        column.unit = endings.of(column.name, names).unit
        if not column.unit and quantity.counts(column.name):
            column.unit = "1"
            work.info("counts", "holds counts, by its name: plain numbers", channel=column.name)


def channels_of(work: Work, column: RawColumn) -> Sequence[tuple[ChannelMap | None, str]]:
    """Channels that a column becomes, as (wish, name without unit)."""
    wishes = work.mapping.of_column(work.stream.name, column.name)
    if wishes:
        return [(wish, name) for name, wish in wishes]
    end = endings.of(column.name)
    told = column.unit and end.unit == column.unit
    return [(None, slug(end.stem if told else column.name))]


def conversion(
    work: Work, column: RawColumn, wish: ChannelMap | None, name: str, taken: Container[str] = ()
) -> Conversion:
    """How a column becomes SI, or why it is left out.

    Args:
        work: the stream; a unit of its mapping that is none is a fault.
        column: one of its columns.
        wish: what the mapping says of it.
        name: of the channel, without unit.
        taken: channels that are there already.
    """
    unit = quantity.meant(f"{column.name} {name}", wish.unit if wish else column.unit)
    if not unit:
        unit = _odd_unit(column.name)
    if not unit and not np.isfinite(column.values).any():
        return Conversion(column.name, "", "", "", reason="is empty")
    if not unit:
        return left_out(column, name, UNKNOWN, endings.of(column.name).proposed or "1")
    try:
        factor, offset, si_unit = quantity.to_si(column.name, unit)
    except InputError as error:
        wrong = "; ".join(error.faults)
        if wish:
            work.fault(wrong, channel=column.name)
        several = units.ways(unit)
        likely = several[-1] if len(several) > 1 else units.nearest(unit) or "1"
        return left_out(column, name, wrong, likely)
    wrong = "" if wish or column.defined else quantity.contradiction(column.name, si_unit)
    if wrong:
        celsius = unit.strip() in ("°", "º") and "K" in quantity.possible(column.name)
        return left_out(column, name, wrong, "degC" if celsius else unit)
    wrong = "" if wish or column.defined else quantity.may_differ(column.name, unit)
    if wrong:
        return left_out(column, name, wrong, unit)
    scale, sign = (wish.scale, wish.sign) if wish else (1.0, 1)
    added = wish.offset if wish else 0.0
    full, reason = _called(name, units.suffix_for(si_unit), taken)
    return Conversion(
        column.name, unit, full, si_unit, sign * scale * factor, added * factor + offset,
        reason or ("mapping" if wish else ""),
    )  # fmt: skip


def _called(name: str, suffix: str, taken: Container[str]) -> tuple[str, str]:
    """Name of a channel with its unit, and why it is not as in the log."""
    stem = name.removesuffix(suffix) if suffix else name
    wanted = f"{stem}{suffix}"
    if wanted == CLOCK:  # the times of the stream are called so
        return f"recorded_{CLOCK}", f"{CLOCK} is the name of the clock"
    full, number = wanted, 2
    while full in taken:
        full, number = f"{stem}_{number}{suffix}", number + 1
    return full, "" if full == wanted else f"another column is {wanted}"


def _odd_unit(name: str) -> str:
    """What stands in brackets at the end of a name, where a unit should."""
    match = re.search(r"[\[(]\s*([A-Za-zµμΩ°%][^()\[\]]{0,11}?)\s*[\])]\s*$", name)
    odd = match[1] if match and " " not in match[1] else ""
    return "" if units.is_written(odd) else odd  # a letter that counts, as in (A) beside (B)


def all_faults(work: Work) -> list[str]:
    """Those of a stream that is refused, with the faults of its names and units."""
    made = [
        conversion(work, column, wish, name)
        for column in work.data
        for wish, name in channels_of(work, column)
    ]
    return list(dict.fromkeys(with_channels(fault, made) for fault in work.faults))


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
    plain = re.sub(r"[^a-z0-9]+", "_", quantity.latin(stem).lower()).strip("_") or "column"
    return (plain if plain[0].isalpha() else f"c_{plain}") + suffix
