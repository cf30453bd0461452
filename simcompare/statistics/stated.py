"""What is known of a quantity, as people state it: ``2%``, ``0.1mm``, ``±5g`` or ``0.1mm, dof 4``.

A number alone is a standard uncertainty. With ± it is the half-width of a range in which the value
certainly lies, as a maker or a ruler states it (JCGM 100:2008, 4.3.7).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from simcompare import units
from simcompare.errors import InputError
from simcompare.statistics import distributions
from simcompare.statistics.distributions import Distribution

#: shapes between two limits by the names that are typed
SHAPES: Mapping[str, Callable[[float, float], Distribution]] = {
    "rectangular": distributions.rectangular,
    "triangular": distributions.triangular,
    "u_shaped": distributions.u_shaped,
}
#: how an uncertainty is written
EXPECTED = "expected such as 2%, 0.1mm, ±5g, '±5g triangular' or '0.1mm, dof 4'"
_TEXT = re.compile(
    r"\s*(?P<sign>±|\+-|\+/-)?\s*(?P<width>[^\s,±][^,±]*?)"
    r"(?:\s+(?P<shape>normal|rectangular|triangular|u_shaped))?"
    r"(?:\s*,\s*dof\s*=?\s*(?P<dof>[\d.]+))?\s*"
)


@dataclass(frozen=True)
class Stated:
    """What was stated of a quantity.

    Attributes:
        distribution: what is known of it.
        degrees_of_freedom: of its standard uncertainty; infinite where it is taken as exact.
    """

    distribution: Distribution
    degrees_of_freedom: float = math.inf


def stated(text: str | float, center: float, unit: str, where: str) -> Stated:
    """Reads what is known of a quantity.

    Args:
        text: as in the head of this module; a number is a standard uncertainty in SI.
        center: its best estimate [SI].
        unit: its SI unit, "1" for a plain number.
        where: the quantity, which is named in an error.

    Raises:
        InputError: it cannot be read, or is not above 0.
    """
    found = _TEXT.fullmatch(str(text))
    if found is None:
        raise InputError(where, [f"{text!r} is no uncertainty; {EXPECTED}"])
    sign, shape = found["sign"], found["shape"]
    if shape and (shape == "normal") == bool(sign):
        cure = "leave out the ±" if sign else f"write ±{found['width']} {shape}"
        raise InputError(where, [f"{text!r} is a range without ±, or ± without a range; {cure}"])
    width = _width(found["width"], center, unit, where)
    degrees = math.inf if found["dof"] is None else _degrees(found["dof"], where)
    if sign:
        known = SHAPES[shape or "rectangular"](-width, width).scaled(1.0, center)
    elif math.isfinite(degrees):
        known = distributions.student_t(center, width, degrees)
    else:
        known = distributions.normal(center, width)
    return Stated(known, degrees)


def is_nothing(text: str | float, center: float) -> bool:
    """Whether a part is stated of a quantity that is 0, such as drag in vacuum."""
    return center == 0 and "%" in str(text)


def _width(text: str, center: float, unit: str, where: str) -> float:
    """Above 0 [SI]; a part of the estimate where it is in per cent."""
    number = text.strip()
    if number.endswith("%"):
        width = units.to_si(number[:-1].strip(), "1", where) / 100 * abs(center)
        if center == 0:
            raise InputError(
                where, [f"{number} of 0 is nothing; give the uncertainty in {_unit(unit)}"]
            )
    else:
        width = units.to_si(number, unit, where)
    if not 0 < width < math.inf:
        raise InputError(where, [f"{number} is no uncertainty; expected a number above 0"])
    return width


def _unit(unit: str) -> str:
    return "a plain number" if unit == "1" else units.symbol(unit)


def _degrees(text: str, where: str) -> float:
    try:
        degrees = float(text)
    except ValueError:
        degrees = 0.0
    if degrees < 1:
        raise InputError(
            where, [f"{text} are no degrees of freedom; expected a number of at least 1"]
        )
    return degrees
