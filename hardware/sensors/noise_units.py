"""Units in which data sheets and IEEE Std 952 give the noises of an Allan plot."""

from __future__ import annotations

import math

from simcompare import units

_G, _DEGREE, _HOUR = 9.80665, math.pi / 180, 3600.0
#: unit of the reading -> coefficient -> unit of data sheets, and its size in SI
_SHEETS = {
    "m/s**2": {
        "N": ("µg/√Hz", 1e-6 * _G), "B": ("µg", 1e-6 * _G), "K": ("µg/√s", 1e-6 * _G),
        "Q": ("mm/s", 1e-3), "R": ("µg/s", 1e-6 * _G),
    },
    "rad/s": {
        "N": ("°/s/√Hz", _DEGREE), "B": ("°/h", _DEGREE / _HOUR),
        "K": ("°/h/√h", _DEGREE / _HOUR / 60), "Q": ("″", _DEGREE / _HOUR),
        "R": ("°/h/s", _DEGREE / _HOUR),
    },
}  # fmt: skip
#: the white noise once more, as navigation calls it: per root of an hour
_WALKS = {"rad/s": ("°/√h", _DEGREE / 60), "m/s**2": ("m/s/√h", 1 / 60)}
_SI = {"N": "/√Hz", "B": "", "K": "/√s", "Q": "·s", "R": "/s"}


def si(name: str, unit: str) -> str:
    """SI unit of a coefficient for readings in that unit."""
    base = units.symbol(unit) if unit != "1" else "1"
    return f"{base}{_SI[name]}"


def of_sheets(name: str, unit: str) -> tuple[str, float]:
    """Unit of a coefficient in data sheets, and its size in SI; SI where they have none."""
    return _SHEETS.get(unit, {}).get(name, (si(name, unit), 1.0))


def walk(unit: str) -> tuple[str, float] | None:
    """Unit of angle or velocity random walk, and its size in SI; ``None`` for other readings."""
    return _WALKS.get(unit)
