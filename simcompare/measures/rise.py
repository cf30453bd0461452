"""Exponential rise of a speed to its terminal value, from positions alone."""

from __future__ import annotations

import numpy as np

from simcompare.measures import Measured, Request, _window
from simcompare.model.trajectory import Array, Trajectory

#: four unknowns; fewer samples than twice that are not smoothed
MIN_SAMPLES = 8
#: time constants that are tried first, as parts of the window: shorter ones are not resolved, and
#: longer ones cannot be told from a constant acceleration
SHORTEST, LONGEST, TRIED = 1e-3, 1e2, 120
#: Gauss-Newton has converged when the time constant changes by less than this part of itself
CONVERGED, MAX_ROUNDS = 1e-9, 50
#: positions that are straight up to this part of themselves do not rise any more
STRAIGHT = 1e-9

OPTIONS = ("start_s", "end_s")
UNITS = {"terminal_speed": "m/s", "time_constant": "s"}


def measure(trajectory: Trajectory, request: Request) -> Measured:
    """Fits x = c₀ + v∞·t + c₁·exp(-t/τ), which is what every linear drive does from any start.

    From rest it is the integral of v∞·(1 - exp(-t/τ)), with c₁ = v∞·τ; c₀ and c₁ are left free, so
    that how a source begins does not change what it ends with.

    Args:
        trajectory: the source.
        request: its probe sees one coordinate of a position; its options bound the window [s].

    Returns:
        ``terminal_speed`` and ``time_constant``, ``None`` where positions do not rise like that.
    """
    inside = _window.samples(trajectory.time_s, request.options)
    time_s, position = trajectory.time_s[inside], request.observed(trajectory)[inside]
    values = _fit(time_s, position) if len(time_s) >= MIN_SAMPLES else (None, None)
    return Measured(values=dict(zip(UNITS, values, strict=True)))


def _fit(time_s: Array, position_m: Array) -> tuple[float, float] | tuple[None, None]:
    """Terminal speed and time constant of the best curve, or nothing."""
    span_s = float(time_s[-1] - time_s[0])
    scaled, moved = (time_s - time_s[0]) / span_s, position_m - position_m[0]
    tried = np.geomspace(SHORTEST, LONGEST, TRIED)
    residuals = [float(np.sum(_solve(_shapes(scaled, tau), moved)[1] ** 2)) for tau in tried]
    best = int(np.argmin(residuals))
    straight = _solve(_shapes(scaled, 1.0)[:, :2], moved)[1]
    bends = np.abs(straight).max() > STRAIGHT * np.abs(moved).max()
    if best in (0, TRIED - 1) or not bends:
        return None, None
    tau = float(tried[best])
    for _ in range(MAX_ROUNDS):
        shapes = _shapes(scaled, tau)
        (_, speed, amount), residual = _solve(shapes, moved)
        # how the curve changes with τ; c₀, v∞ and c₁ may change with it
        by_tau = amount * scaled / tau**2 * shapes[:, 2]
        change = float(_solve(np.column_stack((shapes, by_tau)), residual)[0][3])
        # a step of more than half is cut: it would leave the neighbourhood of the best one tried
        tau += max(-tau / 2, min(tau / 2, change))
        if abs(change) < CONVERGED * tau:
            return float(speed) / span_s, tau * span_s
    return None, None


def _shapes(scaled: Array, tau: float) -> Array:
    """What the curve is a sum of: a constant, a straight line and an exponential, in columns."""
    return np.column_stack((np.ones(len(scaled)), scaled, np.exp(-scaled / tau)))


def _solve(columns: Array, values: Array) -> tuple[Array, Array]:
    """Least squares: the coefficients and what they leave over."""
    coefficients = np.asarray(np.linalg.lstsq(columns, values, rcond=None)[0], dtype=float)
    return coefficients, np.asarray(values - columns @ coefficients, dtype=float)
