"""What data can tell about unknowns, from how the residuals change with them.

The Jacobian of the residuals, without priors and with columns of length one, has as many singular
values as there are unknowns. Their ratio says how much worse the worst combination of unknowns is
known than the best one; the last singular vector names that combination.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.statistics.least_squares import covariance_of

#: condition above which a combination of unknowns is practically unidentifiable
WEAK = 500.0
#: condition above which nothing at all tells a combination
BLIND = 1e7
#: uncertainty above which nothing is known
_BOUNDLESS = 1e50
#: share of a direction below which an unknown is not named in it
_SHARE = 0.15


@dataclass(frozen=True)
class Direction:
    """A combination of unknowns and how far it may move.

    Attributes:
        singular_value: of the Jacobian with columns of length one.
        moves: unknown -> by how much it changes when the data change by one standard deviation.
        weak: whether the data practically do not determine it.
    """

    singular_value: float
    moves: Mapping[str, float]
    weak: bool


@dataclass(frozen=True)
class Identifiability:
    """How well the data alone, and with priors, determine the unknowns.

    Attributes:
        names: the unknowns.
        singular_values: largest first (p,).
        condition: largest over smallest, ``None`` where that is infinite.
        u_data: standard uncertainties from the data alone (p,).
        u: standard uncertainties with the priors (p,).
        correlation: from the data alone (p, p).
        directions: one for each singular value.
    """

    names: tuple[str, ...]
    singular_values: tuple[float, ...]
    condition: float | None
    u_data: tuple[float | None, ...]
    u: tuple[float | None, ...]
    correlation: tuple[tuple[float | None, ...], ...]
    directions: tuple[Direction, ...]

    @property
    def is_blind(self) -> bool:
        """Whether the data tell nothing at all of some combination."""
        return self.condition is None or not self.condition < BLIND

    @property
    def is_weak(self) -> bool:
        """Whether the data practically do not determine some combination."""
        return any(direction.weak for direction in self.directions)


def identifiability(
    names: Sequence[str], jacobian: Array, *, slopes: Array | None = None, u: Array | None = None
) -> Identifiability:
    """What data can tell about unknowns, from how they change with them.

    Args:
        names: the unknowns.
        jacobian: of the residuals over their standard uncertainty (n, p).
        slopes: derivatives of the unknowns as shown to those of the Jacobian (p,); 1 where
            ``None``.
        u: standard uncertainties with all that is known (p,); those of the data where ``None``.
    """
    slopes = np.ones(len(names)) if slopes is None else slopes
    length = np.linalg.norm(jacobian, axis=0)
    length = np.where(length > 0, length, 1e-150)
    _, values, vectors = np.linalg.svd(jacobian / length, full_matrices=False)
    missing = len(names) - len(values)  # fewer data than unknowns
    values = np.concatenate((values, np.zeros(missing)))
    vectors = np.linalg.svd(jacobian / length)[2] if missing else vectors
    covariance = covariance_of(jacobian) * np.outer(slopes, slopes)
    u_data = np.sqrt(np.diag(covariance))
    directions = tuple(
        _direction(names, s, v, slopes / length, u_data, values[0])
        for s, v in zip(values, vectors, strict=True)
    )
    correlation = covariance / np.outer(u_data, u_data)
    return Identifiability(
        tuple(names), tuple(values.tolist()),
        float(values[0] / values[-1]) if values[-1] > 0 else None,
        _finite(u_data), _finite(u_data if u is None else u),
        tuple(_finite(row) for row in correlation), directions,
    )  # fmt: skip


def _finite(values: Array) -> tuple[float | None, ...]:
    return tuple(float(value) if abs(value) < _BOUNDLESS else None for value in values)


def _direction(
    names: Sequence[str], value: float, along: Array, scale: Array, u: Array, largest: float
) -> Direction:
    moves = along * scale / max(value, 1e-12)
    share = np.abs(moves) / u
    if not share.max() > _SHARE:  # another direction, weaker by far, makes all u much larger
        share = np.abs(along)
    lead = int(np.argmax(share))
    moves = moves * np.sign(moves[lead])
    named = share > _SHARE
    found = {n: float(m) for n, m, k in zip(names, moves, named, strict=True) if k}
    return Direction(float(value), found, bool(largest > WEAK * value))
