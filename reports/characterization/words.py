"""Numbers and lists of engines as they stand in a sentence."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from operator import itemgetter
from typing import TypeVar

from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.reports.run.listing import joined
from simcompare.results.records.characterization import Trial

Kind = TypeVar("Kind")
Value = TypeVar("Value", float, tuple[float, float])

#: how a sentence about a level begins
HEADS = {
    DEFAULT: "by default",
    COEFFICIENTS: "with the coefficients typed in",
    TUNED: "tuned",
    ASSISTED: "with our helps",
}


def by_engine(trials: Iterable[Trial], kind: type[Kind], level: str) -> dict[str, Kind]:
    """What engines did in an experiment at a level."""
    return {
        trial.engine: trial.found
        for trial in trials
        if isinstance(trial.found, kind) and trial.contact == level
    }


def amounts(values: Mapping[str, Value], text: Callable[[Value], str]) -> str:
    """``−2 % in mujoco, +3 % in dart and pybullet``, the smallest first."""
    groups: dict[str, list[str]] = {}
    for name, value in sorted(values.items(), key=itemgetter(1)):
        groups.setdefault(text(value), []).append(name)
    return ", ".join(f"{said} in {joined(names)}" for said, names in groups.items())


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
