"""Numbers of data sheets with their units, such as 400 µg/√Hz and 16384 LSB/g, in SI."""

from __future__ import annotations

import re

from simcompare import units
from simcompare.errors import InputError

#: a part of full scale
_BASES = {"% FS": "percent", "%FS": "percent"}
#: what a unit can be divided by at its end -> how that is written, and its size in SI
_PER = {
    "/√Hz": ("√Hz", 1.0), "/rtHz": ("√Hz", 1.0), "/sqrt(Hz)": ("√Hz", 1.0),
    "/°C": ("K", 1.0), "/K": ("K", 1.0), "/√s": ("√s", 1.0), "/√h": ("√s", 60.0),
}  # fmt: skip
_NUMBER = re.compile(r"^\s*[±+]?\s*(-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
#: an example of each SI unit, as sheets write it
EXAMPLES = {
    "m/s**2": "mg", "rad/s": "°/s", "Pa": "Pa", "m": "mm", "A": "mA", "V": "mV", "rad": "°",
    "1": "%", "Hz": "Hz",
}  # fmt: skip


def written(unit: str, per: str = "") -> str:
    """A unit as people write it: ``m/s²/√Hz``."""
    base = "" if unit == "1" else units.symbol(unit)
    return f"{base or '1'}/{per}" if per else base


def amount(text: str | float, unit: str, per: str = "") -> float:
    """Reads ``"±50 mg"`` or ``"400 µg/√Hz"`` in SI; the sign ± is only written for the reader.

    Args:
        text: number and unit, as the sheet states them.
        unit: SI unit wanted, without what it is divided by.
        per: what it is divided by: ``""``, ``"√Hz"``, ``"K"`` or ``"√s"``.

    Raises:
        ValueError: no number, or a unit that does not fit; says what was expected.
    """
    expected = f"expected a number with a unit, such as 1 {_example(unit, per)}"
    match = _NUMBER.match(str(text))
    if match is None:
        raise ValueError(f"{text!r} is not a number; {expected}")
    base, found, size = _parted(match[2])
    if not base and unit != "1":
        raise ValueError(f"{text!r} has no unit; {expected}")
    if found != per:
        raise ValueError(f"the unit of {text!r} does not fit; {expected}")
    try:
        factor = units.conversion_factor(_BASES.get(base, base), unit, "") if base else 1.0
    except InputError:
        raise ValueError(f"{match[2]!r} is no unit that fits; {expected}") from None
    return float(match[1]) * factor / size


def spoken(unit: str) -> tuple[str, float]:
    """The unit in which sheets speak of an SI unit, and its size."""
    name = EXAMPLES.get(unit, units.symbol(unit))
    return name, amount(f"1 {name}", unit)


def step(text: str | float, unit: str) -> float:
    """Size of one count in SI, from ``"16384 LSB/g"``, ``"0.061 mg/LSB"`` or ``"0.061 mg"``.

    Raises:
        ValueError: it is none of these, or not above 0.
    """
    try:
        size = _step(str(text), unit)
    except ValueError:
        size = 0.0
    if not size > 0:
        base = EXAMPLES.get(unit, units.symbol(unit))
        expected = f"expected one such as 100 LSB/{base} or 0.01 {base}/LSB"
        raise ValueError(f"{text!r} is no size of one count; {expected}")
    return size


def _step(text: str, unit: str) -> float:
    match = _NUMBER.match(text)
    if match is None or not match[2].startswith("LSB/"):
        return amount(text.removesuffix("/LSB"), unit)
    return amount(f"1 {match[2].removeprefix('LSB/').strip('()')}", unit) / float(match[1])


def is_counts(text: str | float) -> bool:
    """Whether a value is in counts per unit, such as ``230 LSB/g``."""
    return "LSB/" in str(text)


def _example(unit: str, per: str) -> str:
    base = "µg" if (unit, per) == ("m/s**2", "√Hz") else EXAMPLES.get(unit, units.symbol(unit))
    return f"{base}/{per}" if per else base


def _parted(unit: str) -> tuple[str, str, float]:
    """Unit, what it is divided by, and the size of that in SI."""
    for ending, (per, size) in _PER.items():
        if unit.endswith(ending):
            return unit.removesuffix(ending), per, size
    return unit, "", 1.0
