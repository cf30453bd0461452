"""Sentences about the noise of a sensor at rest."""

from __future__ import annotations

import math
from collections.abc import Sequence

from simcompare import units
from simcompare.hardware.sensors import noise_units
from simcompare.reports.render import numbers
from simcompare.reports.run.listing import joined
from simcompare.results.records.allan import AgainstSheet, AxisNoise, Finding, Match, NoiseAnalysis

#: what a sensor with readings in a unit is called
_SENSORS = {"m/s**2": "accelerometer", "rad/s": "gyroscope"}
#: how much larger readings are in another unit that is often meant, and which
_OTHER_UNITS = {"m/s**2": (1 / 9.80665, "g"), "rad/s": (180 / math.pi, "°/s")}
_NEARLY = 0.1
#: a ratio that is as good as 1: data sheets round
_SAME = 0.15
#: part of the noise from which on rounding to counts is told
_SEEN = 0.2
#: of faults that are told in sentences
_TOLD = 6
QUESTION = "How noisy is the sensor at rest, and over which time should it be averaged?"


def answer(found: NoiseAnalysis) -> list[str]:
    """White noise and the best averaging time, a sentence for each kind of sensor."""
    said = []
    for unit, axes in by_unit(found).items():
        said += [_white(unit, axes), _best(unit, axes)]
    return said


def by_unit(found: NoiseAnalysis) -> dict[str, list[AxisNoise]]:
    """Channels by the unit of their readings."""
    groups: dict[str, list[AxisNoise]] = {}
    for axis in found.axes:
        groups.setdefault(axis.unit, []).append(axis)
    return groups


def sensor(unit: str) -> str:
    """What a sensor is called."""
    return _SENSORS.get(unit, "signal")


def _white(unit: str, axes: Sequence[AxisNoise]) -> str:
    name, size = noise_units.of_sheets("N", unit)
    white = [(axis, axis.term("N")) for axis in axes]
    seen = [(axis, term) for axis, term in white if term.value is not None]
    if not seen:
        return f"The {sensor(unit)} shows no white noise."
    told = [
        numbers.with_u(2**0.5 * (term.value or 0.0) / size, 2**0.5 * (term.u or 0.0) / size)
        for _, term in seen
    ]
    whose = f" ({joined([short(axis.channel) for axis, _ in seen])})" if len(axes) > 1 else ""
    return f"White noise of the {sensor(unit)}: {joined(told)} {name}{whose}, one-sided density."


def _best(unit: str, axes: Sequence[AxisNoise]) -> str:
    told = []
    for axis in axes:
        name, size = noise_units.of_sheets("B", unit)
        value = f"{numbers.plain(axis.best / size, 2)} {name} at {seconds(axis.best_tau_s)}"
        told.append(f"{short(axis.channel)} {value}" if len(axes) > 1 else value)
    rest = [axis for axis in axes if axis.still_falls]
    more = "" if not rest else (
        "; a longer record would show how far it falls"
        if len(rest) == len(axes)
        else f"; {joined([short(axis.channel) for axis in rest])} may fall further"
    )  # fmt: skip
    return f"Lowest deviation of its averages: {joined(told)}{more}."


def against(found: NoiseAnalysis) -> list[str]:
    """The noise beside a data sheet."""
    said = []
    for part in dict.fromkeys(row.part for row in found.against):
        rows = [row for row in found.against if row.part == part]
        by_verdict: dict[str, list[str]] = {}
        for row in rows:
            told = f"{short(row.channel)} {numbers.plain(row.ratio, 2)}"
            by_verdict.setdefault(_verdict(row), []).append(told)
        parts = [f"{joined(told)} times ({verdict})" for verdict, told in by_verdict.items()]
        said.append(f"Beside the typical noise of {rows[0].sheet}, {part}: {', '.join(parts)}.")
    return [*said, *_rounded(found)]


def _rounded(found: NoiseAnalysis) -> list[str]:
    """What rounding to counts adds, where it is seen."""
    density = {row.channel: row.found for row in found.against}
    rounded = [
        axis for axis in found.axes if axis.rounding > _SEEN * density.get(axis.channel, math.inf)
    ]
    if not rounded:
        return []
    name, size = noise_units.of_sheets("N", rounded[0].unit)
    told = f"{numbers.plain(max(axis.rounding for axis in rounded) / size, 3)} {name}"
    return [f"Rounding to whole counts adds {told}, by squares; it is taken off beside the sheet."]


def _verdict(row: AgainstSheet) -> str:
    if abs(row.ratio - 1) <= max(_SAME, 2 * row.u_ratio):
        return "as the sheet says"
    return "noisier" if row.ratio > 1 else "quieter"


def audit(found: NoiseAnalysis) -> list[str]:
    """Of which sensor the noise is, and what no sensor does."""
    if not found.audited:
        return []
    return [*_whose(found), *_faults(found)]


def _whose(found: NoiseAnalysis) -> list[str]:
    """One sentence for all kinds of sensor."""
    by_verdict: dict[str, list[str]] = {}
    for unit in by_unit(found):
        of = [one for one in found.matches if _SENSORS.get(unit) == one.part]
        fits = [one.sheet for one in of if one.fits]
        if of:
            verdict = f"that of {joined(fits)}" if fits else _none(unit, of)
            by_verdict.setdefault(verdict, []).append(sensor(unit))
    told = [f"the noise of the {joined(who)} is {what}" for what, who in by_verdict.items()]
    return [f"T{'; '.join(told)[1:]}."] if told else []


