"""How a value is written with its uncertainty, and a remark as a sentence."""

from __future__ import annotations

import math


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


def capital(text: str) -> str:
    """Text whose first letter is a capital; all others stay."""
    return text[:1].upper() + text[1:]


def sentence(text: str) -> str:
    """A remark with a capital and a full stop."""
    return capital(text) + ("" if text.endswith(".") else ".")
