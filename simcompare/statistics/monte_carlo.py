"""Propagation of distributions by Monte Carlo (JCGM 101:2008)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.budget import Budget
from simcompare.statistics.distributions import Distribution
from simcompare.statistics.joint import Correlation, joint

#: values of the inputs by name, each an array -> values of the result
Model = Callable[..., Array]

#: trials of one block (JCGM 101:2008, 7.9.4 b)
BLOCK = 10_000
#: blocks before an adaptive run may end: two alone agree by chance too often
LEAST_BLOCKS = 10
#: trials after which an adaptive run gives up
MOST_TRIALS = 5_000_000
#: trials that can be asked for: more fill the memory and tell nothing new
MAX_TRIALS = 10_000_000
#: beyond it too few trials lie outside an interval to tell its ends
MAX_PROBABILITY = 0.99999
#: relative width below which results differ by rounding alone
_ROUNDING = 1e-12
#: bars of the stored histogram
_BARS = 120


@dataclass(frozen=True)
class MonteCarlo:
    """What is known of a result, from many draws of its inputs.

    Attributes:
        estimate: mean of the trials.
        u: their standard deviation, the standard uncertainty.
        probability: that of both intervals.
        shortest: the shortest interval that holds that share of the trials.
        symmetric: the interval with as many trials below it as above it.
        trials: how many there were.
        tolerance: half a unit in the last of u's significant digits (JCGM 101:2008, 7.9.2).
        stable: whether estimate, u and the ends of the symmetric interval repeat within that
            (JCGM 101:2008, 7.9.4).
        repeats_to: standard deviations of the ends of the symmetric interval over other draws.
        edges: of the histogram's bars, one more than bars.
        density: heights of the bars; with what lies outside, their area is 1.
    """

    estimate: float
    u: float
    probability: float
    shortest: tuple[float, float]
    symmetric: tuple[float, float]
    trials: int
    tolerance: float
    stable: bool
    repeats_to: tuple[float, float]
    edges: tuple[float, ...]
    density: tuple[float, ...]


def propagate(
    model: Model,
    inputs: Mapping[str, Distribution],
    *,
    seed: int,
    trials: int | None = None,
    probability: float = 0.95,
    correlation: Correlation | None = None,
    digits: int = 2,
) -> MonteCarlo:
    """Draws the inputs, asks the model, and tells how its results are distributed.

    ::

        propagate(lambda a, b: a + b, {"a": normal(0, 1), "b": rectangular(-1, 1)}, seed=1)

    Args:
        model: called with one array for each input, by name; returns one array.
        inputs: what is known of each.
        seed: of the draws, 0 or more; each input has its own stream.
        trials: how many; ``None`` for as many as make the answer stable.
        probability: that the coverage intervals hold the value.
        correlation: pairs of names -> coefficient; others are independent.
        digits: significant digits of u that are meant to hold, 1 or 2.

    Raises:
        InputError: an impossible correlation or probability, too few trials, or a model that gives
            no finite number for some draws.
    """
    _check(trials, probability)
    size = max(BLOCK, math.ceil(100 / (1 - probability)))
    values: list[Array] = []
    told: list[tuple[float, ...]] = []
    left = MOST_TRIALS if trials is None else trials
    blocks = joint(inputs, correlation).blocks(seed, min(size, left))
    while left > 0 and not (trials is None and _is_stable(told, LEAST_BLOCKS, digits)):
        count = min(size, left)
        drawn = {name: each[:count] for name, each in next(blocks).items()}
        values.append(_results(model, drawn, count))
        if count == size:
            told.append(_summary(values[-1], probability))
        left -= count
    return _told(np.concatenate(values), probability, digits, _is_stable(told, 2, digits))


def numerical_tolerance(u: float, digits: int = 2) -> float:
    """Half a unit in the last of so many significant digits of u (JCGM 101:2008, 7.9.2)."""
    if not 0 < u < math.inf:
        return 0.0
    exponent = math.floor(math.log10(u)) - digits + 1
    if round(u / 10.0**exponent) == 10**digits:  # 0.0996 is 0.10
        exponent += 1
    return 0.5 * 10.0**exponent


@dataclass(frozen=True)
class Validation:
    """A first-order interval held against that of Monte Carlo (JCGM 101:2008, 8.1).

    Attributes:
        low: distance of the lower ends, d_low.
        high: distance of the upper ends, d_high.
        tolerance: δ, the largest distance with which the first order is validated.
        noise: twice the standard deviation of the ends of Monte Carlo: so far they may be off.
    """

    low: float
    high: float
    tolerance: float
    noise: float

    @property
    def passed(self) -> bool:
        """Whether the two agree within δ, as far as so many trials can tell."""
        return max(self.low, self.high) <= self.tolerance + self.noise


def validation(first: Budget, against: MonteCarlo, *, digits: int = 2) -> Validation:
    """Holds estimate ± U of first order against the symmetric interval of Monte Carlo.

    Args:
        first: the budget; its U has the probability of the trials' intervals.
        against: what Monte Carlo says.
        digits: significant digits of u that are regarded as meaningful, 1 or 2.
    """
    low, high = (
        abs(ours - theirs) for ours, theirs in zip(first.interval, against.symmetric, strict=True)
    )
    tolerance = numerical_tolerance(first.u or against.u, digits)
    return Validation(low, high, tolerance, 2 * max(against.repeats_to))


def fault_of(trials: int | None, probability: float, most: int = MAX_TRIALS) -> str:
    """What is wrong with a number of trials or a probability; empty where nothing is.

    Args:
        trials: that are asked for; ``None`` for as many as are needed.
        probability: of the intervals.
        most: trials that are affordable.
    """
    if not 0 < probability <= MAX_PROBABILITY:
        return (
            f"probability {probability:.15g} is out of range; "
            f"expected more than 0 and at most {MAX_PROBABILITY:g}"
        )
    least = math.ceil(2 / (1 - probability))
    if trials is None or least <= trials <= most:
        return ""
    if trials < least:
        return (
            f"{trials} trials cannot tell an interval of {100 * probability:g} %; "
            f"expected at least {least}"
        )
    return f"{trials} trials are too many; expected at most {most}"


def _check(trials: int | None, probability: float) -> None:
    fault = fault_of(trials, probability)
    if fault:
        raise InputError("Monte Carlo", [fault])


def _results(model: Model, drawn: Mapping[str, Array], count: int) -> Array:
    """What the model says of one block.

    Raises:
        InputError: some results are no finite numbers.
    """
    with np.errstate(all="ignore"):
        values = np.broadcast_to(np.asarray(model(**drawn), dtype=float), (count,))
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        at = ", ".join(f"{name} = {each[bad[0]]:.6g}" for name, each in drawn.items())
        raise InputError(
            "Monte Carlo",
            [
                f"{len(bad)} of {count} draws give no finite number, such as {at}; "
                "make the inputs' uncertainties smaller or bound their distributions"
            ],
        )
    return values


def _summary(values: Array, probability: float) -> tuple[float, float, float, float]:
    low, high = _symmetric(np.sort(values), probability)
    return float(values.mean()), _sd(values), low, high


def _sd(values: Array) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else 0.0


def _is_stable(told: list[tuple[float, ...]], least: int, digits: int) -> bool:
    """Whether twice each mean's standard deviation is below the tolerance of u (7.9.4 g to k)."""
    if len(told) < least:
        return False
    each = np.array(told)
    # u of all trials, from those of the blocks and of their means
    u = math.sqrt(float(np.mean(each[:, 1] ** 2) + np.var(each[:, 0])))
    spread = each.std(axis=0, ddof=1) / math.sqrt(len(each))
    return bool(np.all(2 * spread <= numerical_tolerance(u, digits)))


