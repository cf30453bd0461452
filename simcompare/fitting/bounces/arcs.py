"""Flights of a filmed ball joined to impact times.

Each flight is fitted by an arc of given shape (a parabola, or with drag), of which only the apex is
unknown, and neighbouring arcs are intersected: neither the floor's level nor a frame at the impact
is needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.flights import MIN_SAMPLES, noise_of, samples, start_of
from simcompare.fitting.bounces.following import follow
from simcompare.fitting.bounces.impacts import HEIGHT, TRACK, Impacts, Signal, Track
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected


@dataclass(frozen=True)
class _Arcs:
    """Fitted flights: number, apex time and level of each, and their covariances for u = 1."""

    numbers: tuple[int, ...]
    apex_s: Array
    apex_m: Array
    unit_covariance: Array
    gravity: float
    drag: float

    def at(self, time_s: Array, arc: int) -> Array:
        return bounce_models.arc(
            time_s - self.apex_s[arc], self.apex_m[arc], self.gravity, self.drag
        )

    def speed(self, time_s: float, arc: int) -> float:
        """Velocity upwards [m/s]."""
        both = self.at(np.array([time_s - 1e-5, time_s + 1e-5]), arc)
        return float(both[1] - both[0]) / 2e-5


def from_heights(
    time_s: ArrayLike,
    height_m: ArrayLike,
    u_m: ArrayLike | None = None,
    *,
    gravity_m_s2: float = bounce_models.GRAVITY,
    terminal_speed_m_s: float = np.inf,
    source: str = "",
) -> Impacts:
    """One drop from height against time.

    Args:
        time_s: (n,) [s].
        height_m: above any level (n,), NaN where nothing was seen [m].
        u_m: standard uncertainty, one or one each; from the scatter where ``None`` [m].
        gravity_m_s2: free fall.
        terminal_speed_m_s: gives the arcs their shape; infinite for parabolas.
        source: name of the file.

    Raises:
        InputError: no impact, or flights with too few samples.
    """
    seen = samples(time_s, height_m, u_m, source)
    time, height, u = seen.time_s, seen.height_m, seen.u_m
    noise = float(np.median(u)) if np.isfinite(u).all() else noise_of(height)
    start = start_of(time, height, noise, gravity_m_s2, source)
    flight, why = follow(time, height, u, noise, gravity_m_s2, start, source)
    left_out = [
        Rejected("sample", int(seen.rows[k]) + 1, float(time[k]), why[k]) for k in sorted(why)
    ]
    dropped = tuple(sorted((*seen.gone, *left_out), key=lambda one: one.number))
    used = flight >= 0
    track = Track(time[used], height[used], u[used], flight[used])
    filmed = Impacts(
        kind=TRACK, source=source, track=track, dropped=dropped, signal=Signal(HEIGHT, time, height)
    )
    return rejoined(filmed, terminal_speed_m_s, gravity_m_s2)


def rejoined(impacts: Impacts, terminal_speed_m_s: float, gravity_m_s2: float) -> Impacts:
    """The same track with its arcs joined, for a terminal speed."""
    track = impacts.track
    assert track is not None
    return _with_joins(impacts, _fitted(track, gravity_m_s2, 1 / terminal_speed_m_s**2))


def _fitted(track: Track, gravity: float, drag: float) -> _Arcs:
    """Apex of each flight with enough samples by weighted least squares, and its covariance."""
    counts = np.bincount(track.flight)
    numbers = tuple(np.flatnonzero(counts >= MIN_SAMPLES).tolist())
    found = [_apex(track, number, gravity, drag) for number in numbers]
    apex = np.array([one for one, _ in found]).reshape(-1, 2)
    covariance = np.array([one for _, one in found]).reshape(-1, 2, 2)
    return _Arcs(numbers, apex[:, 0], apex[:, 1], covariance, gravity, drag)


def _apex(track: Track, number: int, gravity: float, drag: float) -> tuple[Array, Array]:
    inside = track.flight == number
    t, y, u = track.time_s[inside], track.height_m[inside], track.u_m[inside]
    w = np.where(np.isfinite(u), 1 / u, 1.0)
    line = np.polyfit(t - t[0], y + 0.5 * gravity * (t - t[0]) ** 2, 1, w=w)
    apex = np.array([t[0] + line[0] / gravity, line[1] + line[0] ** 2 / (2 * gravity)])
    for _ in range(6 if drag else 1):
        tau = t - apex[0]
        here = bounce_models.arc(tau, apex[1], gravity, drag)
        up = (bounce_models.arc(tau + 1e-6, apex[1], gravity, drag) - here) / 1e-6
        design = np.column_stack((-up, np.ones(len(t)))) * w[:, None]
        apex = apex + np.linalg.lstsq(design, (y - here) * w, rcond=None)[0]
    return apex, np.asarray(np.linalg.inv(design.T @ design), dtype=float)


def _join(arcs: _Arcs, n: int) -> float:
    """Time at which an arc meets the next."""
    (a, b), (h, k) = arcs.apex_s[n : n + 2], arcs.apex_m[n : n + 2]
    t = float((a + b) / 2 + (h - k) / (arcs.gravity * (b - a)))
    for _ in range(20 if arcs.drag else 1):
        gap = float((arcs.at(np.array([t]), n) - arcs.at(np.array([t]), n + 1))[0])
        move = gap / (arcs.speed(t, n) - arcs.speed(t, n + 1))
        t -= move
        if abs(move) < 1e-13:
            break
    return t


def _with_joins(impacts: Impacts, arcs: _Arcs) -> Impacts:
    """Joins, their covariance, and apexes above the level at which the arcs meet."""
    flights = len(arcs.numbers)
    both = [n for n in range(flights - 1) if arcs.numbers[n + 1] == arcs.numbers[n] + 1]
    joins = np.array([_join(arcs, n) for n in both])
    change = np.zeros((len(both), 2 * flights))
    for row, n, t in zip(change, both, joins.tolist(), strict=True):
        before, after = arcs.speed(t, n), arcs.speed(t, n + 1)
        # the arcs' difference vanishes: dt = (dD/da·da + dD/dH·dH)/(after - before)
        row[2 * n : 2 * n + 4] = np.array([-before, 1.0, after, -1.0]) / (after - before)
    variance = _variance(impacts, arcs)
    whole = np.zeros((2 * flights, 2 * flights))
    for n in range(flights):
        whole[2 * n : 2 * n + 2, 2 * n : 2 * n + 2] = variance * arcs.unit_covariance[n]
    covariance = change @ whole @ change.T
    covariance = (covariance + covariance.T) / 2
    level = np.median([arcs.at(np.array([t]), n)[0] for n, t in zip(both, joins, strict=True)])
    return replace(
        impacts, times_s=joins, u_s=np.sqrt(np.diag(covariance)), covariance_s2=covariance,
        numbers=tuple(arcs.numbers[n] + 1 for n in both), heights_m=arcs.apex_m - float(level),
        u_heights_m=np.sqrt(variance * arcs.unit_covariance[:, 1, 1]),
        height_numbers=arcs.numbers,
    )  # fmt: skip


def _variance(impacts: Impacts, arcs: _Arcs) -> float:
    """Of one sample: 1 where it is stated, else the scatter about the arcs [m²]."""
    track = impacts.track
    assert track is not None
    if np.isfinite(track.u_m).all():
        return 1.0
    left = [
        track.height_m[track.flight == number] - arcs.at(track.time_s[track.flight == number], n)
        for n, number in enumerate(arcs.numbers)
    ]
    residual = np.concatenate(left)
    return float(residual @ residual) / max(len(residual) - 2 * len(arcs.numbers), 1)
