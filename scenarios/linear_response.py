"""Exact response of linear systems to signals, piece by piece; for references of scenarios.

Between its corners a signal is smooth. Each piece carries Gauss points, and every integral over it
is that of the polynomial through them: exact for straight lines, and to rounding for what is as
smooth as a sine on pieces that are short beside its period.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.model.signals import Signal
from simcompare.model.trajectory import Array
from simcompare.scenarios.instants import CLOSE_S, corners_of, grid

#: Gauss points of one piece
POINTS = 8
_Values = NDArray[Any]


def edges_of(
    time_s: Array, signals: Sequence[Signal], longest_s: float
) -> tuple[Array, NDArray[np.intp]]:
    """Where pieces end, and which of these edges the wanted times are.

    Args:
        time_s: wanted times from 0 on (n,), increasing [s].
        signals: what drives the system.
        longest_s: longest piece, about two time constants [s].
    """
    corners = np.concatenate([np.empty(0), *map(corners_of, signals)])
    coarse, _ = grid(time_s, corners, np.inf)
    lengths = np.diff(coarse)
    parts = np.maximum(np.ceil(lengths / longest_s), 1).astype(int)
    number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    share = number / np.repeat(parts, parts)
    edges = np.append(np.repeat(coarse[:-1], parts) + share * np.repeat(lengths, parts), coarse[-1])
    return edges, np.searchsorted(edges, time_s - CLOSE_S)


class Pieces:
    """Gauss points in every piece of time, and integrals over them.

    Args:
        edges: ends of the pieces (n + 1,) [s].
    """

    def __init__(self, edges: Array) -> None:
        nodes, weights = np.polynomial.legendre.leggauss(POINTS)
        nodes, self._weights = (nodes + 1) / 2, weights / 2
        self._lengths = np.diff(edges)
        self._known: dict[complex, tuple[_Values, _Values]] = {}
        #: Gauss points (n, POINTS) [s]
        self.inside = edges[:-1, None] + self._lengths[:, None] * nodes
        # integrals from 0 to each of the points, and to 1, by as many points below each
        self._upper = np.append(nodes, 1.0)
        self._left = self._upper[:, None] * (1 - nodes)
        below = self._upper[:, None] * nodes
        known, wanted = (np.vander(2 * part.ravel() - 1, POINTS) for part in (nodes, below))
        self._through = np.linalg.solve(known.T, wanted.T).T.reshape(*below.shape, POINTS)

    def integral(self, values: Array, start: float) -> tuple[Array, Array]:
        """Integral of values at the points (n, POINTS): at the points, and at the edges."""
        matrix = np.einsum("u,k,ukp->up", self._upper, self._weights, self._through)
        grown = self._lengths[:, None] * (values @ matrix.T)
        ends = start + np.concatenate(([0.0], np.cumsum(grown[:, -1])))
        return ends[:-1, None] + grown[:, :-1], np.asarray(ends, dtype=float)

    def lagged(self, goal: _Values, lag_s: complex, start: complex) -> tuple[_Values, _Values]:
        """The response y of T·dy/dt = goal - y: at the points, and at the edges.

        y(t) = y_0·exp(-t/T) + ∫ exp(-(t-s)/T)·goal(s)/T ds, the same as the closed form where the
        goal is straight.

        Args:
            goal: at the points (n, POINTS).
            lag_s: T [s], complex for an oscillation.
            start: y_0.
        """
        fading, matrix = self._response(lag_s)
        forced = np.einsum("nup,np->nu", matrix, goal)
        ends: list[Any] = [start]
        for share, added in zip(fading[:, -1].tolist(), forced[:, -1].tolist(), strict=True):
            ends.append(share * ends[-1] + added)
        edges = np.array(ends)
        return edges[:-1, None] * fading[:, :-1] + forced[:, :-1], edges

    def _response(self, lag_s: complex) -> tuple[_Values, _Values]:
        """How the start fades (n, POINTS + 1), and what goals add (n, POINTS + 1, POINTS)."""
        if lag_s not in self._known:
            ratio = self._lengths / lag_s
            fading = np.exp(-ratio[:, None] * self._upper)
            weights = np.exp(-ratio[:, None, None] * self._left) * self._weights
            weights *= (ratio[:, None] * self._upper)[:, :, None]
            self._known[lag_s] = fading, np.einsum("nuk,ukp->nup", weights, self._through)
        return self._known[lag_s]

    def driven(
        self, push: Array, frequency_rad_s: float, damping: float, start: tuple[float, float]
    ) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """The response y of y'' + 2·ζ·ω·y' + ω²·y = push, for ζ < 1.

        With p = ω·(-ζ + i·√(1-ζ²)), z = y' - p̄·y obeys z' = p·z + push: a lag of T = -1/p.

        Args:
            push: at the points (n, POINTS).
            frequency_rad_s: ω [rad/s].
            damping: ζ.
            start: y and y' at the start.

        Returns:
            y and y' at the points, and both at the edges.
        """
        pole = frequency_rad_s * complex(-damping, (1 - damping**2) ** 0.5)
        first = start[1] - pole.conjugate() * start[0]
        solution = self.lagged(-push / pole, -1 / pole, first)
        inside, edges = (
            (z.imag / pole.imag, z.real + pole.real * z.imag / pole.imag) for z in solution
        )
        return inside, edges
