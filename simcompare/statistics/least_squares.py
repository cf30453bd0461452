"""Small least-squares problems solved side by side: Levenberg and Marquardt with bounds.

A bootstrap or a profile needs hundreds of fits of a few unknowns. Their models are evaluated for
all of them, and for all differences, in one call on arrays. Each step follows the bend of the
model as far as its second derivative along the step tells (geodesic acceleration: M. K. Transtrum
and J. P. Sethna, arXiv:1201.5885), for unknowns that nearly make up for each other lie along a
curved valley in which straight steps do not come far.

scipy's ``least_squares`` solves one problem at a time and is used where there is one, as for
signals over time. Of 200 repeats of a drop of seven impacts it finds the same minima in 0.80 s,
this in 0.012 s; with drag and a power law, ten impacts, in 2.96 s and 0.034 s.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array

#: unknowns (…, B, p) -> whitened residuals (…, B, n)
Residuals = Callable[[Array], Array]

#: step of the central differences in sizes of an unknown
STEP = 1e-5
MAX_STEPS = 60
#: what damping is multiplied by after a step that helps, and after one that does not
_DOWN, _UP = 1 / 30, 3.0
#: step at which the bend of the model along a step is probed
_PROBE = 0.1
#: part of a step that the correction for that bend may have
_MAX_BENT = 0.75
#: that of the first step
_DAMPING = 1e-3
#: a fit has ended when the next step would lower chi squared by less than this part
_ENOUGH = 1e-9


@dataclass(frozen=True)
class Solution:
    """B fits.

    Attributes:
        x: unknowns (B, p).
        residuals: whitened (B, n).
        jacobian: of the residuals (B, n, p).
        converged: (B,).
        at_bound: -1 at the lower, 1 at the upper bound with chi squared falling beyond (B, p).
    """

    x: Array
    residuals: Array
    jacobian: Array
    converged: NDArray[np.bool_]
    at_bound: NDArray[np.int64]

    @property
    def chi2(self) -> Array:
        """Sum of squares of each fit (B,)."""
        return np.asarray(np.sum(self.residuals**2, axis=-1))


def solve(
    residuals: Residuals,
    start: Array,
    low: Array,
    high: Array,
    size: Array,
    *,
    enough: float = _ENOUGH,
    damping: float = _DAMPING,
) -> Solution:
    """Minimises the sum of squared residuals of every problem.

    Args:
        residuals: of all problems at once.
        start: first guesses (B, p).
        low: lower bounds (p,).
        high: upper bounds (p,).
        size: usual size of each unknown (p,).
        enough: part of chi squared that a further step would have to bring.
        damping: of the first step; little where the answer is near.
    """
    x = np.clip(start, low, high)
    r = residuals(x)
    chi2 = np.sum(r**2, axis=-1)
    firm = np.full(len(x), damping)
    done = np.zeros(len(x), dtype=bool)
    jacobian = jacobian_of(residuals, x, size)
    for _ in range(MAX_STEPS):
        slope = np.einsum("bnp,bn->bp", jacobian, r)
        outward = _outward(x, slope, low, high)
        damped, gain = _damped(jacobian, slope, outward != 0, firm)
        done |= gain < enough * (1e-3 + chi2)
        if done.all():
            break
        step = damped(slope)
        probed = (residuals(np.clip(x + _PROBE * step * size, low, high)) - r) / _PROBE
        bend = 2 / _PROBE * (probed - np.einsum("bnp,bp->bn", jacobian, step))
        turn = damped(np.einsum("bnp,bn->bp", jacobian, bend)) / 2
        gentle = np.linalg.norm(turn, axis=1) < _MAX_BENT * np.linalg.norm(step, axis=1)
        step = np.where(gentle[:, None], step + turn, step)
        moved = np.where(done[:, None], x, np.clip(x + step * size, low, high))
        r_moved = residuals(moved)
        chi2_moved = np.nan_to_num(np.sum(r_moved**2, axis=-1), nan=np.inf)
        better = (chi2_moved < chi2) & ~done
        # no step of any length helps any more: rounding is reached
        done |= ~better & (firm > 1e9)
        firm = np.where(better, np.maximum(firm * _DOWN, 1e-14), firm * _UP)
        if better.any():
            x = np.where(better[:, None], moved, x)
            r = np.where(better[:, None], r_moved, r)
            chi2 = np.where(better, chi2_moved, chi2)
            jacobian = jacobian_of(residuals, x, size)
    slope = np.einsum("bnp,bn->bp", jacobian, r)
    return Solution(x, r, jacobian / size, done, _outward(x, slope, low, high))


def jacobian_of(residuals: Residuals, x: Array, size: Array) -> Array:
    """Central differences in sizes (B, n, p)."""
    count = x.shape[-1]
    moves = np.eye(count)[:, None, :] * (STEP * size)
    both = residuals(np.concatenate((x + moves, x - moves)))
    return np.moveaxis((both[:count] - both[count:]) / (2 * STEP), 0, -1)


def _outward(x: Array, slope: Array, low: Array, high: Array) -> NDArray[np.int64]:
    """Which unknowns are held by a bound: -1 lower, 1 upper."""
    return np.where((x <= low) & (slope > 0), -1, np.where((x >= high) & (slope < 0), 1, 0))


def _damped(
    jacobian: Array, slope: Array, held: NDArray[np.bool_], damping: Array
) -> tuple[Callable[[Array], Array], Array]:
    """Step in sizes against a slope (B, p), and what chi squared would fall by undamped (B,)."""
    normal = np.einsum("bnp,bnq->bpq", jacobian, jacobian)
    free = ~held
    normal = normal * free[:, :, None] * free[:, None, :]
    diagonal = np.einsum("bpp->bp", normal)
    # an unknown without any influence stays where it is
    root = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    eye = np.eye(jacobian.shape[-1])
    whole = normal / root[:, :, None] / root[:, None, :] + eye * (~(diagonal > 0))[:, :, None]
    firm = whole + damping[:, None, None] * eye

    def step(slope: Array) -> Array:
        goal = np.where(free, -slope, 0.0) / root
        return np.asarray(np.linalg.solve(firm, goal[..., None])[..., 0] / root)

    # damping hides weak directions, so what is left to gain is judged without it
    goal = np.where(free, -slope, 0.0) / root
    full = np.linalg.solve(whole + 1e-13 * eye, goal[..., None])[..., 0]
    return step, np.einsum("bp,bp->b", goal, full)


def covariance_of(jacobian: Array, held: Array | None = None) -> Array:
    """(JᵀJ)⁻¹ of whitened residuals; zero for unknowns that a bound holds (p, p)."""
    free = np.ones(jacobian.shape[1], dtype=bool) if held is None else ~np.asarray(held, dtype=bool)
    part = jacobian[:, free]
    size = np.linalg.norm(part, axis=0)
    size = np.where(size > 0, size, 1e-100)
    _, s, v = np.linalg.svd(part / size, full_matrices=False)
    # a direction that nothing determines has an uncertainty without bound, not none
    with np.errstate(over="ignore"):
        inverse = (v.T / np.maximum(s, 1e-10) ** 2) @ v / np.outer(size, size)
    whole = np.zeros((jacobian.shape[1], jacobian.shape[1]))
    whole[np.ix_(free, free)] = inverse
    return whole
