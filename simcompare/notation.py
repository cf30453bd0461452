"""How a value is written with its uncertainty, and a remark as a sentence."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

#: digits of the largest value where no tolerance says how many matter
_DIGITS = 6
#: a spread of rounding is below this decimal
_ROUNDING_PLACES = 12

#: SI unit -> the units in which people write it, the largest first
_SPOKEN = {
    "m": {"km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "kg": {"kg": 1.0, "g": 1e-3, "mg": 1e-6},
    "m/s": {"m/s": 1.0, "cm/s": 1e-2, "mm/s": 1e-3},
    "rad": {"rad": 1.0, "deg": math.pi / 180},
    "rad/s": {"rad/s": 1.0, "deg/s": math.pi / 180},
    "N": {"N": 1.0, "mN": 1e-3},
    "N*m": {"N*m": 1.0, "mN*m": 1e-3},
    "Pa": {"Pa": 1.0},
    "V": {"V": 1.0, "mV": 1e-3},
    "A": {"A": 1.0, "mA": 1e-3},
    "Hz": {"kHz": 1e3, "Hz": 1.0},
}


def places(tolerance: float | None, values: Iterable[float | None] = ()) -> int | None:
    """Decimals of what is worth reading: nothing below the last one is shown, and it is 0.

    Args:
        tolerance: where there is one, its second digit is the last that matters.
        values: where there is none, what stands in one table; the largest has six digits, and
            counts have no decimals.

    Returns:
        Decimals, such as 4 for a tolerance of 0.0016; ``None`` where nothing is known.
    """
    if tolerance:
        return max(0, 1 - math.floor(math.log10(tolerance)))
    sizes = [abs(value) for value in values if value and math.isfinite(value)]
    if sizes and all(size.is_integer() for size in map(float, sizes)):
        return 0
    return max(0, _DIGITS - 1 - math.floor(math.log10(max(sizes)))) if sizes else None


def number(value: float | None, u: float | None = None, places: int | None = None) -> str:
    """A value with its standard deviation in the last two digits: ``0.80000(12)``; ``–`` if none.

    The concise notation of JCGM 100:2008, 7.2.2.

    Args:
        value: the value.
        u: its standard deviation; left out where it is below the last decimal.
        places: decimals at most; ``None`` for all that matter.
    """
    if value is None:
        return "–"
    if u is None or not u or not math.isfinite(u):
        return _alone(value, places)
    last = 1 - math.floor(math.log10(u))
    if round(u * 10.0**last) == 100:  # 0.0996 is 0.10, not 0.100
        last -= 1
    if places is not None and places < last:
        last = places
    if last > _ROUNDING_PLACES:
        return _signed(f"{value:.9g}")
    digits = round(u * 10.0**last)
    if u * 10.0**last < 1:
        return _alone(value, places)
    return f"{fixed(value, last)}({digits * 10 ** max(-last, 0)})"


def fixed(value: float, places: int) -> str:
    """A number with so many decimals; what rounds to 0 has no sign."""
    text = f"{round(value, places):.{max(places, 0)}f}"
    return minus(text.lstrip("-") if float(text) == 0 else text)


def is_zero(value: float, places: int | None) -> bool:
    """Whether nothing is left of a value with so many decimals."""
    return round(value, 15 if places is None else places) == 0


def _alone(value: float, places: int | None) -> str:
    """A value without a standard deviation."""
    if places is None:
        return _signed(f"{value:.{_DIGITS}g}") if value else "0"
    return "0" if is_zero(value, places) else fixed(value, places)


def _signed(text: str) -> str:
    """A number that may have an exponent with the longer sign before it."""
    return minus(text[:1]) + text[1:]


def minus(text: str) -> str:
    """Text with the sign of numbers, which is longer than a hyphen."""
    return text.replace("-", "−")


def amount(value: float, unit: str) -> str:
    """A value in the unit in which people say it: ``1 cm`` for 0.01 m; it can be typed so."""
    spoken = {u: size for u, size in _SPOKEN.get(unit, {}).items() if not u.startswith("deg")}
    fitting = [(u, size) for u, size in spoken.items() if abs(value) >= size * (1 - 1e-9)]
    name, size = fitting[0] if fitting and value else (unit.removeprefix("1"), 1.0)
    for plain, pretty in (("**2", "²"), ("**3", "³"), ("*", "·")):
        name = name.replace(plain, pretty)
    return f"{value / size:.4g} {name}".strip()


def span(low: float, high: float, unit: str) -> str:
    """Two bounds as people say them: ``1 cm to 20 m``."""
    return f"{amount(low, unit)} to {amount(high, unit)}"


def rounded_within(low: float, high: float) -> tuple[float, float]:
    """Bounds above 0 in two digits, both within the exact ones."""
    lower, upper = (10.0 ** (1 - math.floor(math.log10(bound))) for bound in (low, high))
    return math.ceil(low * lower - 1e-9) / lower, math.floor(high * upper + 1e-9) / upper


def meant(number: float, unit: str, low: float, high: float) -> str | None:
    """A number with the largest smaller unit that brings it within bounds: ``50cm`` for 50."""
    for name, size in _SPOKEN.get(unit, {}).items():
        if size < 1 and low <= number * size <= high:
            return f"{number:g}{name}"
    return None


#: what is a quantity and no word: u is not U
_SYMBOL = re.compile(r"[a-z](?= ?[:=_])")


def capital(text: str) -> str:
    """Text whose first letter is a capital; all others stay, as does a symbol of one letter."""
    return text if _SYMBOL.match(text) else text[:1].upper() + text[1:]


def sentence(text: str) -> str:
    """A remark with a capital and a full stop."""
    return capital(text) + ("" if text.endswith(".") else ".")
