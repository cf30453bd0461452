"""Which impact is which: flights that last twice as long, and knocks within a flight.

Flights of a bouncing ball last ever shorter, by a factor that changes slowly. A series of three
impacts proposes that factor; how many of the others it explains, each at a whole number of
flights, tells how good the proposal is (M. A. Fischler and R. C. Bolles, Comm. ACM 24 (1981) 381).
The best one is refined with the closed form of a ball.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.fitting.impacts import Dropped, Impacts
from simcompare.trajectory import Array
from simcompare.validation.scores import MAD_TO_SD

#: an impact so many standard deviations off the others is none of the series
OUTLIER = 6.0
#: scatter about the closed form, as part of a flight, above which the order is looked into
_ROUGH = 0.02
#: a missed impact counts against a proposal as half an impact
_MISSED = 0.5
#: flights that a proposal may reach over when others knocked in between
_REACH = 4


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
    dropped: tuple[Dropped, ...]
    missed: tuple[int, ...]


@dataclass(frozen=True)
class _Fit:
    """Closed form through numbered impacts: where every impact should be."""

    predicted: Array
    scale: float

    def flight(self, numbers: NDArray[np.int64]) -> Array:
        """How long the flights about these impacts last."""
        steps = np.diff(self.predicted)
        return np.asarray(steps[np.clip(numbers - 1, 0, len(steps) - 1)])


def split(times_s: Array) -> list[slice]:
    """Drops after each other: after a pause the flights are long again."""
    steps = np.diff(times_s)
    starts = [0]
    for i in range(2, len(times_s) - 2):
        before = steps[starts[-1] : i - 1][-3:]
        if len(before) < 2:
            continue
        usual = float(np.median(before))
        if steps[i - 1] > 1.3 * usual and steps[i] > 1.1 * usual and steps[i + 1] < steps[i]:
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
    left = np.abs(times - fitted.predicted[numbers])
    limit = OUTLIER * fitted.scale
    rough = fitted.scale > _ROUGH * float(np.median(np.diff(times)))
    return not rough and bool(np.all(left <= limit))


def _fit(times: Array, u: Array, numbers: NDArray[np.int64]) -> _Fit:
    """Restitution as a power of the speed, which drag resembles; constant for few impacts."""
    from simcompare.fitting import likelihood

    model = "power" if len(times) > 4 else "constant"
    steps = numbers - int(numbers.min()) + 1
    each = np.where(np.isfinite(u), u, 1e-3)
    impacts = Impacts(times, each, tuple(steps.tolist()))
    predicted = likelihood.shape(impacts, model, int(steps[-1]) + 1 + _REACH)
    left = times - predicted[steps - 1]
    degrees = max(len(times) - (4 if model == "power" else 3), 1)
    made = MAD_TO_SD * float(np.median(np.abs(left))) * np.sqrt(len(times) / degrees)
    offset = int(numbers.min())
    shifted = np.concatenate((np.full(offset, np.nan), predicted))
    return _Fit(shifted, max(float(np.median(each)) if np.isfinite(u).all() else 1e-5, made))


def _found(times: Array, u: Array, source: str) -> NDArray[np.int64]:
    """Number of each impact, -1 for those that do not belong."""
    numbers = _proposed(times)
    if numbers is None:
        raise InputError(source or "impacts", [_no_series(times)])
    for tolerance in (0.25, 0.15, 0.1, 0.1):
        kept = numbers >= 0
        if np.count_nonzero(kept) < 4:
            break
        fitted = _fit(times[kept], u[kept], numbers[kept] - numbers[kept].min())
        again = _assigned(times, fitted, tolerance)
        if np.array_equal(again, numbers):
            break
        numbers = again
    numbers = _without_outliers(times, u, numbers)
    left = int(np.count_nonzero(numbers >= 0))
    if left < 3 or left < len(times) / 2:
        raise InputError(source or "impacts", [_no_series(times, left)])
    return numbers


def _no_series(times: Array, left: int = 0) -> str:
    flights = ", ".join(f"{step:.3g}" for step in np.diff(times)[:8])
    count = f"only {left} of" if left else "no three of"
    return (
        f"{count} the {len(times)} impacts follow each other as those of a bouncing ball, whose"
        f" flights become shorter by a steady factor; found flights of {flights}"
        f"{', …' if len(times) > 9 else ''} s. Cut out the part with the bounces, or record again"
    )


def _proposed(times: Array) -> NDArray[np.int64] | None:
    """The numbering by the three impacts that explain most of the others."""
    best, most = None, 0.0
    for i in range(len(times) - 2):
        for j in range(i + 1, min(i + _REACH, len(times) - 1)):
            for k in range(j + 1, min(j + _REACH, len(times))):
                flight = times[j] - times[i]
                e = (times[k] - times[j]) / flight
                if 0.1 < e < 0.99:
                    numbers, score = _explained(times, times[i], flight, float(e))
                    if score > most:
                        best, most = numbers, score
    return best


def _explained(
    times: Array, start: float, flight: float, e: float
) -> tuple[NDArray[np.int64], float]:
    """Whole numbers of flights from ``start``, and how well they fit."""
    left = 1 - (times - start) * (1 - e) / flight
    flights = np.where(left > 0, np.log(np.maximum(left, 1e-12)) / np.log(e), np.inf)
    whole = np.round(np.clip(flights, -50, 50))
    # the factor changes slowly: farther away less is known
    tolerance = np.minimum(0.08 + 0.04 * np.abs(whole - 1), 0.3)
    worth = np.maximum(0.0, 1 - ((flights - whole) / tolerance) ** 2)
    worth = np.where(np.isfinite(flights), worth, 0.0)
    numbers = np.where(worth > 0, whole, -99).astype(np.int64)
    for number in np.unique(numbers):
        same = np.flatnonzero(numbers == number)
        if number > -99 and len(same) > 1:
            lose = same[same != same[np.argmax(worth[same])]]
            numbers[lose], worth[lose] = -99, 0.0
    used = numbers[numbers > -99]
    gaps = int(np.ptp(used)) + 1 - len(used)
    result = np.where(numbers > -99, numbers - used.min(), -1)
    return result, float(worth.sum()) - _MISSED * gaps


def _assigned(times: Array, fitted: _Fit, tolerance: float) -> NDArray[np.int64]:
    """Each impact to the place next to it, if that is near enough and nobody is nearer."""
    distance = np.abs(times[:, None] - fitted.predicted[None, :])
    nearest = np.nanargmin(distance, axis=1)
    off = distance[np.arange(len(times)), nearest]
    near = off <= tolerance * fitted.flight(nearest)
    numbers = np.where(near, nearest, -1)
    for number in np.unique(numbers[numbers >= 0]):
        same = np.flatnonzero(numbers == number)
        numbers[same[same != same[np.argmin(off[same])]]] = -1
    return numbers


def _without_outliers(times: Array, u: Array, numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    """Takes out, one by one, impacts that are far off where the others put them."""
    numbers = numbers.copy()
    for _ in range(max(1, len(times) // 5)):
        kept = np.flatnonzero(numbers >= 0)
        if len(kept) < 6:
            break
        fitted = _fit(times[kept], u[kept], numbers[kept] - numbers[kept].min())
        left = np.abs(times[kept] - fitted.predicted[numbers[kept] - numbers[kept].min()])
        worst = int(np.argmax(left))
        if left[worst] <= OUTLIER * fitted.scale:
            break
        numbers[kept[worst]] = -1
    return numbers


def _reasons(
    times: Array, kept: NDArray[np.intp], numbers: NDArray[np.int64], first: int
) -> tuple[Dropped, ...]:
    """Why each of the others was left out, in words."""
    found = []
    for k in sorted(set(range(len(times))) - set(kept.tolist())):
        at = int(np.searchsorted(kept, k))
        time = float(times[k])
        if at == 0:
            reason = "it comes before the series of bounces"
        elif at == len(kept):
            reason = "it comes after the series of bounces and does not continue it"
        else:
            before, after = float(times[kept[at - 1]]), float(times[kept[at]])
            part = (time - before) / (after - before)
            a, b = int(numbers[at - 1]), int(numbers[at])
            where = f"within the flight from impact {a} to {b}" if b == a + 1 else (
                f"between impacts {a} and {b}, and not where one of the missing would be")  # fmt: skip
            reason = f"it is {where}, {1e3 * (time - before):.1f} ms ({part:.0%}) into it"
        found.append(Dropped("impact", first + k + 1, time, reason))
    return tuple(found)
