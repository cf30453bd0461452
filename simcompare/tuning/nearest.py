"""The nearest value with which something can be had that cannot be had with the one asked for."""

from __future__ import annotations

import math
from collections.abc import Callable

from simcompare.engine.calibration.edges import edge

#: how often the value is doubled or halved, and how often the way back is halved
_FAR, _NEAR = 8, 4


def nearest(can: Callable[[float], bool], start: float, factor: float) -> float | None:
    """The nearest value on one side with which something can be had, to two or three digits.

    Args:
        can: whether it can be had with a value.
        start: a value with which it cannot.
        factor: by which the value is multiplied, 2 or 0.5.

    Returns:
        The value, ``None`` if none was found.
    """
    bad, good = start, start
    for _ in range(_FAR):
        good *= factor
        if can(good):
            break
        bad = good
    else:
        return None
    good = edge(can, good, bad, _NEAR)
    for digits in (2, 3):  # as it is printed, and typed in
        rounded = _rounded(good, digits, up=factor > 1)
        if can(rounded):
            return rounded
    return None


def _rounded(value: float, digits: int, *, up: bool) -> float:
    unit = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    count = math.ceil(value / unit) if up else math.floor(value / unit)
    return float(f"{count * unit:.{digits}g}")
