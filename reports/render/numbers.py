"""Numbers as people read them: a value with its uncertainty, in sensible digits."""

from __future__ import annotations

import math
import re

from simcompare.notation import fixed, is_zero, minus

#: outside of these powers of ten a number is written as a mantissa and a power
_PLAIN = (-3, 6)
_MISSING = "–"
#: relative size below which a difference of two doubles is rounding
ROUNDING = 1e-12
#: more decimals than these are read better as a power of ten
MOST_PLACES = 9
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def plain(value: float | None, digits: int = 6) -> str:
    """A number alone, in at most so many significant digits; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return _MISSING
    if value == 0:
        return "0"
    value = float(f"{value:.{digits - 1}e}")  # rounded first: 9.99 becomes 10, not 10·10⁰
    power = _power(value)
    mantissa = value / 10.0 ** (power or 0)
    place = digits - 1 - math.floor(math.log10(abs(mantissa)))
    text = f"{round(mantissa, place):.{max(place, 0)}f}"
    text = minus(text.rstrip("0").rstrip(".") if "." in text else text)
    return text if power is None else f"{text}·10{raised(power)}"


def with_u(
    value: float | None,
    u: float | None,
    unit: str = "1",
    scale: float | None = None,
    digits: int = 6,
    places: int | None = None,
) -> str:
    """``value ± u``: u in two significant digits, the value to the same place.

    Args:
        value: the value; a dash where it is ``None`` or not finite.
        u: its standard deviation or uncertainty; left out where it is ``None``.
        unit: unit, ``"1"`` for none.
        scale: size of the quantity (its truth, say); what is a rounding error of it counts as 0.
        digits: significant digits of the value where its uncertainty is not known.
        places: decimals that are worth reading, see :func:`simcompare.notation.places`.
    """
    if value is None or not math.isfinite(value):
        return _MISSING
    smallest = ROUNDING * max(abs(value), abs(scale or 0.0))
    value = value if abs(value) > smallest else 0.0
    after = "" if unit in ("", "1") else f" {unit}"
    if places is not None and places <= MOST_PLACES and abs(value) < 10.0 ** _PLAIN[1]:
        return _limited(value, u, places) + after
    if u is None or not math.isfinite(u):
        return plain(value, digits) + after
    if u <= smallest:  # all repeats fell into the same sample: "± 0" would claim too much
        return plain(value) + after
    power = _power(max(abs(value), u))
    factor = 10.0 ** (power or 0)
    text = _same_place(value / factor, u / factor, _last(u / factor))
    if power is None:
        return f"({text}){after}" if after else text
    return f"({text})·10{raised(power)}{after}"


def thousands(count: int) -> str:
    """A whole number with a space before each thousand."""
    return f"{count:,}".replace(",", " ")


def percent(part: float | None) -> str:
    """A part of 1 as per cent, in two significant digits where it is below 100 %."""
    if part is None or not math.isfinite(part):
        return _MISSING
    return f"{plain(100 * part, 2 if abs(part) < 1 else 3)} %"


def _limited(value: float, u: float | None, places: int) -> str:
    """A value with so many decimals at most; its u is told where it reaches the last of them."""
    if u is None or not math.isfinite(u) or u < 10.0**-places:
        return "0" if is_zero(value, places) else fixed(value, places)
    return _same_place(value, u, min(_last(u), places))


def _same_place(value: float, u: float, place: int) -> str:
    return f"{fixed(value, place)} ± {fixed(u, place)}"


def _last(u: float) -> int:
    """The decimal of the second digit, after rounding: 0.0996 is 0.10 and not 0.100."""
    return 1 - int(f"{u:.1e}".partition("e")[2])


def _power(value: float) -> int | None:
    """The power of ten to write apart, ``None`` where the number reads well without."""
    power = math.floor(math.log10(abs(value)))
    return None if _PLAIN[0] <= power < _PLAIN[1] else power


def raised(power: int) -> str:
    """A power as it is written above the line."""
    return str(power).translate(_SUPERSCRIPTS)


def tied(text: str) -> str:
    """Numbers stay on one line with their sign and unit."""
    return re.sub(r"(?<=±) |(?<=\d) (?=±)| (?=(?:%|ms|mm/s|m/s)(?:\W|$))", "\u00a0", text)
