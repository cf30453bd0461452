"""Whether there are enough measured numbers for the unknowns, and what gives those that miss."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from simcompare.errors import InputError
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.unknowns import base


def faults(
    drops: Sequence[Impacts], sought: Sequence[str], rows: int, stated: int, *, known: bool
) -> list[str]:
    """What is said where numbers are missing; nothing where there are enough.

    Args:
        drops: the measurements.
        sought: the unknowns.
        rows: how many numbers were measured.
        stated: how many of the unknowns have a prior.
        known: whether the uncertainties of what was measured are stated.
    """
    missing = len(sought) - rows - stated
    unknowns = _counted(len(sought), "unknown")
    if missing > 0:
        return [
            f"{_counted(rows, 'measured number')} and {_counted(stated, 'prior')} cannot give"
            f" {unknowns} ({', '.join(sought)});"
            f" {_cure(drops, sought, missing + (not known), known=known)}"
        ]
    if missing == 0 and not known:
        return [
            f"nothing tells the scatter of {_counted(rows, 'measured number')} without a stated"
            f" uncertainty when {unknowns} must be found; {_state(drops)}, or record more bounces"
        ]
    return []


def without_exact(drop: Impacts, fixed: Mapping[str, float]) -> Impacts:
    """A drop without its own height where that is exact: it tells neither ball nor scatter.

    Raises:
        InputError: the measured height is another one.
    """
    if drop.track is not None or "drop_height_m" not in fixed or 0 not in drop.height_numbers:
        return drop
    at, height = drop.height_numbers.index(0), fixed["drop_height_m"]
    if not math.isclose(drop.heights_m[at], height):
        raise InputError(drop.source or "fit", [
            f"the drop height is {drop.heights_m[at]:g} m in the recording, but fixed at {height:g}"
            " m; leave out one of them"
        ])  # fmt: skip
    rest = [k for k in range(len(drop.heights_m)) if k != at]
    return replace(
        drop, heights_m=drop.heights_m[rest], u_heights_m=drop.u_heights_m[rest],
        height_numbers=tuple(drop.height_numbers[k] for k in rest),
    )  # fmt: skip


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _state(drops: Sequence[Impacts]) -> str:
    """How uncertainties of what was measured are stated."""
    filmed, high = (any(found) for found in zip(
        *((drop.track is not None, len(drop.heights_m) > 0) for drop in drops), strict=True
    ))  # fmt: skip
    if filmed:
        return "state the uncertainty of the heights in a mapping file"
    column = "state their uncertainty in a column u_rebound_height"
    return column if high else "state the uncertainty, such as --u-time 1ms"


def _cure(drops: Sequence[Impacts], sought: Sequence[str], more: int, *, known: bool) -> str:
    """What gives so many numbers that are missing."""
    text = f"record {_counted(more, 'more bounce')} at least"
    if not any(base(name) == "drop_height_m" for name in sought) or more > 1 + (not known):
        return text
    also = f" and {_state(drops)}" if more > 1 else ""
    return f"{text}, or measure the drop height, such as --fix drop_height=0.8m{also}"
