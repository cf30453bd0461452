"""A mixture of noises that is fitted to the Allan or Hadamard variances of a record."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.statistics import allan
from simcompare.statistics import allan_covariance as cov

#: order of the differences of phase
ALLAN, HADAMARD = 2, 3
#: quantisation, white noise, bias instability, rate random walk
NAMES = ("Q", "N", "B", "K")
#: a noise is told as a number where twice the logarithm of the likelihood falls by more than this
#: without it, and a ramp where it is the root of this from 0, in standard uncertainties
SEEN = 12.0
#: chance below which a fit does not describe the variances
_CHANCE = 1e-3
#: and from which on there is nothing more to explain
_WELL = 0.3
#: octaves of short averaging times that a filter may smooth, and that are kept at least
_MOST_SKIPPED, _LEAST_KEPT = 11, 6
#: correlation time in samples from which it is not that of a filter
_SLOW = 36.0
#: variance of white noise, as a part of that of a quickly forgetting one, below which it is no more
#: than the rounding of filtered readings
_ROUNDING = 0.04
#: by how much a Gauss-Markov noise must raise twice the logarithm of the likelihood
_WORTH = 15.0


@dataclass(frozen=True, eq=False)
class Fit:
    """Variances per sample of the noises that were kept.

    Attributes:
        observed: what was fitted.
        variances: of each noise that was kept.
        u: standard uncertainty of each.
        unlikelihood: minus twice the logarithm of the likelihood, but for a constant.
        chi_squared: of the observed variances.
        length: correlation time of the Gauss-Markov noise, in samples; NaN without one.
        u_length: its standard uncertainty.
    """

    observed: Observed
    variances: Mapping[str, float]
    u: Mapping[str, float]
    unlikelihood: float
    chi_squared: float
    length: float = math.nan
    u_length: float = math.nan

    @property
    def describes(self) -> bool:
        """Whether chi-squared is not larger than chance makes it once in a thousand records."""
        return self.chance > _CHANCE

    @property
    def chance(self) -> float:
        """Of a larger chi-squared, were the fit the truth."""
        from scipy import stats

        return float(stats.chi2.sf(self.chi_squared, self.degrees_of_freedom))

    @property
    def degrees_of_freedom(self) -> int:
        """Observed variances less what was fitted."""
        return len(self.observed.values) - len(self.variances) - (not math.isnan(self.length))

    def limit(self, name: str, rise: float) -> float:
        """The largest size of a noise that is not seen, by twice the fall of the log-likelihood.

        The other noises are fitted anew beside it.
        """
        names, seen = [*self.variances], self.observed

        def fall(logarithm: float) -> float:
            beside = _weighted(seen, names, {name: math.exp(logarithm)})
            return beside.unlikelihood - self.unlikelihood

        # the smallest size that could be seen at all: a thousandth of the lowest variance
        low = math.log(1e-3 * float((seen.values / seen.shapes[name]).min()))
        trials = low + np.arange(0.0, 40.0)
        first = next((k for k, one in enumerate(trials) if fall(one) > rise), len(trials) - 1)
        inside, outside = trials[max(0, first - 1)], trials[first]
        for _ in range(6):
            middle = (inside + outside) / 2
            inside, outside = (inside, middle) if fall(middle) > rise else (middle, outside)
        return math.exp(outside / 2)


@dataclass(frozen=True, eq=False)
class Observed:
    """Variances of a record at averaging factors, and what they are fitted by."""

    order: int
    values: Array
    factors: Array
    samples: int
    products: cov.Products
    shapes: Mapping[str, Array]

    def added(self, length: float) -> Observed:
        """With a Gauss-Markov noise of that correlation time in samples."""
        kernel = cov.gauss_markov(length)
        shape = cov.shape(kernel, self.factors, self.order)
        more = self.products.added("GM", kernel)
        return replace(self, products=more, shapes={**self.shapes, "GM": shape})


def fit_of(rates: Array, order: int) -> Fit:
    """The noises that are seen in a record; a Gauss-Markov noise where nothing else describes it.

    A filter in the sensor smooths what is faster than itself. So the shortest averaging times are
    left out, one octave after the other, until the noises describe the rest; where they never do,
    all are kept.
    """
    found = allan.deviations(rates, kind="oadev" if order == ALLAN else "ohdev")
    whole = _kept(_observed(found, order, 0), [*cov.kernels()])
    fit = whole if whole.describes else with_markov(whole)
    if fit.describes and not _is_filtered(fit):
        return fit
    most = min(_MOST_SKIPPED, len(found.m) - _LEAST_KEPT)
    later = [_kept(_observed(found, order, k), ["N", "B", "K"]) for k in range(1, most + 1)]
    # where a smoothing is no longer noticed it still is a tenth; two octaves on it is a fortieth
    good = [one for one in later if one.describes]
    good = good[2:] or good[-1:]
    settled = [one for one, next_ in itertools.pairwise(good) if _settled(one, next_)]
    return next(iter(settled or good[-1:]), whole)


def _is_filtered(fit: Fit) -> bool:
    """Whether its Gauss-Markov noise is white noise behind a filter of one pole: it is the same."""
    markov = fit.variances.get("GM", 0.0)
    return fit.length < _SLOW and fit.variances.get("N", 0.0) < _ROUNDING * markov


def _settled(fit: Fit, later: Fit) -> bool:
    """Whether one octave less changes the white noise by no more than chance does."""
    if not ("N" in fit.variances and "N" in later.variances):
        return True
    change = later.variances["N"] - fit.variances["N"]
    return change**2 < 4 * abs(later.u["N"] ** 2 - fit.u["N"] ** 2)


def _observed(found: allan.Deviations, order: int, skipped: int) -> Observed:
    factors = found.m[skipped:].astype(float)
    return Observed(
        order, found.values[skipped:] ** 2, factors, found.samples,
        _products(tuple(found.m[skipped:].tolist()), found.samples, order),
        {name: cov.shape(one, factors, order) for name, one in cov.kernels().items()},
    )  # fmt: skip


@functools.lru_cache(maxsize=32)
def _products(factors: tuple[int, ...], samples: int, order: int) -> cov.Products:
    """The same for all axes of a sensor."""
    return cov.products(list(factors), samples, cov.kernels(), order)


def _kept(observed: Observed, names: list[str]) -> Fit:
    """Leaves out the noise that is missed least, one after the other."""
    fit = _weighted(observed, names)
    while len(fit.variances) > 1:
        positive = [name for name, variance in fit.variances.items() if variance > 0]
        if len(positive) < len(fit.variances):
            fit = _weighted(observed, positive)
            continue
        without = [
            _weighted(observed, [one for one in fit.variances if one != name])
            for name in fit.variances
        ]
        best = min(without, key=lambda one: one.unlikelihood)
        if best.unlikelihood - fit.unlikelihood > SEEN:
            break
        fit = best
    return fit


def _weighted(
    observed: Observed, names: list[str], given: Mapping[str, float] | None = None
) -> Fit:
    """Least squares with the covariance of the fit itself, until it no longer changes.

    Args:
        observed: the variances.
        names: noises that are fitted.
        given: variances of noises that are held.
    """
    from scipy import optimize

    held = given or {}
    base = sum((size * observed.shapes[name] for name, size in held.items()), np.zeros(1))
    values = observed.values - base
    design = np.array([observed.shapes[name] for name in names]).T
    variances, _ = optimize.nnls(design / observed.values[:, None], values / observed.values)
    for _ in range(15):
        before = variances
        mixture = np.maximum(variances, 1e-9 * observed.values.min())
        size = {**held, **dict(zip(names, mixture.tolist(), strict=True))}
        covariance = observed.products.covariance(size)
        # of a few rows; SciPy's triangular solver takes ten times as long
        root = np.linalg.inv(np.linalg.cholesky(covariance))
        white = root @ np.column_stack((design, values))
        variances, _ = optimize.nnls(white[:, :-1], white[:, -1])
        if np.allclose(variances, before, rtol=1e-5, atol=0):
            break
    spread = np.linalg.pinv(white[:, :-1].T @ white[:, :-1])
    chi_squared, unlikelihood = _likelihood(observed.values, design @ variances + base, covariance)
    return Fit(
        observed, dict(zip(names, variances.tolist(), strict=True)),
        dict(zip(names, np.sqrt(np.diag(spread)).tolist(), strict=True)), unlikelihood, chi_squared,
    )  # fmt: skip


def _likelihood(values: Array, expected: Array, covariance: Array) -> tuple[float, float]:
    """Chi-squared of variances, and minus twice the logarithm of their likelihood.

    Variances of few degrees of freedom are skewed; their cube roots are hardly (E. B. Wilson and
    M. M. Hilferty, 1931).
    """
    part = 2 / 9 * np.diag(covariance) / (2 * expected**2)
    shrunk = expected ** (-2 / 3) / 3
    root = np.linalg.cholesky(covariance * np.outer(shrunk, shrunk))
    off = np.cbrt(values) - np.cbrt(expected) * (1 - part)
    left = np.linalg.solve(root, off)
    chi_squared = float(left @ left)
    return chi_squared, chi_squared + 2 * float(np.log(np.diag(root)).sum())


def with_markov(plain: Fit) -> Fit:
    """The fit with a Gauss-Markov noise, where the record is much likelier with it.

    Where it is only somewhat likelier, the record cannot tell: what the other fit makes of each
    noise is a part of the uncertainty.
    """
    observed = plain.observed
    if "GM" in plain.variances or len(observed.values) < 8 or plain.chance > _WELL:
        return plain
    best = _markov(observed, list(dict.fromkeys(["N", *plain.variances, "GM"])))
    if best is None or best.unlikelihood > plain.unlikelihood:
        return plain
    if plain.unlikelihood - best.unlikelihood > _WORTH:
        return best
    wider = {
        name: math.hypot(alone, best.variances.get(name, size) - size)
        for (name, alone), size in zip(plain.u.items(), plain.variances.values(), strict=True)
    }  # fmt: skip
    return replace(plain, u=wider)


def _markov(observed: Observed, names: list[str]) -> Fit | None:
    """The best fit with a Gauss-Markov noise whose peak lies within the averaging times."""
    from scipy import optimize

    low, high, step = math.log(2.0), math.log(observed.samples / 10), math.log(3.0)

    def fit_at(logarithm: float) -> Fit:
        length = math.exp(logarithm)
        return replace(_kept(observed.added(length), names), length=length)

    found = min((fit_at(one) for one in np.arange(low, high, step)), key=_worth)
    if "GM" not in found.variances:
        return None
    kept, centre = [*found.variances], math.log(found.length)

    def beside(logarithm: float) -> Fit:
        return _weighted(observed.added(math.exp(logarithm)), kept)

    best = float(optimize.minimize_scalar(
        lambda one: beside(one).unlikelihood, bounds=(centre - step, centre + step),
        method="bounded", options={"xatol": 0.01},
    ).x)  # fmt: skip
    fit = _kept(observed.added(math.exp(best)), kept)
    if not low <= best <= high or "GM" not in fit.variances:
        return None
    kept = [*fit.variances]
    return _with_length(fit, best, [beside(best - 0.1), beside(best + 0.1)])


def _with_length(fit: Fit, logarithm: float, sides: list[Fit]) -> Fit:
    """With the uncertainty of the correlation time, also in the size of each noise."""
    curvature = sum(_worth(side) - _worth(fit) for side in sides) / 0.1**2
    u = math.sqrt(2 / curvature) if curvature > 0 else math.nan
    low, high = (side.variances for side in sides)
    wider = {
        name: math.hypot(alone, (high[name] - low[name]) / 0.2 * u)
        for name, alone in fit.u.items()
    }  # fmt: skip
    length = math.exp(logarithm)
    return replace(fit, length=length, u_length=length * u, u=wider)


def _worth(fit: Fit) -> float:
    return fit.unlikelihood if "GM" in fit.variances else 1e9
