"""Draws of several quantities at once, correlated where that is known.

The joint distribution is the Gaussian copula: exact where the correlated quantities are normal
(JCGM 101:2008, 6.4.8.4), and otherwise one that keeps each quantity's own distribution.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import Distribution, truncated_at
from simcompare.statistics.streams import stream

#: two names -> their coefficient of correlation
Correlation = Mapping[tuple[str, str], float]
#: an eigenvalue that is negative by rounding alone
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Joint:
    """Quantities that draw together; each has a stream of its own.

    Attributes:
        inputs: what is known of each.
        mixed: names of the correlated ones.
        root: a square root of their matrix of correlation.
    """

    inputs: Mapping[str, Distribution]
    mixed: tuple[str, ...]
    root: Array

    def blocks(self, seed: int, size: int) -> Iterator[dict[str, Array]]:
        """Endless blocks of so many draws; another quantity leaves these draws as they are."""
        streams = {name: stream(seed, name) for name in self.inputs}
        while True:
            drawn = {
                name: known.draw(streams[name], size)
                for name, known in self.inputs.items()
                if name not in self.mixed
            }
            normal = [streams[name].standard_normal(size) for name in self.mixed]
            together = self.root @ np.array(normal) if normal else ()
            for name, deviates in zip(self.mixed, together, strict=True):
                drawn[name] = at_deviates(self.inputs[name], deviates)
            yield drawn


def joint(inputs: Mapping[str, Distribution], correlation: Correlation | None = None) -> Joint:
    """Puts quantities together.

    Raises:
        InputError: a correlation of an unknown quantity, beyond ±1, or ones that cannot all be.
    """
    matrix = correlation_matrix(inputs, correlation or {})
    names = list(inputs)
    others = np.abs(matrix - np.eye(len(names))).sum(axis=1) if names else np.zeros(0)
    mixed = [i for i, size in enumerate(others) if size > 0]
    sizes, vectors = np.linalg.eigh(matrix[np.ix_(mixed, mixed)])
    root = vectors * np.sqrt(np.clip(sizes, 0.0, None))
    return Joint(inputs, tuple(names[i] for i in mixed), root)


def correlation_matrix(inputs: Mapping[str, Distribution], correlation: Correlation) -> Array:
    """The coefficients in the order of the inputs.

    Raises:
        InputError: a correlation of an unknown quantity, beyond ±1, or ones that cannot all be.
    """
    names = list(inputs)
    faults = [fault for pair, r in correlation.items() for fault in _faults(pair, r, names)]
    if faults:
        raise InputError("correlation", faults)
    matrix = np.eye(len(names))
    for (one, other), r in correlation.items():
        i, j = names.index(one), names.index(other)
        matrix[i, j] = matrix[j, i] = r
    if names and np.linalg.eigvalsh(matrix)[0] < -_ROUNDING * len(names):
        told = ", ".join(f"{one} with {other} {r:g}" for (one, other), r in correlation.items())
        raise InputError(
            "correlation",
            [f"{told} cannot all be true: the matrix has a negative eigenvalue; make one smaller"],
        )
    return matrix


def _faults(pair: tuple[str, str], r: float, names: list[str]) -> list[str]:
    told = " with ".join(pair)
    faults = [
        f"{told}: there is no input {name!r}; expected two of {', '.join(names)}"
        for name in pair
        if name not in names
    ]
    if pair[0] == pair[1]:
        faults.append(f"{told}: a quantity with itself is 1 always; leave it out")
    if not -1 <= r <= 1:
        faults.append(f"{told}: {r:g} is no coefficient of correlation; expected -1 to 1")
    return faults


def at_deviates(known: Distribution, deviates: Array) -> Array:
    """The values of a distribution at the probabilities of standard normal deviates."""
    if known.kind in ("fixed", "normal"):
        return np.asarray(known.center + known.scale * deviates, dtype=float)
    from scipy import special

    return np.asarray(known.center + _QUANTILES[known.kind](known, special.ndtr(deviates)))


def _triangular(known: Distribution, chance: Array) -> Array:
    lower = np.sqrt(2 * np.minimum(chance, 1 - chance)) - 1
    return np.asarray(known.half_width * np.where(chance < 0.5, lower, -lower))


def _student(known: Distribution, chance: Array) -> Array:
    from scipy import stats

    return np.asarray(known.scale * stats.t.ppf(chance, known.degrees_of_freedom), dtype=float)


#: kind -> deviation from the centre at a probability
_QUANTILES: Mapping[str, Callable[[Distribution, Array], Array]] = {
    "rectangular": lambda known, chance: known.half_width * (2 * chance - 1),
    "triangular": _triangular,
    "u_shaped": lambda known, chance: known.half_width * np.sin(math.pi * (chance - 0.5)),
    "truncated_normal": truncated_at,
    "student_t": _student,
}
