"""The numerical error from runs with longer and longer steps: grid convergence index."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError

#: ratio of neighbouring steps
RATIO = 2.0
#: safety factors: three runs that converge as they should, and everything else
SAFE, CAUTIOUS = 1.25, 3.0
#: a change smaller than this share of the value is rounding
ROUNDING = 1e-13


@dataclass(frozen=True)
class Gci:
    """Grid convergence index of the finest of two or three runs.

    Attributes:
        error: the index times the finest value, in its unit: half-width of a 95 % band.
        observed: order of convergence; ``None`` where there is none.
        kind: "monotone", "oscillatory", "diverging", "converged", "stalled" or "two grids".
        text: one sentence that says what was done.
    """

    error: float
    observed: float | None
    kind: str
    text: str

    @property
    def u_num(self) -> float:
        """Standard uncertainty of the finest value: half of the band (ASME V&V 20-2009, 2-5)."""
        return self.error / 2


def gci(f_fine: float, f_medium: float, f_coarse: float | None = None) -> Gci:
    """Grid convergence index from runs whose steps are 1 : 2 : 4.

    P. J. Roache, J. Fluids Eng. 116 (1994) 405. Three runs that converge monotonically have a
    safety factor of 1.25; two runs 3, with order 1. Oscillating or diverging runs have no order:
    factor 3 with order 1, and not less than the standard deviation of the runs.

    Args:
        f_fine: value with the smallest step.
        f_medium: value with twice the step.
        f_coarse: value with four times the step; ``None`` where there are two runs only.

    Raises:
        InputError: a value is missing.
    """
    values = [f for f in (f_fine, f_medium, f_coarse) if f is not None]
    bad = [f"a run gave {f}" for f in values if not math.isfinite(f)]
    if bad:
        raise InputError("grid convergence", bad)
    rounding = ROUNDING * max(map(abs, values))
    change = f_medium - f_fine
    if f_coarse is None:
        return _two(change, rounding)
    return _three(change, f_coarse - f_medium, rounding)


def _two(change: float, rounding: float) -> Gci:
    if abs(change) <= rounding:
        text = "Two steps give the same value; a third step would tell whether that is chance."
        return Gci(0.0, None, "converged", text)
    text = "Two steps only, so the safety factor is 3, with order 1, none being known."
    return Gci(_error(CAUTIOUS, change), None, "two grids", text)


def _three(change: float, coarser: float, rounding: float) -> Gci:
    small = (abs(change) <= rounding, abs(coarser) <= rounding)
    if all(small):
        text = "Three steps give the same value; no numerical error is seen."
        return Gci(0.0, None, "converged", text)
    order = (
        0.0 if any(small) or change * coarser < 0 else math.log(coarser / change) / math.log(RATIO)
    )
    if order > 0:
        text = f"Three steps converge with order {order:.2f}; the safety factor is 1.25."
        return Gci(_error(SAFE, change, order), order, "monotone", text)
    cautious = "safety factor 3 with order 1, and not less than the spread of the runs."
    largest = change
    if any(small):
        largest = max(abs(change), abs(coarser))
        kind = "stalled"
        text = f"Two of the three steps give the same value, so no order can be seen; {cautious}"
    elif change * coarser < 0:
        kind = "oscillatory"
        text = f"The value oscillates as the step shrinks; {cautious}"
    else:
        kind = "diverging"
        text = f"The change grows as the step shrinks: the runs do not converge; {cautious}"
    spread = float(np.std([0.0, change, change + coarser], ddof=1))
    return Gci(max(_error(CAUTIOUS, largest), 2 * spread), None, kind, text)


def _error(safety: float, change: float, order: float = 1.0) -> float:
    return float(safety * abs(change / (RATIO**order - 1)))
