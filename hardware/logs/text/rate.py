"""The rate of the samples, where the lines above a table say it."""

from __future__ import annotations

import re
from collections.abc import Mapping

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text import clocks
from simcompare.hardware.logs.text.marks import mark_of

_OF = r"(?:sampl(?:e|ing)|scan|acquisition|frame|log(?:ging)?|data|update|output)[ _-]*"
_RATE = re.compile(rf"{_OF}(?:rate|freq(?:uency)?)|fs|fps|abtastrate", re.IGNORECASE)
_INTERVAL = re.compile(
    rf"{_OF}(?:interval|period|time|step)|time[ _-]?(?:step|increment|interval)|dt|delta[ _]?t"
    r"|t ?inc|(?:x ?)?increment|clock", re.IGNORECASE,
)  # fmt: skip
_VALUE = re.compile(r"([-+.,\d]+(?:[eE][-+]?\d+)?)\s*([^\s,;]*)")
#: samples in a second, as they are written beside Hz
_SAMPLES = {"": 1.0, "fps": 1.0, "sps": 1.0, "samples": 1.0, "s/s": 1.0, "sa/s": 1.0, "ks/s": 1e3}


def of(about: Mapping[str, str]) -> tuple[float, str] | None:
    """Samples in a second, and what says so.

    Args:
        about: what the lines above a table say, key by key.
    """
    for key, value in about.items():
        name, unit = _cell.heading(key)
        match = _VALUE.match(value)
        mark = mark_of(match[1]) if match else "?"  # 1,000 may be one or a thousand
        number = _cell.number(match[1], mark or ".") if match and mark in ("", ".", ",") else None
        if match is None or number is None or not number > 0:
            continue
        rate = _rate(name, number, unit or match[2])
        if rate is not None:
            return rate, f"{key}: {value}"
    return None


def _rate(name: str, number: float, unit: str) -> float | None:
    if _RATE.fullmatch(name):
        return number * (_SAMPLES.get(unit.lower()) or _si(unit, "Hz")) or None
    if not _INTERVAL.fullmatch(name):
        return None
    # without a unit, a whole number may count milliseconds as well
    unit = clocks.spelled(unit) or unit  # a clock of 400 uS counts no siemens
    factor = _si(unit, "s") if unit else float(number < 1)
    return 1 / (number * factor) if factor else None


def _si(unit: str, expected: str) -> float:
    """What a unit is in SI, 0 where it is of another quantity."""
    try:
        factor, _, si = units.si_of(unit, "")
    except InputError:
        return 0.0
    return factor if si == expected else 0.0
