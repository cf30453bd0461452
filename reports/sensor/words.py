"""The answer to how uncertain a reading is, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from simcompare.hardware.sensors import sheet_units
from simcompare.notation import capital, fixed, sentence
from simcompare.reports.render import numbers
from simcompare.reports.run.listing import joined
from simcompare.results.records.sensor import CheckRow, SensorReading
from simcompare.units import symbol

#: terms that one reading does not show
_SLOW = ("bias_instability", "random_walk")
#: a density and an rms that are apart by less say the same
_SAME = 0.1


def amount(value: float, unit: str, digits: int = 2) -> str:
    """An amount in SI, and as sheets state it: ``0.84 m/s² (86 mg)``."""
    si = f"{numbers.plain(value, digits)} {symbol(unit)}"
    spoken = told(value, unit, digits)
    return si if spoken == si else f"{si} ({spoken})"


def told(value: float, unit: str, digits: int = 2) -> str:
    """An amount as sheets state it: ``86 mg``."""
    name, size = sheet_units.spoken(unit)
    return f"{numbers.plain(value / size, digits)} {name}"


def answer(found: SensorReading) -> str:
    """The answer in one sentence."""
    axis = f" on the {found.axis} axis" if found.axis else ""
    return (
        f"A reading of {found.reading_text}{axis} of any {found.chip}"
        f" ({found.part.replace('_', ' ')}), as it leaves the factory, is uncertain by"
        f" u = {amount(found.u, found.unit)}; {_most(found)}."
    )


def _most(found: SensorReading) -> str:
    """Which term does most of it."""
    rows = found.shares
    first = rows[0]
    if (first.share or 0.0) > 0.5:
        return f"{first.title} does most of it, {numbers.percent(first.share)} of the variance"
    named = joined([row.title for row in rows[:2]])
    part = sum(row.share or 0.0 for row in rows[:2])
    return f"{named} do most of it, {numbers.percent(part)} of the variance"


def further(found: SensorReading) -> Iterator[str]:
    """What must be said besides: how it was found, what was chosen and what is not confirmed."""
    yield settings(found)
    yield _drawn(found)
    if found.u_if_two_sigma < 0.98 * found.u:
        yield (
            "A typical value is taken as one standard deviation. If it were two, it would be"
            f" u = {amount(found.u_if_two_sigma, found.unit)}."
            if found.typ_is_sigma == 1.0
            else f"Of a typical value {found.typ_is_sigma:g} is taken as one standard deviation."
        )
    if found.axis and not found.across:
        yield (
            "The other axes feel nothing here (across = 0), so cross-axis sensitivity adds nothing."
        )
    slow = [row.title for row in found.entries if row.used and row.term in _SLOW]
    if slow:
        yield f"{capital(joined(slow))} grow with time and are left out of one reading."
    yield from map(_checked, found.checks)
    yield _confirmed(found)


def settings(found: SensorReading) -> str:
    """Settings in one sentence."""
    width = (
        f"bandwidth {found.bandwidth_Hz:g} Hz"
        if math.isfinite(found.bandwidth_Hz)
        else "no low-pass"
    )
    return (
        f"Settings: range {found.range}, {found.rate_Hz:g} samples a second, {width} (noise"
        f" bandwidth {numbers.plain(found.noise_bandwidth_Hz, 3)} Hz),"
        f" {found.temperature_C:g} °C."
    )


def _drawn(found: SensorReading) -> str:
    how = f"{numbers.thousands(found.draws)} devices drawn from the sheet"
    ends = _ends(found)
    if found.agrees:
        return (
            f"{how} give u = {amount(found.u_drawn, found.unit)}, which agrees with the first"
            f" order; 95 % of them read between {ends}.{_cut_off(found)}"
        )
    why = (
        f"{numbers.percent(found.saturated)} of them are cut off at the end of the range"
        if found.saturated
        else "the terms are too large for a first order"
    )
    return (
        f"{how} give u = {amount(found.u_drawn, found.unit)}, not the {told(found.u, found.unit)}"
        f" of the first order: {why}. 95 % of them read between {ends}; trust the draws."
    )


def _cut_off(found: SensorReading) -> str:
    if not found.saturated:
        return ""
    return f" {numbers.percent(found.saturated)} of them are cut off at the end of the range."


def _ends(found: SensorReading) -> str:
    """Ends of the middle 95 %, to the second digit of u."""
    name, size = sheet_units.spoken(found.unit)
    place = max(0, 1 - math.floor(math.log10(found.u / size)))
    low, high = (fixed(value / size, place) for value in (found.low, found.high))
    return f"{low} and {high} {name}"


def _checked(check: CheckRow) -> str:
    """Two lines of a sheet that state noise in two ways."""
    ratio = check.expected / check.rms
    both = f"The sheet states noise twice: {check.stated}, and {check.other} ({check.page})."
    if abs(ratio - 1) <= _SAME:
        return f"{both} With the filter that is assumed here both say the same, within 10 %."
    more = f"{numbers.percent(abs(ratio - 1))} {'more' if ratio > 1 else 'less'}"
    expected = f"{both} From the first and one pole one expects {more} than the second"
    if abs(check.sharp / check.rms - 1) <= _SAME:
        return f"{expected}; they agree for a filter that ends sharply at its bandwidth."
    return f"{expected}; the sheet does not say why."


def _confirmed(found: SensorReading) -> str:
    used = [row for row in found.entries if row.used]
    missing = found.unconfirmed
    if not missing:
        return f"All {len(used)} lines in use were read in the maker's own text."
    names = joined(list(dict.fromkeys(row.title for row in missing)))
    were, them = ("was", "it") if len(missing) == 1 else ("were", "them")
    return (
        f"{len(missing)} of {len(used)} lines in use {were} not read in the maker's own text"
        f" ({names}): hold {them} against the sheet before you rely on {them}."
    )


def notes(found: SensorReading) -> list[str]:
    """What the sheet's file says of itself, and what single lines assume."""
    said = [f"Source: {found.maker}, {found.document}; {' '.join(found.read.split())}"]
    said += [" ".join(found.note.split())] if found.note else []
    said += [f"{row.title}: {row.note}" for row in found.entries if row.note]
    return list(dict.fromkeys(sentence(text) for text in said))
