"""Words at the end of a name that may be its unit: ``speed_km_h``, ``torque_oz_in``."""

from __future__ import annotations

import re
from collections.abc import Sequence

from simcompare.units import spelling, table

_BETWEEN = re.compile(r"[_ .]+")
#: what is written for a unit in names, though it is none
_COUNTED = ("px", "pix", "pixel", "pixels", "count", "counts", "cts", "ticks", "LSB", "LSBs", "lsb")
#: units that are other words in names, and what is a power of the word before it
_NO_UNITS = ("u", "U", "tr", "std", "rot", "tag", "day", "h2", "l1", "l2", "l3")
_TIMES = ("s", "sec", "ms", "us", "min", "h", "hr")
#: units that are multiplied when they follow each other
_PRODUCTS = (
    (("N", "mN", "kN", "cN", "oz", "ozf", "lb", "lbf", "kgf", "gf", "kg"),
     ("m", "mm", "cm", "in", "ft")),
    (("in", "ft"), ("lb", "lbs", "lbf", "oz", "ozf")),
    (("A", "mA", "W", "mW", "kW"), ("s", "h")),
)  # fmt: skip
#: one letter that may be a unit over another that is no time
_OVER = ("N", "V", "A", "W", "J")


def words(name: str) -> list[str]:
    """Words of a name as they are written, without what stands about them."""
    found = _BETWEEN.split(name.strip("_ ."))
    # MATLAB makes acc_m_s_2_ of acc (m/s^2)
    if name.endswith("_") and len(found) > 3 and found[-1] in "23" and unit_like(found[-2]):
        found[-2:] = [found[-2] + found[-1]]
    return found


def run(name: str) -> list[str]:
    """The words at the end of a name that may all be units; the first word never is."""
    found: list[str] = []
    for word in reversed(words(name)[1:]):
        if not unit_like(word) or (word == "min" and found):
            break
        found.insert(0, word)
    return found


def is_several(name: str, suffix: str) -> bool:
    """Whether more words than a suffix may be the unit of a name: ``k_N_mm``, ``kv_rpm_V``."""
    return len(run(name)) > max(suffix.count("_"), 1)


def unit_like(word: str) -> bool:
    """Whether a word of a name may be a unit, or stands in the place of one."""
    if word in _COUNTED or len(spelling.ways(word)) > 1:
        return True
    if word in _NO_UNITS or word in table.NO_UNITS:
        return False
    found = spelling.read(word)
    return found is not None and bool(found.expression)


def is_weak(word: str) -> bool:
    """Whether a unit is as likely something else: one letter counts or means left."""
    return len(word) == 1 or word in ("in", "min", "bar", "rev")


def readings(found: Sequence[str]) -> list[str]:
    """What a run of two units or more may mean, as it is written with signs."""
    first, last = found[-2], found[-1]
    if len(found) == 3:
        return [f"{found[0]}*{first}/{last}", f"{found[0]}/{first}/{last}"]
    if len(found) > 3:
        return []
    over = last.rstrip("23") in _TIMES or not is_weak(first) or first in _OVER
    product = any(first in one and last in other for one, other in _PRODUCTS)
    return [f"{first}*{last}"] * product + [f"{first}/{last}"] * over
