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


def matches(axes: Sequence[AxisNoise], rate_Hz: float) -> tuple[Match, ...]:
    """Every sensor of every sheet that measures the same, the nearest first.

    A sampled sensor has more noise than its sheet states: what is faster than half the rate and
    passes its filter is folded down, and rounding to counts adds some.
    """
    found = []
    for part in _shipped():
        rows = _beside(axes, part)
        if rows and len(rows) == len(_measuring(axes, part)):
            most = _sampled(part, rate_Hz)
            fits = all(
                1 - 3 * row.u_ratio - _ROUNDED <= row.ratio <= most + 3 * row.u_ratio + _ROUNDED
                for row in rows
            )
            mean = math.exp(float(np.mean([math.log(row.ratio) for row in rows])))
            found.append(Match(part.sheet, part.name, mean, fits))
    return tuple(sorted(found, key=lambda one: (not one.fits, abs(math.log(one.ratio)))))


@functools.cache
def _shipped() -> tuple[Part, ...]:
    return tuple(
        part for name in data_sheet.names() for part in data_sheet.load(name).parts.values()
    )


def _sampled(part: Part, rate_Hz: float) -> float:
    """How many times its stated noise a sensor has, at that rate and its usual bandwidth."""
    device = part.typical()
    x = math.pi * device.bandwidth_Hz / rate_Hz
    folded = x / math.tanh(x) if math.isfinite(x) else 1.0
    rounding = device.resolution**2 / 6 / rate_Hz / float(np.min(device.noise_density)) ** 2
    return math.sqrt(folded + rounding)


def _measuring(axes: Sequence[AxisNoise], part: Part) -> list[AxisNoise]:
    return [axis for axis in axes if axis.unit == part.unit]


def _beside(axes: Sequence[AxisNoise], part: Part) -> list[AgainstSheet]:
    """The channels that show white noise and measure what the part does."""
    densities, rows = part.typical().noise_density, []
    for i, axis in enumerate(_measuring(axes, part)):
        stated, white = float(densities[min(i, len(densities) - 1)]), axis.term("N")
        if white.value is not None and white.u is not None and stated > 0:
            found, u = 2**0.5 * white.value, 2**0.5 * white.u
            rows.append(AgainstSheet(
                axis.channel, part.sheet, part.name, stated, found, u, found / stated, u / stated
            ))  # fmt: skip
    return rows