def _told(values: Array, probability: float, digits: int, stable: bool) -> MonteCarlo:
    ordered = np.sort(values)
    u = _sd(values)
    edges, density = _histogram(ordered)
    return MonteCarlo(
        float(values.mean()), u, probability, _shortest(ordered, probability),
        _symmetric(ordered, probability), len(values), numerical_tolerance(u, digits), stable,
        _repeat_to(ordered, probability), edges, density,
    )  # fmt: skip


def _held(count: int, probability: float) -> int:
    """How many steps of the ordered values an interval spans (JCGM 101:2008, 7.7.1)."""
    return min(count - 1, math.floor(probability * count + 0.5))


def _symmetric(ordered: Array, probability: float) -> tuple[float, float]:
    held = _held(len(ordered), probability)
    first = min((len(ordered) - held) // 2, len(ordered) - 1 - held)
    return float(ordered[first]), float(ordered[first + held])


def _repeat_to(ordered: Array, probability: float) -> tuple[float, float]:
    """From the ranks that an end of the interval may have, one standard deviation to both sides."""
    count, tail = len(ordered), (1 - probability) / 2
    ranks = math.sqrt(count * tail * (1 - tail))
    ends = []
    for part in (tail, 1 - tail):
        beside = np.clip([part * count - ranks, part * count + ranks], 0, count - 1).round()
        low, high = ordered[beside.astype(int)]
        ends.append(float(high - low) / 2)
    return ends[0], ends[1]


def _shortest(ordered: Array, probability: float) -> tuple[float, float]:
    held = _held(len(ordered), probability)
    first = int(np.argmin(ordered[held:] - ordered[: len(ordered) - held]))
    return float(ordered[first]), float(ordered[first + held])


def _histogram(ordered: Array) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Between the values that leave out a thousandth: far ends would flatten all bars."""
    ends = np.quantile(ordered, [0.0005, 0.9995])
    if not ends[1] - ends[0] > _ROUNDING * np.abs(ends).max():
        return (), ()
    bars = min(_BARS, round(2 * len(ordered) ** (1 / 3)))  # by Rice's rule
    counts, edges = np.histogram(ordered, bins=bars, range=(float(ends[0]), float(ends[1])))
    density = counts / len(ordered) / np.diff(edges)
    return tuple(edges.tolist()), tuple(density.tolist())
