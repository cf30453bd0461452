"""The reference fitted to measured signals, with what is known only so well in its uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.fitting.waveform_setup import Setup
from simcompare.trajectory import Array
from simcompare.validation.cases import Case
from simcompare.validation.estimate import (
    Block,
    Estimate,
    Solution,
    blocks_of,
    estimate,
    residuals_of,
    solve,
)
from simcompare.validation.model import Model

#: singular values of the scaled Jacobian below this part of the largest tell nothing
_LEAST = 1e-10
#: part of an uncertainty by which what is known is moved, so that everything is straight
PART = 0.01


@dataclass(frozen=True)
class Fitted:
    """The reference with the parameters that fit best.

    Attributes:
        estimate: parameters, and their covariance from the data alone.
        blocks: what was fitted.
        solution: all unknowns, the nuisance ones last.
        gain: change of the unknowns for a change of the weighted residuals (k, n).
        known: shared parameter -> change of the unknowns for one standard uncertainty (k,).
        read_off: the same for what was read off each stretch.
    """

    estimate: Estimate
    blocks: tuple[Block, ...]
    solution: Solution
    gain: Array
    known: Mapping[str, Array]
    read_off: tuple[Array, ...]

    @property
    def u_known(self) -> Array:
        """Standard uncertainty of the parameters from what was known before."""
        k = len(self.estimate.names)
        parts = [move[:k] for move in (*self.known.values(), *self.read_off)]
        return np.sqrt(np.sum(np.square(parts), axis=0)) if parts else np.zeros(k)

    @property
    def covariance(self) -> Array:
        """Of the parameters, from data and from what was known before (k, k)."""
        k = len(self.estimate.names)
        moves = [move[:k] for move in (*self.known.values(), *self.read_off)]
        return self.estimate.covariance + sum(
            (np.outer(move, move) for move in moves), np.zeros((k, k))
        )


def fit_reference(model: Model, setup: Setup) -> Fitted:
    """Fits the reference; parameters that nothing tells are refused.

    Raises:
        InputError: nothing that was measured changes with a parameter.
    """
    found = estimate(model, setup.fitted, setup.probes, setup.names, setup.nuisance)
    blocks = tuple(blocks_of(setup.fitted, setup.probes))
    start = np.concatenate((found.values, [_first(model, setup, n) for n in setup.nuisance]))
    whole = solve(model, blocks, setup.every, start)
    gain = _gain(whole.jacobian)
    best = dict(zip(setup.every, whole.values.tolist(), strict=True))
    here = np.concatenate(whole.residuals)
    known = {
        name: -gain @ (_moved(model, blocks, best, name, PART * u, None) - here) / PART
        for name, u in setup.known().items()
    }
    # the scatter between three and more streams has what was read off each of them in it
    own = [] if len(setup.fitted) >= 3 else _read_off(model, setup, blocks, best, gain, here)
    return Fitted(found, blocks, whole, gain, known, tuple(own))


def _first(model: Model, setup: Setup, name: str) -> float:
    return setup.fitted[0].values.get(name, model.file.parameters[name].value)


def _gain(jacobian: Array) -> Array:
    """Generalised inverse with columns of length one; what nothing tells does not move."""
    size = np.linalg.norm(jacobian, axis=0)
    inverse = np.linalg.pinv(jacobian / size, rcond=_LEAST) / size[:, None]
    return np.asarray(inverse, dtype=float)


def _moved(
    model: Model, blocks: Sequence[Block], best: Mapping[str, float], name: str, u: float,
    case: Case | None,
) -> Array:  # fmt: skip
    """Weighted residuals with one parameter moved by its uncertainty, in one case or in all."""
    parts = []
    for block in blocks:
        moves = case is None or block.case is case
        own = _within(model, best, block.case, {name: u}) if moves else best
        parts += residuals_of(model, [block], own)
    return np.concatenate(parts)


def _read_off(
    model: Model, setup: Setup, blocks: Sequence[Block], best: Mapping[str, float], gain: Array,
    here: Array,
) -> list[Array]:  # fmt: skip
    return [
        -gain @ (_moved(model, blocks, best, name, PART * case.u[name], case) - here) / PART
        for case in setup.fitted
        for name in setup.plan.start
        if name not in setup.every and case.u.get(name, 0.0) > 0
    ]


def moves(
    model: Model, fitted: Fitted, values: Array, case: Case
) -> list[tuple[str, dict[str, float]]]:
    """Parameters of a predicted stretch, moved by one standard uncertainty after the other.

    What is known of all stretches moves together with what was fitted under it, so that, say, a
    mass that only scales the fitted friction makes no prediction uncertain. The covariance of the
    fit moves along its principal axes, so that correlations are kept.

    Args:
        model: the scenario.
        fitted: the reference as fitted.
        values: fitted parameters, of the reference or of an engine (k,).
        case: the stretch.

    Returns:
        What moves, and the parameters then.
    """
    names, k = fitted.estimate.names, len(fitted.estimate.names)
    sizes, axes = np.linalg.eigh(fitted.estimate.covariance)
    steps = [
        (f"fit, axis {i}", np.sqrt(size) * axis, {})
        for i, (size, axis) in enumerate(zip(sizes, axes.T, strict=True), start=1)
        if size > 0
    ]
    steps += [(f"start of fitted {i}", m[:k], {}) for i, m in enumerate(fitted.read_off, start=1)]
    for name, u in case.u.items():
        if u > 0 and name not in names:
            move = fitted.known[name][:k] if name in fitted.known else np.zeros(k)
            steps.append((name, move, {name: u}))
    return [
        (what, _within(model, dict(zip(names, values.tolist(), strict=True)), case,
                       {**dict(zip(names, move.tolist(), strict=True)), **own}))
        for what, move, own in steps
    ]  # fmt: skip


def _within(
    model: Model, best: Mapping[str, float], case: Case, step: Mapping[str, float]
) -> dict[str, float]:
    """Parameters after a step, or after its opposite where the step would leave a bound."""
    bounds, here = model.file.parameters, {**case.values, **best}
    for sign in (1, -1):
        moved = {name: here[name] + sign * change for name, change in step.items()}
        if all(bounds[n].min <= value <= bounds[n].max for n, value in moved.items()):
            break
    return {
        **best,
        **{n: min(max(value, bounds[n].min), bounds[n].max) for n, value in moved.items()},
    }
