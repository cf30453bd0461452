"""Units that contradict physics: gravity at rest, a position and its rate, a wheel, the air.

A unit that does not fit is a fault with the unit that would; ``--assume-units`` takes that one
where only one fits, and records it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simcompare import units
from simcompare.hardware.conditioning.units import derivative, wheels
from simcompare.hardware.conditioning.units.meaning import (
    Claim,
    claims,
    mapping_line,
    near,
    take,
    title,
    triads,
)
from simcompare.hardware.conditioning.units.quantity import measures_acceleration
from simcompare.hardware.conditioning.units.rest import rest
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping_lines import channels_line, time_line
from simcompare.hardware.raw import IMPORT

G = 9.80665
#: how far |f| at rest may be from gravity, in parts of it. Sheets of cheap sensors allow offsets
#: of 0.08 g on an axis and 3 % of scale, together 0.11 to 0.17 g; gravity itself differs by 0.3 %
#: between equator and pole. The next unit is a factor of two away.
REST_TOLERANCE = 0.15
#: what a number may count, by its size at rest: unit, what it is divided by first
GRAVITY_IN = (
    (1.0, "g_0", 1.0),
    (G, "m/s^2", 1.0),
    (1000.0, "mg_0", 1.0),
    (16384.0, "g_0", 16384.0),
    (8192.0, "g_0", 8192.0),
    (4096.0, "g_0", 4096.0),
    (2048.0, "g_0", 2048.0),
    (256.0, "g_0", 256.0),
)
#: least correlation with which a position and its rate tell anything
ALIKE, VERY_ALIKE = 0.9, 0.95
#: a slope is 1, or a known factor, within so much
NEAR_ONE, NEAR_FACTOR = 1.25, 1.1
#: units that are mistaken for each other
_MISTAKEN = {
    "rad": ("rad", "deg", "turn"),
    "rad/s": ("rad/s", "deg/s", "turn/s", "turn/min"),
    "m": ("m", "mm", "cm"),
    "m/s": ("m/s", "mm/s", "cm/s", "km/h"),
}
#: pressure of the air: from the top of Mont Blanc to the highest ever measured [Pa]
_AIR_PA = (5.0e4, 1.09e5)
_AIR_WORDS = ("baro", "atmos", "ambient", "air", "qnh", "press")
_NO_AIR_WORDS = ("diff", "gauge", "tyre", "tire", "pitot", "oil", "fuel", "vacuum", "cylinder")

#: units of clocks, in seconds
_CLOCKS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0}


def check(work: Work) -> None:
    """Holds every unit against physics."""
    if len(work.time_s) < 2:
        return
    for triad in triads(claims(work)):
        if _is_acceleration(triad):
            _acceleration(work, triad)
    for position, rate in derivative.pairs(claims(work)):
        _derivative(work, position, rate)
    wheels.check(work, claims(work))
    for claim in claims(work):
        _pressure(work, claim)


def _is_acceleration(triad: Sequence[Claim]) -> bool:
    if triad[0].si:
        return triad[0].si == "m/s**2"
    return all(measures_acceleration(f"{c.column.name} {c.name}") for c in triad)


def _acceleration(work: Work, triad: Sequence[Claim]) -> None:
    """Gravity at rest is 9.8 m/s²: a sensor that shows 1, 1000 or 16384 has another unit."""
    if any(claim.kind == "gravity_removed" for claim in triad):
        return
    at_rest = rest(work, triad)
    if at_rest is None or not at_rest.steady:
        return
    first = triad[0]
    if first.si and abs(at_rest.size / G - 1) <= REST_TOLERANCE:
        return
    # in the declared unit, the mapping's scale included
    size = at_rest.size / first.unit_si
    fitting = [
        (unit, divisor)
        for expected, unit, divisor in GRAVITY_IN
        if abs(size / expected - 1) <= REST_TOLERANCE and (unit, divisor) != (first.unit, 1.0)
    ]
    if not fitting:
        _odd_gravity(work, triad, at_rest.size, at_rest.scatter)
        return
    unit, divisor = fitting[0]
    meant = unit if divisor == 1.0 else f"{unit} after division by {divisor:g}"
    declared = f"declared {first.unit}" if first.unit else "without a unit"
    text = f"at rest the columns {title(triad)} ({declared}) show {size:.4g}"
    if work.assume_units:
        for claim in triad:
            full = f"{text}, as gravity does in {meant}; that unit was taken"
            before = {"rest": size, "unit_si": claim.unit_si}
            after = {"rest_m_s2": size / divisor * units.si_of(unit, "")[0]}
            take(work, claim, unit, full, before, after, divisor)
    elif first.unit:
        lines = channels_line(*(mapping_line(claim, unit, divisor) for claim in triad))
        work.fault(
            f"{text} {units.symbol(first.unit)}; gravity is 9.8 m/s². That number fits {meant}:"
            f" write in the mapping file {lines}; or {IMPORT} --assume-units"
        )


def _odd_gravity(work: Work, triad: Sequence[Claim], size: float, scatter: float) -> None:
    """Something steady that is neither gravity nor nothing."""
    if not triad[0].si or size < 0.5 or scatter > 0.05 * size:
        return
    work.warn(
        "rest_magnitude",
        f"at rest the columns {title(triad)} show {size:.4g} m/s², expected {G:.2f} or, without"
        " gravity, 0; check unit and scale, or whether the device was at rest at all",
        before={"rest_m_s2": size},
    )


def _derivative(work: Work, position: Claim, rate: Claim) -> None:
    """The change of a position is the integral of its rate."""
    slope = derivative.slope(work, position, rate)
    if slope is None or abs(slope.alike) < ALIKE:
        return
    size = abs(slope.value)
    pair = f"{position.column.name!r} ({position.unit}) and {rate.column.name!r} ({rate.unit})"
    text = (
        f"columns {pair}: the position changes {slope.value:.4g} times as fast as the rate says"
        f" (correlation {slope.alike:.3f})"
    )
    way_out = "if they do not belong together, give them different names in the mapping file"
    if slope.value < 0:
        work.fault(
            f"{text}; one of the two counts the other way: turn it in the mapping file, such as"
            f" {channels_line(mapping_line(rate, rate.unit, sign=-1))}; {way_out}"
        )
    if 1 / NEAR_ONE <= size <= NEAR_ONE:
        return
    cures = _cures(position, rate, size)
    if len(cures) == 1 and work.assume_units and slope.value > 0:
        claim, unit = cures[0]
        fitted = slope.value * _after(claim is position, claim, unit)
        text += f"; {claim.column.name!r} was taken as {unit}, which fits"
        take(work, claim, unit, text, {"slope": slope.value}, {"slope": fitted})
    elif cures:
        lines = " or ".join(channels_line(mapping_line(*cure)) for cure in cures)
        more = f"; or {IMPORT} --assume-units" if len(cures) == 1 and slope.value > 0 else ""
        work.fault(f"{text}; expected 1. Write in the mapping file {lines}{more}; {way_out}")
    elif clock := _clock_factor(size):
        work.fault(
            f"{text}; expected 1. A factor of {clock} on all rates means a wrong unit of the time:"
            f" write into the mapping file {_clock_line(work, size)}; {way_out}"
        )
    elif abs(slope.alike) >= VERY_ALIKE:
        work.warn(
            "rate_scale",
            f"{text}; expected 1: one of them has another scale; {way_out}",
            channel=rate.column.name,
            before={"slope": slope.value},
        )


def _cures(position: Claim, rate: Claim, size: float) -> list[tuple[Claim, str]]:
    """Each single other unit, of the one column or the other, with which both agree."""
    return [
        (claim, unit)
        for claim in (position, rate)
        for unit in _MISTAKEN[claim.si]
        if not NEAR_ONE > units.si_of(unit, "")[0] / claim.unit_si > 1 / NEAR_ONE
        if near(size * _after(claim is position, claim, unit), 1.0, NEAR_FACTOR)
    ]


def _after(is_position: bool, claim: Claim, unit: str) -> float:
    """Factor on the slope when a column is taken in another unit."""
    change = units.si_of(unit, "")[0] / claim.unit_si
    return change if is_position else 1 / change


def _clock_factor(size: float) -> str:
    known = {"1000": 1e3, "1/1000": 1e-3, "60": 60.0, "1/60": 1 / 60, "10⁶": 1e6, "10⁻⁶": 1e-6}
    return next((text for text, factor in known.items() if near(size, factor, NEAR_FACTOR)), "")


def _clock_line(work: Work, size: float) -> str:
    """The line that makes steps of the time so many times as long."""
    stream = work.stream
    if stream.time is None:
        return f"time: {{rate_Hz: {1 / ((stream.increment_s or 1.0) * size):.6g}}}"
    wanted = units.si_of(stream.column(stream.time).unit or "s", "")[0] * size
    unit = min(_CLOCKS, key=lambda name: abs(np.log(_CLOCKS[name] / wanted)))
    return time_line(stream.time, unit)


def _pressure(work: Work, claim: Claim) -> None:
    """The pressure of the air is near 10⁵ Pa; 1013 Pa are 1013 hPa."""
    name = f"{claim.column.name} {claim.name}".lower()
    if claim.si != "Pa" or any(word in name for word in _NO_AIR_WORDS):
        return
    if not any(word in name for word in _AIR_WORDS):
        return
    middle, spread = _middle(claim)
    # the air does not change by a tenth within a log; what does is another pressure
    if not middle > 0 or spread > 0.1 * middle or _AIR_PA[0] <= middle <= _AIR_PA[1]:
        return
    number = middle / claim.unit_si
    fitting = [
        unit
        for unit in ("Pa", "hPa", "kPa", "bar")
        if _AIR_PA[0] <= number * units.si_of(unit, "")[0] <= _AIR_PA[1]
    ]
    if len(fitting) != 1:
        return
    unit = fitting[0]
    text = f"shows {number:.4g} {claim.unit}; as pressure of the air that is {unit}"
    if work.assume_units:
        full = f"{claim.column.name!r} {text}, and was taken as such"
        fitted = number * units.si_of(unit, "")[0]
        take(work, claim, unit, full, {"median_Pa": middle}, {"median_Pa": fitted})
    else:
        work.fault(
            f"{text}: write in the mapping file {channels_line(mapping_line(claim, unit))},"
            f" or {IMPORT} --assume-units;"
            " if it is a difference of pressures, call it so (gauge_pressure)",
            channel=claim.column.name,
        )


def _middle(claim: Claim) -> tuple[float, float]:
    """Median, and how far nearly all values are apart [SI]."""
    values = claim.values(slice(None))
    values = values[np.isfinite(values)]
    if not len(values):
        return 0.0, 0.0
    low, middle, high = np.quantile(values, (0.02, 0.5, 0.98))
    return float(middle), float(high - low)
