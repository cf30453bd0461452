"""How uncertain one reading of a sensor is as it leaves the factory, from its data sheet alone.

Two ways that must agree. First order (JCGM 100:2008, 5.1.2): the standard uncertainties of all
terms, each times what it does to the reading, added in quadrature. And drawn (JCGM 101:2008): many
devices read the same value, and their readings are counted.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from simcompare.hardware.sensors import drawing
from simcompare.hardware.sensors.device import REFERENCE_C
from simcompare.hardware.sensors.error_model import measured_by
from simcompare.hardware.sensors.sheet_entries import Entry
from simcompare.hardware.sensors.sheet_parts import PartData, Settings
from simcompare.hardware.sensors.sheet_rules import RULES, Rule, Stated
from simcompare.model.trajectory import Array
from simcompare.statistics.streams import stream

#: the part of the standard uncertainty of a standard deviation that two ways may differ by
_AGREE = 3.0


@dataclass(frozen=True)
class Share:
    """What one term adds to the uncertainty of a reading.

    Attributes:
        term: name of the term.
        title: the term in words.
        entry: line of the sheet; ``None`` for the resolution, which stands with the range.
        rule: by which it becomes a distribution.
        u: contribution in the unit of the reading.
    """

    term: str
    title: str
    entry: Entry | None
    rule: Rule
    u: float


@dataclass(frozen=True)
class Situation:
    """What is read, and how.

    Attributes:
        axis: that is read.
        reading: true value along it, SI.
        across: true value along one of the other axes, SI.
        settings: of the sensor.
    """

    axis: str
    reading: float
    across: float
    settings: Settings


@dataclass(frozen=True)
class Drawn:
    """Readings of many devices.

    Attributes:
        values: a reading of each (n,), SI.
        u: their standard deviation.
        mean_error: their mean minus the true value.
        low, high: ends of the middle 95 %.
        saturated: part of them that is cut off at the end of the range.
    """

    values: Array
    u: float
    mean_error: float
    low: float
    high: float
    saturated: float


def shares(part: PartData, now: Situation) -> list[Share]:
    """What each term adds, the largest first."""
    return sorted(_each(part, now), key=lambda share: -share.u)


def combined(rows: list[Share]) -> float:
    """Combined standard uncertainty of independent terms."""
    return math.sqrt(math.fsum(row.u**2 for row in rows))


def _each(part: PartData, now: Situation) -> Iterator[Share]:
    x, settings = now.reading, now.settings
    heat = abs(settings.temperature_C - REFERENCE_C)
    full = settings.range.full_scale
    bent = full * abs(4 * (x / full) ** 3 - 3 * x / full)
    factors = {
        "sensitivity": abs(x),
        "cross_axis": abs(now.across),
        "offset": 1.0,
        "nonlinearity": bent,
        "sensitivity_per_K": heat * abs(x),
        "offset_per_K": heat,
    }
    for term, factor in factors.items():
        entry = part.entry(term, settings.range.name, now.axis)
        if entry is not None:
            factor = abs(x - entry.about) if term == "sensitivity" else factor
            yield Share(term, entry.title, entry, entry.rule, factor * entry.distribution.u)
    yield from _noise(part, now)


def _noise(part: PartData, now: Situation) -> Iterator[Share]:
    settings = now.settings
    entry = part.entry("noise", settings.range.name, now.axis)
    if entry is not None:
        density = drawing.density(part, settings, now.axis)
        u = density * math.sqrt(settings.noise_bandwidth)
        yield Share("noise", entry.title, entry, entry.rule, u)
    entry = part.entry("noise_per_reading", settings.range.name, now.axis)
    if entry is not None:
        u = entry.stated.typ * abs(now.reading)
        yield Share("noise_per_reading", entry.title, entry, entry.rule, u)
    count = settings.range.count
    if count:
        rule = RULES["resolution"]
        u = rule.known(Stated("resolution", typ=count)).u
        yield Share("resolution", "resolution", None, rule, u)


def drawn(part: PartData, now: Situation, count: int, seed: int) -> Drawn:
    """Readings of that many devices of the same value, each with its own noise."""
    devices = drawing.many(part, now.settings, seed, count, "reading")
    devices = replace(devices, rate_error=np.zeros(count))
    place = part.axes.index(now.axis)
    true = np.zeros(len(part.axes))
    if len(true) > 1:
        true[(place + 1) % len(true)] = now.across
    true[place] = now.reading
    time_s = np.array([0.0, 1.0]) / now.settings.rate_Hz
    noise = stream(seed, "reading", "noise")
    read = measured_by(list(devices), time_s, np.stack([true, true]), noise)
    values = read.measured[:, 0, place]
    low, high = np.quantile(values, [0.025, 0.975])
    return Drawn(
        values=values,
        u=float(values.std(ddof=1)),
        mean_error=float(values.mean() - now.reading),
        low=float(low),
        high=float(high),
        saturated=float(read.saturated[:, 0, place].mean()),
    )


def agree(first_order: float, found: Drawn) -> bool:
    """Whether both ways give the same within what that many draws can tell."""
    return abs(found.u / first_order - 1) <= _AGREE / math.sqrt(2 * len(found.values))


@dataclass(frozen=True)
class CrossCheck:
    """Two lines of a sheet that say the same thing in two ways.

    Attributes:
        entry: the line that is not used, an rms at a bandwidth.
        density: the line that is used.
        rms: as it is stated, SI.
        expected: from the density, the poles of the part and the rounding to counts.
        sharp: from the density and a filter that ends at the bandwidth.
    """

    entry: Entry
    density: Entry
    rms: float
    expected: float
    sharp: float


def cross_checks(part: PartData) -> list[CrossCheck]:
    """Lines of a sheet that state noise twice, as a density and as an rms at a bandwidth."""
    found = []
    for entry in part.terms.values():
        if entry.used or entry.term != "noise" or math.isnan(entry.bandwidth_Hz):
            continue
        range_name = entry.ranges[0] if entry.ranges else part.usual[0]
        density = part.entry("noise", range_name, entry.axes[0])
        if density is None or density.kind != "density":
            continue
        n, width = density.stated.typ, entry.bandwidth_Hz
        rounding = part.ranges[range_name].count / math.sqrt(12)
        smooth = n * math.sqrt(part.noise_bandwidth(width))
        found.append(
            CrossCheck(
                entry, density, entry.stated.typ, math.hypot(smooth, rounding),
                math.hypot(n * math.sqrt(width), rounding),
            )
        )  # fmt: skip
    return found
