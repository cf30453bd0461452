"""The reference fitted to measured signals, with what is known only so well in its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.fitting.waveforms.setup import Setup
from simcompare.inference.estimate import Estimate, estimate
from simcompare.inference.reference_model import Model
from simcompare.inference.residuals import Block, Solution, blocks_of, solve
from simcompare.model.trajectory import Array

#: singular values of the scaled Jacobian below this part of the largest tell nothing
_MIN_SINGULAR = 1e-10


@dataclass(frozen=True)
class Fitted:
    """The reference with the parameters that fit best.

    Attributes:
        estimate: parameters, and their covariance from the data alone.
        blocks: what was fitted.
        solution: all unknowns, the nuisance ones last.
        gain: change of the unknowns for a change of the weighted residuals (k, n).
    """

    estimate: Estimate
    blocks: tuple[Block, ...]
    solution: Solution
    gain: Array

    @property
    def u_known(self) -> Array:
        """Standard uncertainty of the parameters from what was known before (k,)."""
        moved = [np.square(move) for move in self.estimate.follows.values()]
        return np.sqrt(np.sum(moved, axis=0)) if moved else np.zeros(len(self.estimate.names))

    @property
    def covariance(self) -> Array:
        """Of the parameters, from data and from what was known before (k, k)."""
        moved = [np.outer(move, move) for move in self.estimate.follows.values()]
        return np.asarray(self.estimate.covariance + np.sum(moved, axis=0), dtype=float)


def fit_reference(model: Model, setup: Setup) -> Fitted:
    """Fits the reference; parameters that nothing tells are refused.

    Raises:
        InputError: nothing that was measured changes with a parameter.
    """
    found = estimate(
        model, setup.fitted, setup.probes, setup.names, setup.nuisance, starts=setup.starts,
        known=setup.known(),
    )  # fmt: skip
    blocks = tuple(blocks_of(setup.fitted, setup.probes))
    first, bounds = setup.fitted[0].values, model.file.parameters
    rest = [first.get(name, bounds[name].value) for name in setup.nuisance]
    begin = np.concatenate((found.values, rest))
    whole = solve(model, blocks, setup.every, begin, starts=setup.starts)
    return Fitted(found, blocks, whole, _gain(whole.jacobian))


def _gain(jacobian: Array) -> Array:
    """Generalised inverse with columns of length one; what nothing tells does not move."""
    size = np.linalg.norm(jacobian, axis=0)
    inverse = np.linalg.pinv(jacobian / size, rcond=_MIN_SINGULAR) / size[:, None]
    return np.asarray(inverse, dtype=float)
