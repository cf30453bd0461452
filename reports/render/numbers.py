"""Numbers as people read them: a value with its uncertainty, in sensible digits."""

from __future__ import annotations

import math
import re

#: outside of these powers of ten a number is written as a mantissa and a power
_PLAIN = (-3, 6)
_MISSING = "–"
#: relative size below which a difference of two doubles is rounding
ROUNDING = 1e-12
#: significant digits of a value whose uncertainty is not known
_MIN_DIGITS, _MAX_DIGITS = 4, 12
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
    text = _minus(text.rstrip("0").rstrip(".") if "." in text else text)
    return text if power is None else f"{text}·10{raised(power)}"


def with_u(
    value: float | None,
    u: float | None,
    unit: str = "1",
    scale: float | None = None,
    digits: int = 6,
) -> str:
    """``value ± u``: u in two significant digits, the value to the same place.

    Args:
        value: the value; a dash where it is ``None`` or not finite.
        u: its standard deviation or uncertainty; left out where it is ``None``.
        unit: unit, ``"1"`` for none.
        scale: size of the quantity (its truth, say); what is a rounding error of it counts as 0.
        digits: significant digits of the value where its uncertainty is not known.
    """
    if value is None or not math.isfinite(value):
        return _MISSING
    smallest = ROUNDING * max(abs(value), abs(scale or 0.0))
    value = value if abs(value) > smallest else 0.0
    after = "" if unit in ("", "1") else f" {unit}"
    if u is None or not math.isfinite(u):
        return plain(value, digits) + after
    if u <= smallest:  # all repeats fell into the same sample: "± 0" would claim too much
        return plain(value) + after
    power = _power(max(abs(value), u))
    factor = 10.0 ** (power or 0)
    text = _same_place(value / factor, u / factor)
    if power is None:
        return f"({text}){after}" if after else text
    return f"({text})·10{raised(power)}{after}"


def digits(value: float | None, tolerance: float | None) -> int:
    """Digits of a value whose uncertainty is not known: the last a hundredth of its tolerance."""
    if not value or not math.isfinite(value) or not tolerance:
        return _MIN_DIGITS
    apart = math.floor(math.log10(abs(value))) - math.floor(math.log10(tolerance))
    return min(max(_MIN_DIGITS, apart + 3), _MAX_DIGITS)


def fixed(value: float, places: int) -> str:
    """A number with so many decimals; what rounds to 0 has no sign."""
    text = f"{value:.{places}f}"
    return _minus(text.lstrip("-") if float(text) == 0 else text)


def percent(part: float | None) -> str:
    """A part of 1 as per cent, in two significant digits where it is below 100 %."""
    if part is None or not math.isfinite(part):
        return _MISSING
    return f"{plain(100 * part, 2 if abs(part) < 1 else 3)} %"


def _same_place(value: float, u: float) -> str:
    # the exponent after rounding, so that 0.0996 is 0.10 and not 0.100
    place = 1 - int(f"{u:.1e}".partition("e")[2])
    decimals = max(place, 0)
    return f"{_minus(f'{round(value, place):.{decimals}f}')} ± {round(u, place):.{decimals}f}"


def _power(value: float) -> int | None:
    """The power of ten to write apart, ``None`` where the number reads well without."""
    power = math.floor(math.log10(abs(value)))
    return None if _PLAIN[0] <= power < _PLAIN[1] else power


def raised(power: int) -> str:
    """A power as it is written above the line."""
    return str(power).translate(_SUPERSCRIPTS)


def _minus(text: str) -> str:
    return text.replace("-", "−")


def tied(text: str) -> str:
    """Numbers stay on one line with their sign and unit."""
    return re.sub(r"(?<=±) |(?<=\d) (?=±)| (?=(?:%|ms|mm/s|m/s)(?:\W|$))", "\u00a0", text)
