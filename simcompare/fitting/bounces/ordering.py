"""Which impact is which: flights that last twice as long, and knocks within a flight.

The best numberings that two flights propose are refined with the closed form of a ball, and what
lies far off it is left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.fitting.bounces import likelihood
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.numberings import MISSED, REACH, one_each, proposals
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected

#: chance that an impact of the series is taken for an outlier, and that its scatter is told
_BY_CHANCE = 1e-3
#: the first of these where nothing but the series itself tells its scatter
_BY_ITSELF = 1e-4
#: scatter about the closed form, as part of a flight, above which the order is looked into
_ROUGH = 0.02
#: a pause between two drops lasts longer than so many of the longest flight, and than this [s]
_PAUSE, _PAUSE_S = 1.5, 1.0
#: smallest scatter that is believed where no uncertainty is stated [s]
_FINEST_S = 1e-5
#: largest factor between flights that a ball can have
_MAX_FACTOR = 0.9999
#: an impact that others of known scatter contradict is off by this part of a flight or more
_MIN_OFF = 0.01
#: the same for the first and the last impact
_MIN_OFF_END = 0.08
#: part of a residual that its own impact does not fit away, at least
_LEVERAGE = 0.3
#: part of the impacts that must belong to the series, and how many at least: any three that are
#: picked out of more make some series
_ENOUGH, _MIN_IMPACTS = 0.6, 4


@dataclass(frozen=True)
class Ordered:
    """A series of bounces.

    Attributes:
        kept: indices of the impacts that belong to it.
        numbers: which impact each of them is, first is 1.
        dropped: the others, with the reason.
        missed: numbers that were not recorded.
    """

    kept: tuple[int, ...]
    numbers: tuple[int, ...]
    dropped: tuple[Rejected, ...]
    missed: tuple[int, ...]


@dataclass(frozen=True)
class _Fit:
    """Closed form through numbered impacts.

    Attributes:
        predicted: where every impact should be, by number.
        scatter: standard deviation of the impacts about it, and of their stated uncertainty.
        worst: the impact that is farthest off.
        is_off: whether that is more than chance.
    """

    predicted: Array
    scatter: float
    worst: int
    is_off: bool


def split(times_s: Array) -> list[slice]:
    """Drops after each other: after a pause the flights are long again."""
    steps = np.diff(times_s)
    starts = [0]
    for i in range(2, len(times_s) - 2):
        before = steps[starts[-1] : i - 1]
        if len(before) < 2:
            continue
        # the pause is longer than a missed impact makes a flight, and long flights follow it
        pause = steps[i - 1] > max(_PAUSE * before.max(), _PAUSE_S)
        if pause and steps[i] > 1.1 * np.median(before[-3:]) and steps[i + 1] < steps[i]:
            starts.append(i)
    return [slice(a, b) for a, b in zip(starts, [*starts[1:], len(times_s)], strict=True)]


def order(times_s: Array, u_s: Array, source: str = "", first: int = 0) -> Ordered:
    """Numbers the impacts of one drop.

    Args:
        times_s: in order (n,) [s].
        u_s: standard uncertainties, NaN where unknown (n,) [s].
        source: what is named in an error.
        first: number of impacts of earlier drops in the same recording.

    Raises:
        InputError: no series of bounces is in them.
    """
    count = len(times_s)
    numbers = np.arange(count)
    if count > 2 and not _smooth(times_s, u_s, numbers):
        numbers = _found(times_s, u_s, source)
    kept = np.flatnonzero(numbers >= 0)
    order_of = numbers[kept] - numbers[kept[0]] + 1
    missed = sorted(set(range(1, int(order_of[-1]) + 1)) - set(order_of.tolist()))
    dropped = _reasons(times_s, kept, order_of, first)
    return Ordered(tuple(kept.tolist()), tuple(order_of.tolist()), dropped, tuple(missed))


def _smooth(times: Array, u: Array, numbers: NDArray[np.int64]) -> bool:
    """Whether the impacts, numbered so, are those of a ball."""
    if len(times) == 3:
        first, second = np.diff(times)
        return bool(0.05 * first < second < first)
    fitted = _fit(times, u, numbers)
    rough = fitted.scatter > _ROUGH * float(np.median(np.diff(times)))
    return not rough and not fitted.is_off and _shrinks(times, numbers)


def _shrinks(times: Array, numbers: NDArray[np.int64]) -> bool:
    """Whether the last flight is shorter than the first one, as it is for a ball."""
    steps = np.diff(times) / np.diff(numbers)
    flights = (numbers[-1] + numbers[-2] - numbers[1] - numbers[0]) / 2
    return bool(steps[-1] < _MAX_FACTOR**flights * steps[0])


def _fit(times: Array, u: Array, numbers: NDArray[np.int64]) -> _Fit:
    """Restitution as a power of the speed, with drag; less of both for few impacts."""
    from scipy import stats

    model = "power+drag" if len(times) > 6 else "power" if len(times) > 4 else "constant"
    steps = numbers - int(numbers.min()) + 1
    each = np.where(np.isfinite(u), u, 1e-3)
    impacts = Impacts(times, each, tuple(steps.tolist()))
    predicted, jacobian = likelihood.shape(impacts, model, int(steps[-1]) + REACH)
    residual = (times - predicted[steps - 1]) / each
    chi2, degrees = float(residual @ residual), len(times) - jacobian.shape[1]
    stated = bool(np.isfinite(u).all())
    least = 0.0 if stated else (_FINEST_S / float(each[0])) ** 2
    scale = math.sqrt(max(chi2 / max(degrees, 1), least))
    scatter = float(np.median(each)) * (max(scale, 1.0) if stated else scale)
    fine = stated and stats.chi2.sf(chi2, max(degrees, 1)) > _BY_CHANCE
    if fine or degrees < 2:
        return _Fit(predicted, scatter, -1, False)
    # residuals as if each impact had been left out of the fit (externally studentised)
    q = np.linalg.qr(jacobian)[0]
    free = np.maximum(1 - np.sum(q * q, axis=1), 1e-9)
    rest = np.maximum(chi2 - residual**2 / free, 1e-12 * chi2)
    worst = int(np.argmin(rest))
    # at the ends leaving one out means to extrapolate a form that is not exact
    at_end = worst in (0, len(times) - 1)
    flight = float(predicted[steps[worst]] - predicted[steps[worst] - 1])
    off = abs(residual[worst]) / free[worst] * each[worst]
    if off < (_MIN_OFF_END if at_end else _MIN_OFF) * flight or free[worst] < _LEVERAGE:
        return _Fit(predicted, scatter, -1, False)
    blamed = stats.chi2.sf(rest[worst], degrees - 1) > _BY_CHANCE
    if stated and degrees > 2 and blamed:
        # all others agree within what is stated, so this one alone is to blame
        return _Fit(predicted, scatter, worst, True)
    scale = math.sqrt(max(rest[worst] / (degrees - 1), 1.0 if stated else least) * free[worst])
    limit = float(stats.t.isf(_BY_ITSELF / 2 / len(times), degrees - 1))
    return _Fit(predicted, scatter, worst, bool(abs(residual[worst]) > limit * scale))


def _found(times: Array, u: Array, source: str) -> NDArray[np.int64]:
    """Number of each impact, -1 for those that do not belong."""
    best, most = None, -math.inf
    for proposal in proposals(times):
        numbers, score = _refined(times, u, proposal)
        if score > most:
            best, most = numbers, score
    kept = 0 if best is None else int(np.count_nonzero(best >= 0))
    if best is None or kept < max(_MIN_IMPACTS, _ENOUGH * len(times)):
        raise InputError(source or "impacts", [_no_series(times, kept)])
    return best


def _no_series(times: Array, kept: int) -> str:
    flights = ", ".join(f"{step:.3g}" for step in np.diff(times)[:8])
    count = f"only {kept}" if kept > 2 else "no four"
    return (
        f"{count} of the {len(times)} impacts follow each other as those of a bouncing ball, whose"
        f" flights become shorter by a steady factor; found flights of {flights}"
        f"{', …' if len(times) > 9 else ''} s. Cut out the part with the bounces, or record again"
    )


def _refined(times: Array, u: Array, numbers: NDArray[np.int64]) -> tuple[NDArray[np.int64], float]:
    """The numbering by the closed form, without outliers, and how good it is."""
    for tolerance in (0.2, 0.12, 0.08, 0.08):
        kept = numbers >= 0
        if np.count_nonzero(kept) < 4:
            break
        fitted = _fit(times[kept], u[kept], numbers[kept])
        again = _assigned(times, fitted.predicted, tolerance)
        if np.array_equal(again, numbers):
            break
        numbers = again
    numbers, scatter = _without_outliers(times, u, numbers)
    kept = numbers >= 0
    if np.count_nonzero(kept) < 3:
        return numbers, -math.inf
    gaps = int(numbers.max()) + 1 - int(np.count_nonzero(kept))
    rough = scatter / float(np.median(np.diff(times[kept])))
    if rough > _ROUGH or not _shrinks(times[kept], numbers[kept]):
        return numbers, -math.inf
    return numbers, float(np.count_nonzero(kept)) - MISSED * gaps - 50 * min(rough, 0.1)


def _assigned(times: Array, predicted: Array, tolerance: float) -> NDArray[np.int64]:
    """Each impact to the place next to it, if that is near enough and nobody is nearer."""
    steps = np.diff(predicted, append=np.nan)
    steps[-1] = steps[-2]
    off = np.abs(times[:, None] - predicted) / steps
    nearest = np.argmin(off, axis=1)
    least = off[np.arange(len(times)), nearest]
    numbers = one_each(np.where(least <= tolerance, nearest, -1), -least)
    used = numbers[numbers >= 0]
    return np.where(numbers >= 0, numbers - used.min(), -1) if len(used) else numbers


def _without_outliers(
    times: Array, u: Array, numbers: NDArray[np.int64]
) -> tuple[NDArray[np.int64], float]:
    """Takes out, one by one, impacts that are far off where the others put them."""
    numbers = numbers.copy()
    scatter = 0.0
    for _ in range(max(1, len(times) // 5) + 1):
        kept = np.flatnonzero(numbers >= 0)
        if len(kept) < 4:
            return numbers, 0.05 * float(np.ptp(times)) / len(times)
        fitted = _fit(times[kept], u[kept], numbers[kept])
        scatter = fitted.scatter
        if not fitted.is_off:
            break
        numbers[kept[fitted.worst]] = -1
    return numbers, scatter


def _reasons(
    times: Array, kept: NDArray[np.intp], numbers: NDArray[np.int64], first: int
) -> tuple[Rejected, ...]:
    """Why each of the others was left out, in words."""
    found = []
    for k in sorted(set(range(len(times))) - set(kept.tolist())):
        at = int(np.searchsorted(kept, k))
        time = float(times[k])
        if at == 0:
            reason = "before the first bounce"
        elif at == len(kept):
            reason = "after the last bounce"
        else:
            before, after = float(times[kept[at - 1]]), float(times[kept[at]])
            part = (time - before) / (after - before)
            a, b = int(numbers[at - 1]), int(numbers[at])
            reason = (
                f"within a flight, {1e3 * (time - before):.1f} ms after impact {a} ({part:.0%})"
            )
            if b > a + 1:
                reason = f"between impacts {a} and {b}, not where a missing one would be"
        found.append(Rejected("impact", first + k + 1, time, reason))
    return tuple(found)
