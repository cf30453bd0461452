"""A wheel that rolls: v = ω·D/2 with ω in rad/s, or v = π·D·n with n in turns a second."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare import units
from simcompare.hardware.conditioning.units.meaning import (
    Claim,
    mapping_line,
    near,
    of_one_thing,
    take,
)
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping_lines import channels_line
from simcompare.hardware.raw import IMPORT

_WORDS = frozenset(
    (
        "speed", "velocity", "vel", "v", "rate", "rpm", "omega", "w", "encoder", "enc", "motor",
        "angular", "linear", "wheel", "rad", "m", "s", "rps", "turns", "per",
    )
)  # fmt: skip
#: a ratio is a known factor within so much: tyres and diameters are known to a few percent
_NEAR = 1.15
#: samples slower than this part of the fastest are left out
_SLOW = 0.2


def check(work: Work, every_claim: Sequence[Claim]) -> None:
    """Holds speeds over ground against turning rates, where the mapping gives the diameter."""
    diameter = work.mapping.wheel_diameter_m
    if diameter is None:
        return
    for speed, rate in _pairs(every_claim):
        ratio = _ratio(speed, rate)
        if ratio is not None:
            _judge(work, speed, rate, ratio / (diameter / 2))


def _pairs(claims: Sequence[Claim]) -> list[tuple[Claim, Claim]]:
    """Speeds [m/s] and rates [rad/s] of the same wheel, by names; or the only one of each."""
    same = of_one_thing(claims, {"m/s": "rad/s"}, _WORDS)
    speeds, rates = ([c for c in claims if c.si == si] for si in ("m/s", "rad/s"))
    return [(speeds[0], rates[0])] if not same and len(speeds) == len(rates) == 1 else same


def _ratio(speed: Claim, rate: Claim) -> float | None:
    """Median of v/ω where it turns fast, ``None`` where it does not, or where both disagree."""
    v, omega = speed.values(slice(None)), rate.values(slice(None))
    finite = np.isfinite(v) & np.isfinite(omega)
    fast = finite & (np.abs(omega) > _SLOW * np.abs(omega[finite]).max(initial=0.0))
    if fast.sum() < 10:
        return None
    low, middle, high = np.quantile(v[fast] / omega[fast], (0.25, 0.5, 0.75))
    # a wheel that slips, or two things that have nothing to do with each other
    return float(middle) if high - low < 0.2 * abs(middle) else None


def _judge(work: Work, speed: Claim, rate: Claim, ratio: float) -> None:
    """``ratio`` is v/(ω·D/2), 1 where all is well."""
    pair = f"{speed.column.name!r} ({speed.unit}) and {rate.column.name!r} ({rate.unit})"
    text = f"columns {pair}: the speed is {ratio:.3g} times ω·D/2"
    size = abs(ratio)
    if near(size, 1.0, _NEAR):
        if ratio < 0:
            work.warn("sign", f"{text}: one of them counts the other way", channel=rate.column.name)
        return
    unit = _other_unit(rate, size)
    if unit and work.assume_units:
        fitted = ratio * rate.unit_si / units.si_of(unit, "")[0]
        text += f"; the rate was taken as {unit}, which fits"
        take(work, rate, unit, text, {"ratio": ratio}, {"ratio": fitted})
    elif unit:
        work.fault(
            f"{text}; expected 1. Either the rate is in {unit} (write in the mapping file"
            f" {channels_line(mapping_line(rate, unit))}, or {IMPORT} --assume-units), or the speed"
            " was computed as π·D·ω with ω in rad/s; it is π·D·n with turns a second"
        )
    elif near(size, 2.0, _NEAR) or near(size, 0.5, _NEAR):
        work.warn(
            "wheel_diameter",
            f"{text}; expected 1: a radius may have been taken for a diameter",
            channel=speed.column.name, before={"ratio": ratio},
        )  # fmt: skip
    else:
        work.warn(
            "wheel_speed",
            f"{text}; expected 1: check unit, gear and diameter",
            channel=speed.column.name, before={"ratio": ratio},
        )  # fmt: skip


def _other_unit(rate: Claim, size: float) -> str:
    """The unit of the rate with which speed and rate agree."""
    turn = 2 * math.pi
    known = {"rad/s": 1.0, "turn/s": turn, "turn/min": turn / 60, "deg/s": turn / 360}
    others = {unit: factor for unit, factor in known.items() if factor != rate.unit_si}
    return next((u for u, f in others.items() if near(f / rate.unit_si, size, _NEAR)), "")
