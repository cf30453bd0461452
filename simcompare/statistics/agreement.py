"""Scores of single values: E_n and zeta, agreement of several, V&V 20, and the grid's error."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.grid_convergence import Gci, gci

__all__ = [
    "MAD_TO_SD",
    "Birge",
    "Gci",
    "Mean",
    "VV20",
    "birge_ratio",
    "e_n",
    "gci",
    "vv20",
    "weighted_mean",
    "zeta",
]

#: a sample's median absolute deviation times this is the standard deviation of normal noise
MAD_TO_SD = 1.482602218505602


def e_n(x: float, X: float, U_x: float, U_X: float, covariance: float = 0.0) -> float | None:
    """E_n number (x - X)/√(U_x² + U_X²); satisfactory for |E_n| ≤ 1 (ISO 13528:2022, 9.7).

    Args:
        x: the value.
        X: what it is held against.
        U_x: expanded uncertainty (k = 2) of x.
        U_X: expanded uncertainty (k = 2) of X.
        covariance: covariance of x and X (of standard size, not expanded), where both rest on the
            same data.

    Returns:
        The number, or ``None`` where neither has an uncertainty: then it cannot be judged.
    """
    return _over_root(x - X, (U_x, U_X), 4 * covariance, "E_n")


def zeta(x: float, X: float, u_x: float, u_X: float, covariance: float = 0.0) -> float | None:
    """Zeta score (x - X)/√(u_x² + u_X² - 2·cov); 2 warns, 3 acts (ISO 13528:2022, 9.6).

    Args:
        x: the value.
        X: what it is held against.
        u_x: standard uncertainty of x.
        u_X: standard uncertainty of X.
        covariance: covariance of x and X, where both rest on the same data.

    Returns:
        The score, or ``None`` where neither has an uncertainty: then it cannot be judged.
    """
    return _over_root(x - X, (u_x, u_X), covariance, "zeta")


def _over_root(
    difference: float, parts: tuple[float, float], covariance: float, where: str
) -> float | None:
    for part in parts:
        if not part >= 0:
            raise InputError(where, [f"an uncertainty is {part}; it must be zero or more"])
    size = math.hypot(*parts)
    left = size**2 - 2 * covariance
    if left < -1e-12 * size**2:
        text = f"the covariance {covariance:g} is greater than both uncertainties allow"
        raise InputError(where, [text])
    if left <= 1e-12 * size**2:
        return None
    return difference / (size if covariance == 0 else math.sqrt(left))


@dataclass(frozen=True)
class Mean:
    """A weighted mean.

    Attributes:
        value: the mean.
        u: its standard uncertainty, from the uncertainties that went in.
    """

    value: float
    u: float


def weighted_mean(values: ArrayLike, u: ArrayLike) -> Mean:
    """Mean with weights 1/u² (ISO 13528:2022, 7.7; JCGM 100:2008, H.5 for independent values).

    Args:
        values: the values (n,).
        u: their standard uncertainties (n,), all positive.
    """
    x, each = _values_and_u(values, u)
    # relative weights, so that very small uncertainties do not overflow
    weight = (each.min() / each) ** 2
    first = float(x[0])
    value = first + float(np.sum(weight * (x - first)) / np.sum(weight))
    return Mean(value, float(each.min() / math.sqrt(np.sum(weight))))


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

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self)


def birge_ratio(values: ArrayLike, u: ArrayLike) -> Birge:
    """Birge ratio and the χ² test at 95 % of n values with standard uncertainties.

    R. T. Birge, Phys. Rev. 40 (1932) 207; consistency as in M. G. Cox, Metrologia 39 (2002) 589,
    procedure A.

    Args:
        values: the values (n,), two or more.
        u: their standard uncertainties (n,), all positive.
    """
    from scipy import stats

    x, each = _values_and_u(values, u)
    if len(x) < 2:
        raise InputError("Birge ratio", ["one value alone agrees with nothing; give two or more"])
    mean, free = weighted_mean(x, each), len(x) - 1
    chi2 = float(np.sum(((x - mean.value) / each) ** 2))
    limit = float(stats.chi2.ppf(0.95, free))
    half = 1 / math.sqrt(2 * free)
    ratio = math.sqrt(chi2 / free)
    return Birge(len(x), mean.value, mean.u, ratio, 1 - half, 1 + half, chi2, limit, chi2 <= limit)


def _values_and_u(values: ArrayLike, u: ArrayLike) -> tuple[Array, Array]:
    x = np.asarray(values, dtype=float).ravel()
    each = np.broadcast_to(np.asarray(u, dtype=float), x.shape)
    if not len(x) or not np.all(np.isfinite(x)):
        raise InputError("values", [f"{len(x)} values, of which some are missing; leave them out"])
    if not np.all(np.isfinite(each) & (each > 0)):
        raise InputError("values", ["every value needs a standard uncertainty greater than zero"])
    return x, each


@dataclass(frozen=True)
class VV20:
    """Comparison error and validation uncertainty.

    Attributes:
        error: comparison error E = simulated - measured.
        u_num: standard uncertainty from the numerical solution.
        u_input: standard uncertainty from the parameters.
        u_data: standard uncertainty of the measurement.
        u_val: validation standard uncertainty √(u_num² + u_input² + u_data²).
        k: coverage factor.
        low: lower end of the interval of the model's error, E - k·u_val.
        high: upper end, E + k·u_val.
        within_noise: |E| ≤ k·u_val: the model's error is within the noise level. That is not the
            same as "validated": it says what cannot be seen.
    """

    error: float
    u_num: float
    u_input: float
    u_data: float
    u_val: float
    k: float
    low: float
    high: float
    within_noise: bool

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self)


def vv20(
    simulated: float,
    measured: float,
    u_num: float,
    u_input: float,
    u_data: float,
    k: float = 2.0,
) -> VV20:
    """Comparison error against validation uncertainty (ASME V&V 20-2009 (R2021), 1-5 and 6-3).

    Where the parameters were fitted to the same measurement, E is no validation: judge on other
    data, and say so with :mod:`simcompare.validation.words`.

    Args:
        simulated: simulated value S.
        measured: measured value D.
        u_num: standard uncertainty from the numerical solution.
        u_input: standard uncertainty from the parameters.
        u_data: standard uncertainty of the measurement.
        k: coverage factor.
    """
    parts = {"u_num": u_num, "u_input": u_input, "u_data": u_data}
    bad = [f"{name} is {part}; it must be zero or more" for name, part in parts.items()
           if not part >= 0]  # fmt: skip
    if bad:
        raise InputError("V&V 20", bad)
    error, u_val = simulated - measured, math.hypot(u_num, u_input, u_data)
    low, high = error - k * u_val, error + k * u_val
    return VV20(error, u_num, u_input, u_data, u_val, k, low, high, abs(error) <= k * u_val)
