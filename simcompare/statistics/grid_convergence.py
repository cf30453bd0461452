"""The numerical error told from runs with finer and finer steps: grid convergence index."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from simcompare.errors import InputError

#: safety factors: three grids that converge as they should, and everything else
SAFE, CAUTIOUS = 1.25, 3.0
#: a change smaller than this share of the value is rounding
ROUNDING = 1e-13


@dataclass(frozen=True)
class Gci:
    """Grid convergence index of the finest of two or three runs.

    Attributes:
        order: order of convergence used in the index.
        observed: order observed from three runs; ``None`` where there is none.
        extrapolated: value at step zero by Richardson; the finest value where that is unsafe.
        safety: safety factor.
        error: the index times the finest value, in its unit: half-width of a 95 % band.
        gci: the index itself, relative to the finest value [1]; ``None`` where that is zero.
        u_num: standard uncertainty of the finest value.
        kind: "monotone", "oscillatory", "diverging", "converged", "stalled" or "two grids".
        text: one sentence that says what was done.
    """

    order: float
    observed: float | None
    extrapolated: float
    safety: float
    error: float
    gci: float | None
    u_num: float
    kind: str
    text: str

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self)


def gci(
    f_fine: float,
    f_medium: float,
    f_coarse: float | None = None,
    ratio: float | tuple[float, float] = 2.0,
    *,
    order: float | None = None,
) -> Gci:
    """Grid convergence index from runs whose steps are a ratio apart.

    P. J. Roache, J. Fluids Eng. 116 (1994) 405, with the procedure of I. B. Celik et al., J.
    Fluids Eng. 130 (2008) 078001 for unequal ratios. Three runs that converge monotonically have a
    safety factor of 1.25; two runs 3. Where a formal order is given and the observed one is more
    than a tenth away from it, the factor is 3 and the order is kept between 0.5 and the formal one
    (W. L. Oberkampf and C. J. Roy, Verification and Validation in Scientific Computing, 2010,
    8.7.3). Oscillating or diverging runs have no order: factor 3 with order 1, and not less than
    the standard deviation of the runs. u_num is half of the band (ASME V&V 20-2009, 2-5).

    Args:
        f_fine: value with the smallest step.
        f_medium: value with the step ``ratio`` times as large.
        f_coarse: value with the largest step; ``None`` where there are two runs only.
        ratio: ratio of neighbouring steps, or (medium/fine, coarse/medium).
        order: formal order of the method, where known.

    Raises:
        InputError: a value is missing, or a ratio is not greater than 1.
    """
    r21, r32 = ratio if isinstance(ratio, tuple) else (ratio, ratio)
    values = [f for f in (f_fine, f_medium, f_coarse) if f is not None]
    bad = [f"a run gave {f}" for f in values if not math.isfinite(f)]
    bad += [
        f"a ratio of steps is {r}; it must exceed 1, better 1.3" for r in {r21, r32} if not r > 1
    ]
    if order is not None and not order > 0:
        bad.append(f"the formal order is {order}; it must be positive")
    if bad:
        raise InputError("grid convergence", bad)
    rounding = ROUNDING * max(map(abs, values))
    change = f_medium - f_fine
    if f_coarse is None:
        return _two(f_fine, change, r21, order, rounding)
    return _three(f_fine, change, f_coarse - f_medium, (r21, r32), order, rounding)


def _two(f_fine: float, change: float, ratio: float, order: float | None, rounding: float) -> Gci:
    p = order or 1.0
    if abs(change) <= rounding:
        text = "Two steps give the same value; a third step would tell whether that is chance."
        return _index(f_fine, 0.0, ratio, p, None, (CAUTIOUS, "converged", text))
    known = "the formal order" if order else "order 1, none being known"
    text = f"Two steps only, so the safety factor is 3, with {known}."
    return _index(f_fine, change, ratio, p, None, (CAUTIOUS, "two grids", text))


def _three(
    f_fine: float,
    change: float,
    coarser: float,
    ratios: tuple[float, float],
    order: float | None,
    rounding: float,
) -> Gci:
    r21 = ratios[0]
    spread = float(np.std([0.0, change, change + coarser], ddof=1))
    if abs(change) <= rounding and abs(coarser) <= rounding:
        text = "Three steps give the same value; no numerical error is seen."
        return _index(f_fine, 0.0, r21, order or 1.0, None, (SAFE, "converged", text))
    if abs(change) <= rounding or abs(coarser) <= rounding:
        text = (
            "Two of the three steps give the same value, so no order can be seen; "
            "safety factor 3 with order 1, and not less than the spread of the runs."
        )
        return _unordered(f_fine, max(abs(change), abs(coarser)), r21, spread, ("stalled", text))
    if change * coarser < 0:
        text = (
            "The value oscillates as the step shrinks; safety factor 3 with order 1, and not less "
            "than the spread of the runs."
        )
        return _unordered(f_fine, change, r21, spread, ("oscillatory", text))
    observed = observed_order(change, coarser, ratios)
    if observed is None or observed <= 0:
        text = (
            "The change grows as the step shrinks: the runs do not converge; safety factor 3 with "
            "order 1, and not less than the spread of the runs."
        )
        return _unordered(f_fine, change, r21, spread, ("diverging", text))
    return _monotone(f_fine, change, r21, observed, order)


def _monotone(f_fine: float, change: float, ratio: float, p: float, order: float | None) -> Gci:
    if order is not None and abs(p - order) > 0.1 * order:
        used = min(max(0.5, p), order)
        text = (
            f"The observed order {p:.2f} is more than a tenth away from the formal order "
            f"{order:g}, so the safety factor is 3 with order {used:.2f}."
        )
        return _index(f_fine, change, ratio, used, p, (CAUTIOUS, "monotone", text))
    text = f"Three steps converge with order {p:.2f}; the safety factor is 1.25."
    return _index(f_fine, change, ratio, p, p, (SAFE, "monotone", text))


def _index(
    f_fine: float,
    change: float,
    ratio: float,
    order: float,
    observed: float | None,
    said: tuple[float, str, str],
) -> Gci:
    safety, kind, text = said
    rest = change / (ratio**order - 1)
    error = safety * abs(rest)
    # Richardson only where the order was seen; otherwise the finest run is the best that is known
    best = f_fine - rest if observed is not None else f_fine
    relative = error / abs(f_fine) if f_fine != 0 else None
    return Gci(order, observed, best, safety, error, relative, error / 2, kind, text)


def _unordered(
    f_fine: float, change: float, ratio: float, spread: float, said: tuple[str, str]
) -> Gci:
    kind, text = said
    found = _index(f_fine, change, ratio, 1.0, None, (CAUTIOUS, kind, text))
    error = max(found.error, 2 * spread)
    relative = error / abs(f_fine) if f_fine != 0 else None
    return Gci(1.0, None, f_fine, CAUTIOUS, error, relative, error / 2, kind, text)


def observed_order(change: float, coarser: float, ratios: tuple[float, float]) -> float | None:
    """Order p with coarser/change = r21^p·(r32^p - 1)/(r21^p - 1), for three monotone runs.

    Args:
        change: medium minus fine.
        coarser: coarse minus medium, of the same sign.
        ratios: (medium/fine, coarse/medium).

    Returns:
        The order, negative where the runs diverge; ``None`` where there is none in -20 … 20.
    """
    r21, r32 = ratios
    wanted = coarser / change
    if math.isclose(r21, r32, rel_tol=1e-9):
        return math.log(wanted) / math.log(r21)
    from scipy.optimize import brentq

    def excess(p: float) -> float:
        # the quotient at p = 0 is the limit log r32 / log r21
        steps = math.expm1(p * math.log(r32)) / math.expm1(p * math.log(r21)) if p else (
            math.log(r32) / math.log(r21))  # fmt: skip
        return p * math.log(r21) + math.log(steps) - math.log(wanted)

    if excess(-20.0) * excess(20.0) > 0:
        return None
    return float(brentq(excess, -20.0, 20.0, xtol=1e-12))
