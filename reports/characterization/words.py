"""Numbers and lists of engines as they stand in a sentence."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.running.jobs import OK

#: engine -> what was found of it
Found = Mapping[str, Mapping[str, Any]]
#: how a sentence about a level begins
HEADS = {
    DEFAULT: "by default",
    COEFFICIENTS: "with the coefficients typed in",
    TUNED: "tuned",
    ASSISTED: "with our helps",
}


def by_engine(answers: Sequence[Mapping[str, Any]], experiment: str, level: str) -> Found:
    """What engines answered to an experiment at a level."""
    return {
        answer["engine"]: answer["found"]
        for answer in answers
        if (answer["experiment"], answer["contact"], answer["status"]) == (experiment, level, OK)
    }


def listed(names: Iterable[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    every = list(names)
    return every[0] if len(every) == 1 else f"{', '.join(every[:-1])} and {every[-1]}"


def amounts(values: Mapping[str, Any], text: Callable[[Any], str]) -> str:
    """``−2 % in mujoco, +3 % in dart and pybullet``, the smallest first."""
    groups: dict[str, list[str]] = {}
    for name, value in sorted(values.items(), key=lambda item: item[1]):
        groups.setdefault(text(value), []).append(name)
    return ", ".join(f"{said} in {listed(names)}" for said, names in groups.items())


def rounded(value: float, digits: int = 2) -> str:
    """A number in so many digits without a power of ten, if that reads well."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    text = f"{float(f'{value:.{digits}g}'):.10g}"
    return text.replace("-", "−") if "e" not in text else f"{value:.{digits - 1}e}"


def percent(part: float) -> str:
    """A part of 1 in per cent."""
    return f"{rounded(100 * part)} %"


def signed(part: float) -> str:
    """A deviation in per cent with its sign."""
    return f"{'+' if part > 0 else ''}{percent(part)}"


def milli(value: float, unit: str) -> str:
    """A number in thousandths of a unit."""
    return f"{rounded(1e3 * value)} m{unit}"


def capital(text: str) -> str:
    """The same with a capital at its start."""
    return text[:1].upper() + text[1:]
