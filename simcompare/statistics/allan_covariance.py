"""Covariance of Allan variances at several averaging times, for a mixture of noises.

Overlapping Allan (and Hadamard) variances are quadratic forms of one record: neighbouring ones use
the same samples and are far from independent. For Gaussian noise their covariance follows from that
of the differences of phase, E[D_i D_j], which is a sum over the noises: so it is prepared once for
each pair of noises, and that of any mixture is a weighted sum. Not every lag is summed, and noises
of the rate count as uncorrelated at averaging times that are more than 4096-fold apart.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from simcompare.model.trajectory import Array

#: generalised covariance of phase over lags in samples, for a variance of 1 per sample
Kernel = Callable[[Array], Array]
#: the kernel of white phase, which is 1 at lag 0 alone
WHITE_PHASE = "Q"
_STEPS, _FAR, _FARTHEST, _BEYOND = 8, 30, 4096, 2
#: order of a difference of phase -> its weights, and by what its square is divided
_WEIGHTS = {2: (1.0, -2.0, 1.0), 3: (-1.0, 3.0, -3.0, 1.0)}
_DIVISORS = {2: 2, 3: 6}


def kernels() -> dict[str, Kernel | None]:
    """Of samples of white phase, white, flicker and random-walk rates."""
    return {WHITE_PHASE: None, "N": _white, "B": _flicker, "K": _walk}


def _white(t: Array) -> Array:
    return np.asarray(-np.abs(t) / 2)


def _flicker(t: Array) -> Array:
    """Of white noise that is summed up half (N. J. Kasdin and T. Walter, 1992)."""
    from scipy import special

    return np.asarray((t * t - 0.25) * special.digamma(np.abs(t) + 0.5) / (2 * np.pi))


def _walk(t: Array) -> Array:
    size = np.abs(t)
    return np.asarray((size**3 - size) / 12)


def gauss_markov(length: float) -> Kernel:
    """Of a first-order Gauss-Markov rate of that correlation time in samples."""
    fall = -1 / length
    left = -np.expm1(fall)  # 1 - φ
    slope, bend = (2 - left) / (2 * left), (1 - left) / left**2
    return lambda t: -slope * np.abs(t) - bend * np.expm1(fall * np.abs(t))


def shape(kernel: Kernel | None, factors: Array, order: int = 2) -> Array:
    """Allan variances of such a noise (n,), or of order 3 its Hadamard variances."""
    m = np.asarray(factors, dtype=float)
    weights = np.convolve(_WEIGHTS[order], _WEIGHTS[order][::-1])
    if kernel is None:
        return np.asarray(weights[order] / (_DIVISORS[order] * m**2))
    square = sum(
        weight * kernel(np.atleast_1d((k - order) * m)) for k, weight in enumerate(weights)
    )  # fmt: skip
    return np.asarray(square / (_DIVISORS[order] * m**2))


@dataclass(frozen=True, eq=False)
class Products:
    """What the covariance of any mixture is made of; made by :func:`products`.

    Attributes:
        names: the noises.
        parts: means of products (noises, noises, n, n) at n averaging factors.
        pairs: differences over each pair of averaging factors.
    """

    names: tuple[str, ...]
    parts: Array
    pairs: Mapping[tuple[int, int], _Pair]

    def covariance(self, variances: Mapping[str, float]) -> Array:
        """Covariance of the Allan variances (n, n) for that variance of each noise per sample."""
        size = np.array([variances.get(name, 0.0) for name in self.names])
        found = np.tensordot(size, np.tensordot(size, self.parts, 1), 1)
        # what is left out of the lags must not make it indefinite
        return np.asarray(found + 1e-3 * np.diag(np.diag(found)))

    def added(self, name: str, kernel: Kernel) -> Products:
        """With one noise more."""
        return _of_pairs(
            (*self.names, name), {key: one.added(kernel) for key, one in self.pairs.items()}
        )


def products(
    factors: list[int], samples: int, noises: Mapping[str, Kernel | None], order: int = 2
) -> Products:
    """Prepares the covariance at averaging factors of a record.

    Args:
        factors: increasing.
        samples: number of rates in the record.
        noises: name -> kernel; ``None`` for white phase.
        order: of the differences of phase: 2 Allan, 3 Hadamard.
    """
    pairs = {}
    for i, short in enumerate(factors):
        for j, long in enumerate(factors[i:], start=i):
            pair = _pair(short, long, samples, order)
            for kernel in noises.values():
                pair = pair.added(kernel)
            pairs[i, j] = pair
    return _of_pairs(tuple(noises), pairs)


def _of_pairs(names: tuple[str, ...], pairs: Mapping[tuple[int, int], _Pair]) -> Products:
    count = 1 + max(i for i, _ in pairs)
    parts = np.zeros((len(names), len(names), count, count))
    for (i, j), pair in pairs.items():
        parts[:, :, i, j] = parts[:, :, j, i] = pair.mean_products()
    return Products(names, parts, pairs)


@dataclass(frozen=True, eq=False)
class _Pair:
    """Differences over two averaging times, and how they are correlated at some lags.

    Attributes:
        short: the shorter averaging factor.
        long: the longer one.
        order: of the differences.
        lags: at which the covariance is summed.
        weights: number of pairs of differences that each of them stands for, over that of all.
        spikes: lags at which differences share a phase.
        heights: product of the weights of the phases that are shared.
        held: number of pairs of differences so far apart, over that of all.
        smooth: covariance at the lags, a row for each noise; 0 of white phase.
        between: the same at the spikes.
        white: height of white phase at the spikes, a row for each noise; 0 of the others.
    """

    short: int
    long: int
    order: int
    lags: Array
    weights: Array
    spikes: Array
    heights: Array
    held: Array
    smooth: Array
    between: Array
    white: Array

    def added(self, kernel: Kernel | None) -> _Pair:
        """With one noise more."""
        smooth, between = np.zeros(len(self.lags)), np.zeros(len(self.spikes))
        if kernel is not None and len(self.lags):
            smooth, between = self._differenced(kernel, self.lags, self.spikes)
        white = self.heights * (kernel is None)
        return replace(
            self,
            smooth=np.vstack((self.smooth, smooth)),
            between=np.vstack((self.between, between)),
            white=np.vstack((self.white, white)),
        )

    def mean_products(self) -> Array:
        """Of all pairs of differences, for each pair of noises."""
        cross = (self.white * self.held) @ self.between.T
        sums = (self.smooth * self.weights) @ self.smooth.T + cross + cross.T
        sums += (self.white * self.held) @ self.white.T
        return np.asarray(2 * sums / (_DIVISORS[self.order] * self.short * self.long) ** 2)

    def _differenced(self, kernel: Kernel, lags: Array, spikes: Array) -> tuple[Array, Array]:
        """Differences of a kernel over both averaging times, at lags and spikes."""
        at = np.concatenate((lags, spikes))
        shared = _shared(self.short, self.long, self.order)
        total = np.array(list(shared.values())) @ kernel(at - np.array([*shared])[:, None])
        return total[: len(lags)], total[len(lags) :]


def _pair(short: int, long: int, samples: int, order: int) -> _Pair:
    """Two averaging times without any noise."""
    room = [samples + 1 - order * m for m in (short, long)]
    lags, width = np.zeros(0), np.zeros(0)
    if long <= _FARTHEST * short:
        lags, width = _lags(short, long, room, order)
    shared = _shared(short, long, order)
    spikes = np.array(list(shared), dtype=float)
    every = room[0] * room[1]
    return _Pair(
        short, long, order, lags, width * _held(lags, room) / every,
        spikes, np.array(list(shared.values())), np.maximum(0, _held(spikes, room)) / every,
        np.zeros((0, len(lags))), np.zeros((0, len(spikes))), np.zeros((0, len(spikes))),
    )  # fmt: skip


def _shared(short: int, long: int, order: int) -> dict[int, float]:
    """Lags at which differences share a phase, with the product of its weights."""
    heights: dict[int, float] = {}
    for p, left in enumerate(_WEIGHTS[order]):
        for q, right in enumerate(_WEIGHTS[order]):
            lag = q * long - p * short
            heights[lag] = heights.get(lag, 0.0) + left * right
    return heights


def _held(lags: Array, room: list[int]) -> Array:
    """How many pairs of differences are so far apart."""
    return np.asarray(np.minimum(room[0], lags + room[1]) - np.maximum(0, lags))


def _lags(short: int, long: int, room: list[int], order: int) -> tuple[Array, Array]:
    """Lags at which anything is correlated, and how many lags each stands for.

    Differences share phases at lags near 0, 1, 2 … of the longer averaging time: the lags are dense
    there, and ever farther apart between.
    """
    width = max(1, min(short, *room) // _STEPS)
    dense = np.arange(-(order + 4) * short, 4 * short + 1, width)
    far = np.geomspace(4 * short, max(5 * short, _BEYOND * long), _FAR)
    about = np.concatenate((-order * short - far[::-1], dense, far)).round()
    lags = np.unique(np.concatenate([about + k * long for k in range(order + 1)]))
    lags = lags[(lags > -room[1]) & (lags < room[0])]
    edges = np.concatenate(([lags[0] - 0.5], (lags[1:] + lags[:-1]) / 2, [lags[-1] + 0.5]))
    return lags, np.diff(edges)