def _none(unit: str, of: Sequence[Match]) -> str:
    """The nearest sheet, or one that fits if the unit of the readings is not the one it has."""
    size, readings = _OTHER_UNITS[unit]
    other = [one for one in of if abs(one.ratio / size - 1) < _NEARLY]
    nearest = (other or of)[0]
    why = f", as readings in {readings} have" if other else ", the nearest"
    ratio = numbers.plain(nearest.ratio, 2)
    return f"that of no data sheet here ({ratio} times that of {nearest.sheet}{why})"


def _faults(found: NoiseAnalysis) -> list[str]:
    by_text: dict[str, list[Finding]] = {}
    for one in found.findings:
        if one.fault:
            # what is in brackets is of one channel
            by_text.setdefault(one.text.partition(" (")[0], []).append(one)
    count = f"{len(found.findings)} tests; of 100 faultless streams 2 at most fail any"
    if not by_text:
        return [f"No fault is found ({count})."]
    told = [_fault(text, ones) for text, ones in [*by_text.items()][:_TOLD]]
    more = len(by_text) - _TOLD
    rest = [f"{more} more are in the table."] if more > 0 else []
    name = "Fault" if len(by_text) == 1 else f"{len(by_text)} faults"
    return [f"{name}: {'; '.join(told)}.", *rest, f"Made: {count}."]


def _fault(text: str, ones: Sequence[Finding]) -> str:
    worst = max(ones, key=lambda one: one.p)
    told = worst.text.partition(" (")[2].rstrip(")")
    first = f"{_channels(worst)}: " if len(ones) > 1 else ""
    seen = f"{first}{told}; " if told else ""
    names = sorted(_channels(one) for one in ones if one.channel)
    where = f"{joined(names)}: " if names else ""
    return f"{where}{text} ({seen}test “{worst.test}”, {chance_of(worst.p)})"


def _channels(one: Finding) -> str:
    names = map(short, one.channel.split(", "))
    return (" with " if one.test == "independent axes" else ", ").join(names)


def chance_of(p: float) -> str:
    """A p-value."""
    return "p < 10⁻⁹" if p < 1e-9 else f"p = {numbers.plain(p, 2)}"


def notes(found: NoiseAnalysis) -> list[str]:
    """Which stretch, what drifts, and where the fit is poor."""
    return [
        stretch(found),
        *_moving(found),
        *_silent(found),
        *_ramps(found),
        *_filtered(found),
        *_poor(found),
    ]


def stretch(found: NoiseAnalysis) -> str:
    """Which part of the record was taken."""
    part = f"{numbers.plain(found.start_s, 4)} s to {numbers.plain(found.end_s, 4)} s"
    length = found.end_s - found.start_s
    size = f"{numbers.plain(length, 3)} s at {numbers.plain(found.rate_Hz, 4)} Hz"
    whole = f"of {numbers.plain(found.length_s, 4)} s"
    match found.chosen:
        case "all":
            return f"Taken: the whole record, {size}; nothing moves in it."
        case "whole":
            return f"Taken: the whole record, {size}."
        case "still":
            return f"Taken: {part} {whole}, the longest stretch in which nothing moves; {size}."
        case "gap":
            return f"Taken: {part} {whole}, the longest stretch without a gap there; {size}."
    return f"Taken: {part} {whole}, as asked for; {size}."


def _moving(found: NoiseAnalysis) -> list[str]:
    if found.still_s is None:
        return []
    start, end = (numbers.plain(one, 4) for one in found.still_s)
    return [
        "Something may move in this stretch, or its mean wanders; both count as noise. The longest"
        f" still part of it is --from {start}s --until {end}s."
    ]


def _silent(found: NoiseAnalysis) -> list[str]:
    if not found.silent:
        return []
    told = joined([short(name) for name in found.silent])
    return [f"No noise at all in {told}: every reading is the same."]


def _ramps(found: NoiseAnalysis) -> list[str]:
    said = []
    for axis in found.axes:
        term = axis.term("R")
        if term.value is not None:
            told = numbers.with_u(term.value / term.sheet_size, (term.u or 0.0) / term.sheet_size)
            said.append(
                f"{short(axis.channel)} drifts by ({told}) {term.sheet_unit}; a sensor that warms"
                " up does that. The other noises were fitted to Hadamard deviations, which a"
                " steady drift leaves alone."
            )
    return said


def _filtered(found: NoiseAnalysis) -> list[str]:
    cut = {short(a.channel): a.from_s for a in found.axes if a.from_s > 1.5 / found.rate_Hz}
    if not cut:
        return []
    told = joined([f"{name} below {seconds(one)}" for name, one in cut.items()])
    return [
        f"Averages left out of the fit: {told}. Readings are not independent there; the filter of"
        " the sensor does that, or a vibration."
    ]


def _poor(found: NoiseAnalysis) -> list[str]:
    poor = [axis for axis in found.axes if axis.widened > 1]
    if not poor:
        return []
    told = joined([
        f"{short(a.channel)} (χ² = {numbers.plain(a.chi_squared, 3)} for {a.degrees_of_freedom}"
        " degrees of freedom)" for a in poor
    ])  # fmt: skip
    return [
        f"These noises do not describe {told} well; the standard uncertainties are widened by"
        " √(χ²/degrees of freedom)."
    ]


def seconds(value: float) -> str:
    """A time as it is read."""
    if value < 1:
        return f"{numbers.plain(1e3 * value, 3)} ms"
    return f"{numbers.plain(value, 3)} s"


def short(channel: str) -> str:
    """Name of a channel without its unit."""
    return channel.removesuffix(units.suffix_of(channel))


def limited(value: float) -> str:
    """An upper limit, rounded up to two digits."""
    if not math.isfinite(value) or value <= 0:
        return "–"
    place = 1 - math.floor(math.log10(value))
    return f"< {numbers.plain(math.ceil(round(value * 10**place, 9)) / 10**place, 2)}"
