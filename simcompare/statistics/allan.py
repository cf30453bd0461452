"""Allan deviation and its kin: how the noise of a record changes with the time it is averaged.

Definitions are those of W. J. Riley, Handbook of Frequency Stability Analysis, NIST SP 1065 (2008).
"Frequency" there is any rate here, such as the reading of a gyroscope or an accelerometer, and
"phase" its integral over time, with one value more than there are rates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.errors import InputError
from simcompare.model.trajectory import Array

#: plain, overlapping, modified, time, Hadamard, overlapping Hadamard and total deviation
Kind = Literal["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]
KINDS: tuple[Kind, ...] = ("adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev")
#: phases that one difference reaches over, in units of the averaging factor
_REACH = {"adev": 2, "oadev": 2, "mdev": 3, "tdev": 3, "hdev": 3, "ohdev": 3, "totdev": 1}


@dataclass(frozen=True, eq=False)
class Deviations:
    """A deviation over averaging times.

    Attributes:
        kind: which deviation.
        tau_s: averaging times (n,).
        m: the same in samples (n,).
        values: deviations (n,), in the unit of the rate; of "tdev" that of the phase.
        count: number of differences behind each value (n,).
        samples: number of rates in the record.
    """

    kind: Kind
    tau_s: Array
    m: NDArray[np.int64]
    values: Array
    count: NDArray[np.int64]
    samples: int


def phase_of(rates: ArrayLike, interval_s: float = 1.0) -> Array:
    """Integral of rates over time, from 0 (n+1,).

    The mean rate is taken off first; it is in none of the deviations, and digits are kept.

    Raises:
        InputError: a value that is missing or not finite.
    """
    y = _finite(rates)
    total = np.empty(len(y) + 1)
    total[0] = 0.0
    np.cumsum(y - y.mean(), out=total[1:])
    total *= interval_s
    return total


def octaves(samples: int, kind: Kind = "oadev") -> list[int]:
    """Averaging factors 1, 2, 4, … as far as a record of so many rates gives a difference."""
    return [2**i for i in range(samples.bit_length()) if _room(samples + 1, 2**i, kind) >= 1]


def deviations(
    rates: ArrayLike,
    rate_Hz: float = 1.0,
    kind: Kind = "oadev",
    m: Sequence[int] | None = None,
) -> Deviations:
    """A deviation of a record of rates at averaging factors.

    Args:
        rates: evenly spaced readings (n,).
        rate_Hz: how many there are in a second.
        kind: which deviation.
        m: averaging factors, in samples; octaves if left out.

    Raises:
        InputError: values that are missing, or a record that is too short.
    """
    return of_phase(phase_of(rates, 1 / rate_Hz), 1 / rate_Hz, kind, m)


def of_phase(
    phase: ArrayLike,
    interval_s: float = 1.0,
    kind: Kind = "oadev",
    m: Sequence[int] | None = None,
) -> Deviations:
    """A deviation of a record of phases; see :func:`deviations`."""
    x = _finite(phase)
    factors = _factors(len(x), kind, m)
    found = [_variance(x, factor, kind) for factor in factors]
    values = np.sqrt([value for value, _ in found])
    tau = np.array(factors) * interval_s
    values *= 1 / np.sqrt(3) if kind == "tdev" else 1 / tau
    count = np.array([n for _, n in found], dtype=np.int64)
    return Deviations(
        kind, tau, np.array(factors, dtype=np.int64), values, count, len(x) - 1
    )  # fmt: skip


def _factors(phases: int, kind: Kind, m: Sequence[int] | None) -> Sequence[int]:
    factors = octaves(phases - 1, kind) if m is None else [int(one) for one in m]
    wrong = [one for one in factors if one < 1 or _room(phases, one, kind) < 1]
    if wrong or not factors:
        least = (wrong or [1])[0]
        raise InputError(kind, [f"no difference over {least} readings fits into {phases - 1}"])
    return factors


def _room(phases: int, m: int, kind: Kind) -> int:
    """Number of overlapping differences."""
    if kind == "totdev":
        return phases - 2 if m <= phases - 1 else 0
    return phases - _REACH[kind] * m + (1 if kind in ("mdev", "tdev") else 0)


def _variance(x: Array, m: int, kind: Kind) -> tuple[float, int]:
    """Variance times the square of the averaging time, and the number of differences."""
    if kind == "totdev":
        return _total(x, m)
    if kind in ("mdev", "tdev"):
        return _modified(x, m)
    stride = m if kind in ("adev", "hdev") else 1
    if kind in ("hdev", "ohdev"):
        thirds = x[3 * m :: stride] - 3 * x[2 * m : -m : stride]
        thirds += 3 * x[m : -2 * m : stride] - x[: -3 * m : stride]
        return _mean_square(thirds) / 6, len(thirds)
    seconds = x[2 * m :: stride] - 2 * x[m:-m:stride] + x[: -2 * m : stride]
    return _mean_square(seconds) / 2, len(seconds)


def _modified(x: Array, m: int) -> tuple[float, int]:
    """Second differences of phases that are averaged over m, by sums from the start."""
    sums = np.concatenate(([0.0], np.cumsum(x - x.mean())))
    means = (sums[m:] - sums[:-m]) / m
    seconds = means[2 * m :] - 2 * means[m:-m] + means[: -2 * m]
    return _mean_square(seconds) / 2, len(seconds)


def _total(x: Array, m: int) -> tuple[float, int]:
    """Second differences of a record that is turned about both of its ends (SP 1065, 5.2.11)."""
    before, after = 2 * x[0] - x[m - 1 : 0 : -1], 2 * x[-1] - x[-2 : -m - 1 : -1]
    long = np.concatenate((before, x, after))
    seconds = long[2 * m :] - 2 * long[m:-m] + long[: -2 * m]
    return _mean_square(seconds) / 2, len(seconds)


def _mean_square(values: Array) -> float:
    return float(values @ values) / len(values)


def _finite(values: ArrayLike) -> Array:
    y = np.asarray(values, dtype=float)
    if y.ndim != 1:
        raise InputError("values", [f"have {y.ndim} dimensions; give one axis at a time"])
    missing = len(y) - int(np.isfinite(y).sum())
    if missing:
        cure = "cut the record into stretches without gaps"
        raise InputError("values", [f"{missing} of {len(y)} are missing or not finite; {cure}"])
    if len(y) < 3:
        raise InputError("values", [f"only {len(y)}; expected 3 or more"])
    return y
