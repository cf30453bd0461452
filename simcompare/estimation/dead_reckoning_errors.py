"""How errors of two wheels reach the pose of dead reckoning: first order, through exact arcs."""

from __future__ import annotations

import math

import numpy as np

from simcompare.hardware.sensors.odometer import Arcs
from simcompare.model.trajectory import Array

#: of the saw; those beyond have a twentieth of its variance
_HARMONICS = 12


def step_jacobians(driven: Arcs, track_m: float) -> tuple[Array, Array]:
    """How a step changes the pose: per heading before it (m, 3), per ways of both wheels (m, 3, 2).

    With Δψ = (Δs_R - Δs_L)/W, u the direction of the chord c and n the one to its left, the step is
    c·u. The heading turns it, c·n; the ways change c by sinc·dΔs + Δs·sinc'·dΔψ/2 and u by n·dΔψ/2.
    """
    cos, sin = np.cos(driven.direction_rad), np.sin(driven.direction_rad)
    along, across = np.column_stack((cos, sin)), np.column_stack((-sin, cos))
    half = driven.turn_rad / 2
    per_way = np.sinc(half / math.pi)[:, None] * along
    per_turn = (driven.chord_m[:, None] * across
                + (driven.way_m * sinc_slope(half))[:, None] * along) / 2  # fmt: skip
    ways = np.empty((len(cos), 3, 2))
    for side, sign in ((0, -1.0), (1, 1.0)):
        ways[:, :2, side] = per_way / 2 + sign * per_turn / track_m
        ways[:, 2, side] = sign / track_m
    turned = driven.chord_m[:, None] * across
    return np.column_stack((turned, np.zeros(len(cos)))), ways


def sinc_slope(x: Array) -> Array:
    """d/dx of sin(x)/x, by its series where x is small."""
    safe = np.where(np.abs(x) > 1e-3, x, 1.0)
    exact = (np.cos(safe) - np.sin(safe) / safe) / safe
    return np.where(np.abs(x) > 1e-3, exact, -x / 3 + x**3 / 30)


def of_wheels(driven: Arcs, angles: tuple[Array, Array], track_m: float) -> Array:
    """Change of the pose with left radius, right radius and track (n, 3, 3)."""
    per_heading, ways = step_jacobians(driven, track_m)
    added = np.empty((len(driven.way_m), 3, 3))
    added[:, :, :2] = ways * np.diff(np.column_stack(angles), axis=0)[:, None, :]
    # only the turn has the track in it, dΔψ/dW = -Δψ/W; half of (right - left) is one per turn
    per_turn = (ways[:, :, 1] - ways[:, :, 0]) * track_m / 2
    added[:, :, 2] = -per_turn * (driven.turn_rad / track_m)[:, None]
    heading = _before(np.cumsum(added[:, 2], axis=0))
    steps = added + per_heading[:, :, None] * heading[:-1, None, :]
    return _before(np.cumsum(steps, axis=0))


def _before(sums: Array) -> Array:
    """Sums up to each sample, the first of which has none."""
    return np.concatenate((np.zeros((1, *sums.shape[1:])), sums))


def of_start(pose: Array, u_start: tuple[float, float, float]) -> Array:
    """Covariance of the poses (n, 3, 3) from independent errors of the first one.

    A wrong heading turns the whole path about its start.
    """
    gain = np.tile(np.eye(3), (len(pose), 1, 1))
    gain[:, 0, 2] = pose[0, 1] - pose[:, 1]
    gain[:, 1, 2] = pose[:, 0] - pose[0, 0]
    return np.asarray(gain @ np.diag(np.square(u_start)) @ np.swapaxes(gain, 1, 2))


def of_counts(driven: Arcs, track_m: float, u_m: Array, counts: Array) -> Array:
    """Covariance (n, 3, 3) where the ways at every sample have errors of u (2,) [m] by counting.

    A step takes the difference of two errors, a_j - a_(j-1), and the heading before it is wrong by
    the difference of that sample's and the first one's. Sorted by samples, the pose at the end has

    * of the last one G_N, what a way does in the last step,
    * of one between G_m - G_(m+1) + H_(m+1), with H = what a heading does, times that of a way,
    * of the first one -G_1 - (H_2 + … + H_N): it turns all of the path.

    The errors between are independent but for the part of them that is alike in a stretch of even
    speed; ``counts`` (n, 2) tell that.
    """
    per_heading, ways = step_jacobians(driven, track_m)
    turned = per_heading[:, :, None] * ways[:, 2:3, :]
    first = -ways[:1] - np.cumsum(turned, axis=0) + turned[:1]
    gains = (ways[:-1] - ways[1:] + turned[1:]) * u_m
    between = _before(_between(gains, np.diff(counts, axis=0)))
    return _before(_squared(first, u_m) + between + _squared(ways, u_m))


