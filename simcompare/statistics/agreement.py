"""How well two values or records agree: rms, coverage, E_n, zeta, Birge ratio, V&V 20."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from simcompare.errors import InputError

#: coverage factor of expanded uncertainties (JCGM 100:2008, 6)
COVERAGE_FACTOR = 2.0
#: that a normal error is within twice its standard deviation
COVERAGE_PROBABILITY = 0.9544997361036416
#: a sample's median absolute deviation times this is the standard deviation of normal noise
MAD_TO_SD = 1.482602218505602


def rms(values: ArrayLike) -> float:
    """Root mean square; NaN are left out.

    Args:
        values: of any shape, at least one of them known.
    """
    known = np.asarray(values, dtype=float)
    top = float(np.nanmax(np.abs(known)))
    if top == 0 or not math.isfinite(top):
        return top
    # neither tiny nor huge values leave the range of a double; a power of two costs no digit
    size = math.ldexp(1.0, math.frexp(top)[1] - 1)
    return size * math.sqrt(float(np.nanmean((known / size) ** 2)))


def coverage(deviations: ArrayLike, u: ArrayLike) -> float | None:
    """Share of the deviations within twice their standard uncertainties; ``None`` without any.

    Args:
        deviations: (n,); NaN are left out.
        u: standard uncertainties, one or one each; NaN are left out.
    """
    each, limit = np.broadcast_arrays(np.asarray(deviations, dtype=float), u)
    known = np.isfinite(each) & np.isfinite(limit)
    if not known.any():
        return None
    return float(np.mean(np.abs(each[known]) <= COVERAGE_FACTOR * limit[known]))


def e_n(x: float, X: float, U_x: float, U_X: float) -> float | None:
    """E_n number (x - X)/√(U_x² + U_X²); satisfactory for |E_n| ≤ 1 (ISO 13528:2022, 9.7).

    Args:
        x: the value.
        X: what it is held against.
        U_x: expanded uncertainty (k = 2) of x.
        U_X: expanded uncertainty (k = 2) of X.

    Returns:
        The number, or ``None`` where neither has an uncertainty: then it cannot be judged.
    """
    return _over_root(x - X, (U_x, U_X), "E_n")


def zeta(x: float, X: float, u_x: float, u_X: float) -> float | None:
    """Zeta score (x - X)/√(u_x² + u_X²) with standard uncertainties (ISO 13528:2022, 9.6).

    2 warns, 3 acts; it is twice the E_n number.

    Args:
        x: the value.
        X: what it is held against.
        u_x: standard uncertainty of x.
        u_X: standard uncertainty of X.

    Returns:
        The score, or ``None`` where neither has an uncertainty: then it cannot be judged.
    """
    return _over_root(x - X, (u_x, u_X), "zeta")


def _over_root(difference: float, parts: tuple[float, float], where: str) -> float | None:
    for part in parts:
        if not part >= 0:
            raise InputError(where, [f"an uncertainty is {part}; it must be zero or more"])
    size = math.hypot(*parts)
    return None if size == 0 else difference / size


@dataclass(frozen=True)
class Birge:
    """Whether values agree within their uncertainties.

    Attributes:
        n: number of values.
        mean: their weighted mean.
        u_mean: its standard uncertainty from the values' own.
        ratio: Birge ratio √(χ²/(n - 1)).
        low: lower end of the range to expect, 1 - 1/√(2(n - 1)).
        high: upper end, 1 + 1/√(2(n - 1)).
        chi2: sum of squares of deviation over uncertainty.
        chi2_limit: its 95 % quantile.
        consistent: whether chi2 is below that.
    """

    n: int
    mean: float
    u_mean: float
    ratio: float
    low: float
    high: float
    chi2: float
    chi2_limit: float
    consistent: bool


def birge_ratio(values: ArrayLike, u: ArrayLike) -> Birge:
    """Birge ratio and the χ² test at 95 % of n values with standard uncertainties.

    R. T. Birge, Phys. Rev. 40 (1932) 207; the mean with weights 1/u² (ISO 13528:2022, 7.7) and
    consistency as in M. G. Cox, Metrologia 39 (2002) 589, procedure A.

    Args:
        values: the values (n,), two or more.
        u: their standard uncertainties (n,), all positive.
    """
    from scipy import stats

    x = np.asarray(values, dtype=float).ravel()
    each = np.broadcast_to(np.asarray(u, dtype=float), x.shape)
    if len(x) < 2 or not np.all(np.isfinite(x)):
        text = f"{len(x)} values, or some are missing; one value alone agrees with nothing"
        raise InputError("Birge ratio", [text])
    if not np.all(np.isfinite(each) & (each > 0)):
        raise InputError("values", ["every value needs a standard uncertainty greater than zero"])
    # relative weights, so that very small uncertainties do not overflow
    weight = (each.min() / each) ** 2
    mean = float(x[0]) + float(np.sum(weight * (x - x[0])) / np.sum(weight))
    u_mean = float(each.min() / math.sqrt(np.sum(weight)))
    free = len(x) - 1
    chi2 = float(np.sum(((x - mean) / each) ** 2))
    limit = float(stats.chi2.ppf(0.95, free))
    half = 1 / math.sqrt(2 * free)
    ratio = math.sqrt(chi2 / free)
    return Birge(len(x), mean, u_mean, ratio, 1 - half, 1 + half, chi2, limit, chi2 <= limit)


@dataclass(frozen=True)
class VV20:
    """A simulated value held against a measured one.

    Attributes:
        simulated: simulated value S.
        measured: measured value D.
        u_num: standard uncertainty from the numerical solution; ``None`` where unknown.
        u_input: standard uncertainty from the parameters; ``None`` where unknown.
        u_data: standard uncertainty of the measurement; ``None`` where unknown.
        error: comparison error E = S - D.
        u_val: validation standard uncertainty, the root sum of squares of those that are known.
        e_n: E_n number; ``None`` where a part is unknown, as are the next two.
        zeta: zeta score.
        within_noise: |E| ≤ 2·u_val: the model's error is within the noise level. That is not the
            same as "validated": it says what cannot be seen.
    """

    simulated: float
    measured: float
    u_num: float | None
    u_input: float | None
    u_data: float | None
    error: float
    u_val: float
    e_n: float | None
    zeta: float | None
    within_noise: bool | None


def vv20(
    simulated: float,
    measured: float,
    *,
    u_num: float | None,
    u_input: float | None,
    u_data: float | None,
) -> VV20:
    """Comparison error against validation uncertainty (ASME V&V 20-2009 (R2021), 1-5 and 6-3).

    Where the parameters were fitted to the same measurement, E is no validation: judge on other
    data, and say so.

    Args:
        simulated: simulated value S.
        measured: measured value D.
        u_num: standard uncertainty from the numerical solution; ``None`` where unknown.
        u_input: standard uncertainty from the parameters.
        u_data: standard uncertainty of the measurement.
    """
    parts = {"u_num": u_num, "u_input": u_input, "u_data": u_data}
    bad = [f"{name} is {part}; it must be zero or more" for name, part in parts.items()
           if part is not None and not part >= 0]  # fmt: skip
    if bad:
        raise InputError("V&V 20", bad)
    error, u_val = simulated - measured, math.hypot(*(part or 0.0 for part in parts.values()))
    comparison = VV20(simulated, measured, u_num, u_input, u_data, error, u_val, None, None, None)
    if None in parts.values() or u_val == 0:
        return comparison
    return replace(
        comparison,
        e_n=e_n(simulated, measured, COVERAGE_FACTOR * u_val, 0.0),
        zeta=zeta(simulated, measured, u_val, 0.0),
        within_noise=abs(error) <= COVERAGE_FACTOR * u_val,
    )
