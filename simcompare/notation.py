"""How a value is written with its uncertainty, and a remark as a sentence."""

from __future__ import annotations

import math

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


def number(value: float | None, u: float | None = None) -> str:
    """A value with its standard deviation in the last two digits: ``0.80000(12)``; ``–`` if none.

    The concise notation of JCGM 100:2008, 7.2.2.
    """
    if value is None:
        return "–"
    if u is None or u == 0 or not math.isfinite(u):
        return f"{value:.6g}"
    places = 1 - math.floor(math.log10(u))
    digits = round(u * 10**places)
    if digits == 100:  # 0.0996 is 0.10, not 0.100
        places, digits = places - 1, 10
    if places > 12:  # a spread of rounding
        return f"{value:.9g}"
    if places <= 0:
        return f"{round(value, places):.0f}({digits * 10**-places})"
    return f"{value:.{places}f}({digits})"


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


def capital(text: str) -> str:
    """Text whose first letter is a capital; all others stay."""
    return text[:1].upper() + text[1:]


def sentence(text: str) -> str:
    """A remark with a capital and a full stop."""
    return capital(text) + ("" if text.endswith(".") else ".")
