"""Flights of a filmed ball joined to impact times.

Each flight is fitted by an arc of given shape (a parabola, or with drag), of which only the apex is
unknown, and neighbouring arcs are intersected: neither the floor's level nor a frame at the impact
is needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.flights import MIN_SAMPLES, kinks, long_enough, noise_of, samples
from simcompare.fitting.bounces.impacts import HEIGHT, TRACK, Impacts, Signal, Track
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected
from simcompare.statistics.agreement import MAD_TO_SD

#: a sample so many standard deviations off its arc is an outlier
_OUTLIER = 5.0
#: samples of the first flight that propose parabolas
_PROPOSERS = 40


@dataclass(frozen=True)
class _Arcs:
    """Fitted flights: apex time and level of each, and their covariances for u = 1."""

    apex_s: Array
    apex_m: Array
    unit_covariance: Array
    gravity: float
    drag: float

    def at(self, time_s: Array, flight: NDArray[np.int64] | int) -> Array:
        return bounce_models.arc(
            time_s - self.apex_s[flight], self.apex_m[flight], self.gravity, self.drag
        )

    def speed(self, time_s: float, flight: int) -> float:
        """Velocity upwards [m/s]."""
        both = self.at(np.array([time_s - 1e-5, time_s + 1e-5]), flight)
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
    time, height, u, dropped = samples(time_s, height_m, u_m, source)
    noise = noise_of(height) if not np.isfinite(u).all() else float(np.median(u))
    cuts = kinks(time, height, noise, gravity_m_s2, source)
    flight = np.searchsorted(cuts, np.arange(len(time)), side="right")
    flight = long_enough(time, flight, source)
    kept = (flight >= 0) & ~_in_hand(time, height, flight == 0, noise, gravity_m_s2)
    drag = 1 / terminal_speed_m_s**2
    for _ in range(10):
        arcs = _fitted(time, height, u, np.where(kept, flight, -1), gravity_m_s2, drag)
        before = kept, flight
        kept, why = _good(time, height, u, flight, arcs, noise)
        flight = np.where(flight >= 0, np.searchsorted(_joins(arcs), time), -1)
        if np.array_equal(before[0], kept) and np.array_equal(before[1], flight):
            break
    why |= {int(k): "flight too short" for k in np.flatnonzero(flight < 0)}
    dropped += [Rejected("sample", int(k) + 1, float(time[k]), why[k]) for k in sorted(why)]
    arcs = _fitted(time, height, u, np.where(kept, flight, -1), gravity_m_s2, drag)
    joined = _impacts(time, height, u, np.where(kept, flight, -1), arcs, source, dropped)
    return replace(joined, signal=Signal(HEIGHT, time, height))


def rejoined(impacts: Impacts, terminal_speed_m_s: float, gravity_m_s2: float) -> Impacts:
    """The same track with its arcs joined again, for another terminal speed."""
    track = impacts.track
    assert track is not None
    drag = 1 / terminal_speed_m_s**2
    arcs = _fitted(track.time_s, track.height_m, track.u_m, track.flight, gravity_m_s2, drag)
    return _impacts(
        track.time_s, track.height_m, track.u_m, track.flight, arcs, impacts.source,
        list(impacts.dropped),
    )  # fmt: skip


def _in_hand(
    time: Array, height: Array, first: NDArray[np.bool_], noise: float, gravity: float
) -> NDArray[np.bool_]:
    """Samples of the first flight that do not lie on the fall that most of its samples share.

    Each pair of samples proposes a parabola; a ball in a hand follows none of them for long.
    """
    t, y = time[first], height[first]
    straight = y + 0.5 * gravity * (t - t[0]) ** 2
    pick = np.unique(np.linspace(0, len(t) - 1, _PROPOSERS).round().astype(int))
    a, b = np.triu_indices(len(pick), 1)
    run = t[pick][b] - t[pick][a]
    slope = (straight[pick][b] - straight[pick][a]) / run
    level = straight[pick][a] - slope * t[pick][a]
    off = np.abs(straight - level[:, None] - slope[:, None] * t)
    # drag bends a fall by about a hundredth of its height
    on = off <= max(_OUTLIER * noise, 0.01 * float(np.ptp(y)))
    found = np.zeros(len(time), dtype=bool)
    found[np.flatnonzero(first)] = ~on[int(np.argmax(on.sum(axis=1)))]
    return found


def _fitted(
    time: Array, height: Array, u: Array, flight: NDArray[np.int64], gravity: float, drag: float
) -> _Arcs:
    """Apex of each flight by weighted least squares, and their covariance."""
    weight = np.where(np.isfinite(u), 1 / u, 1.0)
    apexes, covariances = [], []
    for number in range(int(flight.max()) + 1):
        inside = flight == number
        t, y, w = time[inside], height[inside], weight[inside]
        line = np.polyfit(t - t[0], y + 0.5 * gravity * (t - t[0]) ** 2, 1, w=w)
        apex = np.array([t[0] + line[0] / gravity, line[1] + line[0] ** 2 / (2 * gravity)])
        for _ in range(6 if drag else 1):
            tau = t - apex[0]
            here = bounce_models.arc(tau, apex[1], gravity, drag)
            up = (bounce_models.arc(tau + 1e-6, apex[1], gravity, drag) - here) / 1e-6
            design = np.column_stack((-up, np.ones(len(t)))) * w[:, None]
            apex = apex + np.linalg.lstsq(design, (y - here) * w, rcond=None)[0]
        apexes.append(apex)
        covariances.append(np.linalg.inv(design.T @ design))
    found = np.array(apexes)
    return _Arcs(found[:, 0], found[:, 1], np.array(covariances), gravity, drag)


def _good(
    time: Array, height: Array, u: Array, flight: NDArray[np.int64], arcs: _Arcs, noise: float
) -> tuple[NDArray[np.bool_], dict[int, str]]:
    """Which samples follow their arcs, and why the others do not."""
    residual = np.where(flight >= 0, height - arcs.at(time, np.maximum(flight, 0)), 0.0)
    used = flight >= 0
    scatter = MAD_TO_SD * float(np.median(np.abs(residual[used])))
    limit = _OUTLIER * np.maximum(np.where(np.isfinite(u), u, noise), scatter)
    # a ball in a hand does not fall: samples before the first apex count only where they follow
    held = used & (flight == 0) & (time < arcs.apex_s[0])
    early = held.any() and bool(np.any(np.abs(residual[held]) > limit[held]))
    why: dict[int, str] = {}
    if early:
        why |= {int(k): "not released yet" for k in np.flatnonzero(held)}
    off = used & (np.abs(residual) > limit) & ~(held & early)
    why |= {int(k): f"{1e3 * residual[k]:.0f} mm off its flight" for k in np.flatnonzero(off)}
    good = used & ~off & ~(held & early)
    for number in range(int(flight.max()) + 1):  # never so many that nothing is left of a flight
        inside = flight == number
        if np.count_nonzero(good & inside) < MIN_SAMPLES - 1:
            good |= inside
            why = {k: text for k, text in why.items() if not inside[k]}
    return good, why


def _joins(arcs: _Arcs) -> Array:
    """Times at which neighbouring arcs meet."""
    times = []
    for n in range(len(arcs.apex_s) - 1):
        (a, b), (h, k) = arcs.apex_s[n : n + 2], arcs.apex_m[n : n + 2]
        t = float((a + b) / 2 + (h - k) / (arcs.gravity * (b - a)))
        for _ in range(20 if arcs.drag else 1):
            gap = float((arcs.at(np.array([t]), n) - arcs.at(np.array([t]), n + 1))[0])
            move = gap / (arcs.speed(t, n) - arcs.speed(t, n + 1))
            t -= move
            if abs(move) < 1e-13:
                break
        times.append(t)
    return np.array(times)


def _impacts(
    time: Array, height: Array, u: Array, flight: NDArray[np.int64], arcs: _Arcs, source: str,
    dropped: list[Rejected],
) -> Impacts:  # fmt: skip
    """Joins, their covariance, and apexes above the level at which the arcs meet."""
    used = flight >= 0
    residual = height[used] - arcs.at(time[used], flight[used])
    flights = len(arcs.apex_s)
    stated = bool(np.isfinite(u[used]).all())
    degrees = max(len(residual) - 2 * flights, 1)
    variance = 1.0 if stated else float(residual @ residual) / degrees
    joins = _joins(arcs)
    change, floor = np.zeros((len(joins), 2 * flights)), np.empty(len(joins))
    for n, t in enumerate(joins.tolist()):
        before, after = arcs.speed(t, n), arcs.speed(t, n + 1)
        # the arcs' difference vanishes: dt = (dD/da·da + dD/dH·dH)/(after - before)
        row = np.array([-before, 1.0, after, -1.0]) / (after - before)
        change[n, 2 * n : 2 * n + 4] = row
        floor[n] = arcs.at(np.array([t]), n)[0]
    whole = np.zeros((2 * flights, 2 * flights))
    for n in range(flights):
        whole[2 * n : 2 * n + 2, 2 * n : 2 * n + 2] = variance * arcs.unit_covariance[n]
    covariance = change @ whole @ change.T
    covariance = (covariance + covariance.T) / 2
    each = np.sqrt(np.diag(covariance))
    level = float(np.median(floor))
    track = Track(time[used], height[used], u[used], flight[used].astype(np.int64))
    return Impacts(
        joins, each, tuple(range(1, len(joins) + 1)), TRACK, source,
        heights_m=arcs.apex_m - level,
        u_heights_m=np.sqrt(variance * arcs.unit_covariance[:, 1, 1]),
        height_numbers=tuple(range(flights)), track=track, covariance_s2=covariance,
        dropped=tuple(dropped),
    )  # fmt: skip
