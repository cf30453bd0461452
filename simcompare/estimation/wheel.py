"""From a wheel to a speed, and the trap of its unit.

A wheel of diameter D that turns once moves on by πD. So v = π·D·n, with n in revolutions per
second: that is how the formula is often printed, with an ω for n. In rad/s it is v = D·ω/2. Put ω
in rad/s into the first one, and every speed is 2π = 6.28 times too large; nothing else looks wrong.
"""

from __future__ import annotations

import math
from typing import TypeVar

from simcompare.model.trajectory import Array

Number = TypeVar("Number", float, Array)


def speed_from_rate(diameter_m: float, rate_rad_s: Number) -> Number:
    """Speed of a wheel that rolls, v = D·ω/2 with ω in rad/s [m/s]."""
    return diameter_m / 2 * rate_rad_s


def way_of_mark(diameter_m: float, marks: float) -> float:
    """Way between two of the marks of one turn [m]."""
    return math.pi * diameter_m / marks
