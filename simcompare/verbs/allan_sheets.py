"""The noise of a stream beside what data sheets say."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors import data_sheet
from simcompare.hardware.sensors.data_sheet import DataSheet, Part
from simcompare.results.records.allan import AgainstSheet, AxisNoise, Match

#: data sheets round by so much
_ROUNDED = 0.03


def against(axes: Sequence[AxisNoise], sheet: DataSheet) -> list[AgainstSheet]:
    """White noise of each channel beside the typical one of its axis.

    Raises:
        InputError: the sheet measures nothing that a channel does.
    """
    parts = [part for part in sheet.parts.values() if _measuring(axes, part)]
    if not parts:
        known = ", ".join(part.unit for part in sheet.parts.values())
        raise InputError("--sheet", [f"{sheet.name} measures in {known}; no channel does"])
    return [row for part in parts for row in _beside(axes, part)]


def matches(axes: Sequence[AxisNoise]) -> tuple[Match, ...]:
    """Every sensor of every sheet that measures the same, the nearest first."""
    found = []
    for part in _shipped():
        rows = _beside(axes, part)
        if rows and len(rows) == len(_measuring(axes, part)):
            fits = all(abs(row.ratio - 1) <= 3 * row.u_ratio + _ROUNDED for row in rows)
            mean = math.exp(float(np.mean([math.log(row.ratio) for row in rows])))
            found.append(Match(part.sheet, part.name, mean, fits))
    return tuple(sorted(found, key=lambda one: (not one.fits, abs(math.log(one.ratio)))))


@functools.cache
def _shipped() -> tuple[Part, ...]:
    return tuple(
        part for name in data_sheet.names() for part in data_sheet.load(name).parts.values()
    )


def _measuring(axes: Sequence[AxisNoise], part: Part) -> list[AxisNoise]:
    return [axis for axis in axes if axis.unit == part.unit]


def _beside(axes: Sequence[AxisNoise], part: Part) -> list[AgainstSheet]:
    """The channels that show white noise and measure what the part does."""
    densities, rows = part.typical().noise_density, []
    for i, axis in enumerate(_measuring(axes, part)):
        stated, white = float(densities[min(i, len(densities) - 1)]), axis.term("N")
        if white.value is not None and white.u is not None and stated > 0:
            found, u = _without_rounding(2**0.5 * white.value, 2**0.5 * white.u, axis.rounding)
            rows.append(AgainstSheet(
                axis.channel, part.sheet, part.name, stated, found, u, found / stated, u / stated
            ))  # fmt: skip
    return rows


def _without_rounding(found: float, u: float, rounding: float) -> tuple[float, float]:
    """A noise density, and its u, as it was before readings were rounded to counts."""
    if rounding**2 > found**2 / 2:  # noise of a third of a count: rounding is no noise then
        return found, u
    own = math.sqrt(found**2 - rounding**2)
    return own, u * found / own