def _between(gains: Array, steps: Array) -> Array:
    """Covariance (k, 3, 3) of errors of size 1 that come in by these gains (k, 3, 2), summed up.

    The part of them that is alike adds up in its stretch, the rest and the stretches are random.
    """
    if not len(gains):
        return np.zeros((0, 3, 3))
    start = _stretches(steps)
    part = alike(steps, start)
    alone = np.cumsum(_squared(gains * np.sqrt(1 - part)[:, None, :], np.ones(2)), axis=0)
    sums = _before(np.cumsum(gains, axis=0))
    stretch = _squared((sums[1:] - sums[start]) * np.sqrt(part)[:, None, :], np.ones(2))
    last = np.append(np.diff(start) > 0, False)
    done = _before(np.cumsum(np.where(last[:, None, None], stretch, 0.0), axis=0))[:-1]
    return np.asarray(alone + done + stretch)


def _stretches(steps: Array) -> Array:
    """Of each sample between (k,), where its stretch of even speed began; steps (k + 1, 2) [marks].

    It ends where a step has two marks more or less than the one before, for counting alone makes
    one, and where a wheel turns back.
    """
    rows = np.arange(len(steps))[:, None]
    moved = np.maximum.accumulate(np.where(steps != 0, rows, 0), axis=0)
    ahead = np.take_along_axis(np.sign(steps), moved, axis=0)
    new = np.any((np.abs(np.diff(steps, axis=0)) > 1) | (np.diff(ahead, axis=0) != 0), axis=1)
    return np.maximum.accumulate(np.where(new, np.arange(len(new)), 0))


def alike(steps: Array, start: Array) -> Array:
    """Which part of the variance of counting errors is alike in a stretch so far (k, 2).

    At f marks a step the error is a saw of harmonics q, 6/(π·q)² of its variance each. Of one of
    them the mean of n keeps sin²(π·n·q·f)/(n·sin(π·q·f))²: all of it where q·f is a whole number,
    for then the samples meet the marks always at the same places. Of independent ones it keeps 1/n.
    Where each mark has its sample, the marks of both wheels pass in one order, until the faster one
    has gained a mark.
    """
    counts = _before(np.cumsum(steps, axis=0))
    at = np.arange(len(start))
    n = (at - start + 1.0)[:, None]
    rate = (counts[at + 1] - counts[start + 1]) / np.maximum(n - 1, 1)
    found = np.zeros_like(rate)
    for q in range(1, _HARMONICS + 1):
        found += 6 / (math.pi * q) ** 2 * _kept(q * rate, n)
    # a gain is known to one mark
    gained = np.maximum(np.abs(np.abs(rate[:, 1:]) - np.abs(rate[:, :1])) - 1 / n, 0)
    slow = np.all(np.abs(rate) <= 1, axis=1, keepdims=True)
    found = np.where(slow, np.maximum(found, _kept(gained, n) / 2), found)
    return np.asarray(np.clip((n * found - 1) / np.maximum(n - 1, 1), 0, 1))


def _kept(rate: Array, n: Array) -> Array:
    """What the mean of n values of a frequency keeps of their variance, its own beat averaged."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.minimum(1.0, 0.5 / (n * np.sin(math.pi * rate)) ** 2))


def of_noise(driven: Arcs, track_m: float, u_m: Array) -> Array:
    """Covariance (n, 3, 3) where the ways of the steps have independent errors of u (m, 2) [m].

    An error in step i turns all that follows: G_i + (Q_N - Q_i)·g, with Q the sums of what a
    heading does and g the turn of a way.
    """
    per_heading, ways = step_jacobians(driven, track_m)
    turn = ways[0, 2]
    so_far = np.cumsum(per_heading, axis=0)
    own = ways - so_far[:, :, None] * turn
    alone = np.cumsum(_squared(own, u_m), axis=0)
    mixed = np.cumsum(np.einsum("kiw,kw,w->ki", own, u_m**2, turn), axis=0)
    common = np.cumsum(u_m**2 @ turn**2)
    crossed = np.einsum("ki,kj->kij", so_far, mixed)
    both = common[:, None, None] * np.einsum("ki,kj->kij", so_far, so_far)
    return _before(alone + crossed + np.swapaxes(crossed, 1, 2) + both)


def _squared(gain: Array, u: Array) -> Array:
    """Covariances (k, 3, 3) of independent errors that come in by these gains (k, 3, 2)."""
    scaled = gain * (u if u.ndim == 1 else u[:, None, :])
    return np.asarray(scaled @ np.swapaxes(scaled, 1, 2))
