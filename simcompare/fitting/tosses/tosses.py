"""Tosses of a box in a recording: poses, where each one starts, how far a replay is off, the scale.

The errors are those of Acosta, Yang and Posa (IEEE Robotics and Automation Letters 7 (2022) 6471,
arXiv:2110.00541), as their published code has them: the distance of the centres over the width of
the box, and the angle between the orientations, each the mean over the samples of a toss; a table
gives mean and standard deviation of these over the tosses.
"""

from __future__ import annotations

import itertools
import math
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from simcompare.errors import InputError
from simcompare.model.rotations import (
    conjugate,
    multiply,
    quaternions_of,
    rotate,
    rotation_vectors_of,
)
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_tosses import Witness

#: fewest samples in flight from which a start is read
MIN_IN_FLIGHT = 5
#: part of the width by which the lowest corner is clear of the table in flight
CLEAR = 0.01
#: samples at the end of a toss that tell the height of rest, and the fastest motion there [m/s]
LAST, AT_REST_M_S = 10, 0.02
#: largest part of gravity that the air takes: buoyancy, added mass and drag of a light hollow box
AIR = 0.008


@dataclass(frozen=True)
class Toss:
    """Poses of one toss.

    Attributes:
        name: its stream in the recording.
        time_s: times from its first sample on (n,) [s].
        position_m: of the centre (n, 3), above the table.
        orientation_wxyz: from the frame of the box to the world (n, 4).
    """

    name: str
    time_s: Array
    position_m: Array
    orientation_wxyz: Array

    def scaled(self, scale: float) -> Toss:
        """The toss with lengths that were measured ``scale`` times too long put right."""
        return replace(self, position_m=self.position_m / scale)


@dataclass(frozen=True)
class Start:
    """State of a box at the first sample of a toss; rates about its own axes."""

    position_m: Array
    orientation_wxyz: Array
    velocity_m_s: Array
    rate_rad_s: Array


class Errors(NamedTuple):
    """Mean errors of one toss over its samples.

    Attributes:
        position: distance of the centres [% of the width].
        rotation: angle between the orientations [deg].
        corners: root mean square distance of the eight corners [% of the width]: both in one.
    """

    position: float
    rotation: float
    corners: float


def split(
    tosses: Sequence[Toss], train: int, test: int, seed: int
) -> tuple[list[Toss], list[Toss]]:
    """Two parts of tosses that share none, the same for the same seed.

    Raises:
        InputError: there are too few.
    """
    if train + test > len(tosses):
        raise InputError("tosses", [f"{train} + {test} are wanted and {len(tosses)} are there"])
    order = np.random.default_rng(seed).permutation(len(tosses)).tolist()
    return [tosses[i] for i in order[:train]], [tosses[i] for i in order[train : train + test]]


def corners(width_m: float) -> Array:
    """Places of the eight corners of a cube in its own frame (8, 3)."""
    return np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * width_m


def lowest_m(toss: Toss, width_m: float) -> Array:
    """Height of the lowest corner above the table (n,)."""
    turned = [rotate(toss.orientation_wxyz, np.tile(c, (len(toss.time_s), 1)))[:, 2]
              for c in corners(width_m)]  # fmt: skip
    return np.asarray(toss.position_m[:, 2] + np.min(turned, axis=0), dtype=float)


def samples_in_flight(toss: Toss, width_m: float) -> int:
    """Samples before the first touch, which may come and go between two of them."""
    low = lowest_m(toss, width_m) - CLEAR * width_m
    ahead = low - np.maximum(-np.diff(low, prepend=low[0]), 0.0)
    touches = ahead <= 0
    if not touches.any():
        return len(low)
    first = int(np.argmax(touches))
    return first + bool(low[first] > 0)


def start_of(toss: Toss, width_m: float, gravity_m_s2: float) -> Start:
    """The start, from a parabola and a constant rate laid through the samples in flight.

    The rate is constant as all moments of inertia of a cube are equal. Where too few samples are in
    flight, the first ones are taken all the same.
    """
    count = max(samples_in_flight(toss, width_m), MIN_IN_FLIGHT)
    time_s, place = toss.time_s[:count], toss.position_m[:count]
    fall = np.outer(time_s**2 / 2, (0.0, 0.0, -gravity_m_s2))
    line = np.column_stack((np.ones(count), time_s))
    (origin, velocity), *_ = np.linalg.lstsq(line, place - fall, rcond=None)
    # turned back by the first orientation, all turns are small ones about one axis
    first = np.repeat(toss.orientation_wxyz[:1], count, axis=0)
    turns = rotation_vectors_of(multiply(conjugate(first), toss.orientation_wxyz[:count]))
    (offset, rate), *_ = np.linalg.lstsq(line, turns, rcond=None)
    turn = multiply(toss.orientation_wxyz[:1], quaternions_of(offset[None]))[0]
    return Start(origin, turn, velocity, rate)


def errors(toss: Toss, position_m: Array, orientation_wxyz: Array, width_m: float) -> Errors:
    """How far a replay is off, at the samples of the toss.

    Args:
        toss: what was measured.
        position_m: of the replay (n, 3).
        orientation_wxyz: of the replay (n, 4).
        width_m: of the box.
    """
    away = position_m - toss.position_m
    between = multiply(orientation_wxyz, conjugate(toss.orientation_wxyz))
    angles = np.linalg.norm(rotation_vectors_of(between), axis=1)
    # corners of a cube: |away|² + the mean over them of |turn·c - c|²; the cross terms cancel
    spread = (2 * np.sin(angles / 2)) ** 2 * width_m**2 / 2
    distance = np.linalg.norm(away, axis=1)
    return Errors(
        100 * float(distance.mean()) / width_m,
        math.degrees(float(angles.mean())),
        100 * float(np.sqrt(distance**2 + spread).mean()) / width_m,
    )


def witnesses(tosses: Iterable[Toss], width_m: float, gravity_m_s2: float) -> tuple[Witness, ...]:
    """The length scale by two measurements that share nothing: gravity, and the height of rest.

    Args:
        tosses: as measured.
        width_m: of the box, measured otherwise.
        gravity_m_s2: where the tosses were made.

    Raises:
        InputError: too few tosses fly or come to rest.
    """
    found = list(tosses)
    falls = [fall for toss in found if (fall := _fall(toss, width_m)) is not None]
    rests = [rest for toss in found if (rest := _rest(toss)) is not None]
    if min(len(falls), len(rests)) < 3:
        raise InputError(
            "the length scale", [f"{len(falls)} tosses fly and {len(rests)} rest; expected 3"]
        )
    gravity, u_gravity = statistics.fmean(falls), statistics.stdev(falls) / math.sqrt(len(falls))
    air = gravity * AIR / math.sqrt(3)
    faces: dict[int, list[float]] = {}
    for face, height in rests:
        faces.setdefault(face, []).append(height)
    levels = [statistics.fmean(heights) for heights in faces.values()]
    level = statistics.fmean(levels)
    # what lies under a face and what is within differs from face to face; the rest is common
    u_level = statistics.stdev(levels) / math.sqrt(len(levels)) if len(levels) > 1 else 0.0
    scatter = statistics.stdev(height for _, height in rests)
    return (
        Witness(
            "gravity", gravity / gravity_m_s2, math.hypot(u_gravity, air) / gravity_m_s2,
            f"{len(falls)} flights fall with {gravity:.4f} m/s², u = {u_gravity:.4f}; the air takes"
            f" up to {AIR:.1%}, for which nothing is added, rectangular",
        ),
        Witness(
            "height of rest", 2 * level / width_m, 2 * math.hypot(u_level, scatter) / width_m,
            f"{len(rests)} tosses rest at {1000 * level:.3f} mm on {len(levels)} faces; u from what"
            f" tosses scatter by, {1000 * scatter:.2f} mm, as the table's own zero is not known",
        ),
    )  # fmt: skip


def combined(found: Sequence[Witness]) -> Witness:
    """Mean of witnesses, weighted by their uncertainties."""
    weights = [1 / witness.u**2 for witness in found]
    total = sum(weights)
    scale = sum(w * one.scale for w, one in zip(weights, found, strict=True)) / total
    names = " and ".join(one.name for one in found)
    return Witness("both", scale, 1 / math.sqrt(total), f"weighted mean of {names}")


def _fall(toss: Toss, width_m: float) -> float | None:
    """Acceleration in flight [m/s²]; ``None`` where the flight is too short to tell."""
    count = samples_in_flight(toss, width_m)
    if count < 2 * MIN_IN_FLIGHT:
        return None
    return -2 * float(np.polyfit(toss.time_s[:count], toss.position_m[:count, 2], 2)[0])


def _rest(toss: Toss) -> tuple[int, float] | None:
    """Which face is up and how high the centre rests [m]; ``None`` where it still moves."""
    place, turn = toss.position_m[-LAST:], toss.orientation_wxyz[-LAST:]
    way = np.linalg.norm(place[-1] - place[0])
    if len(place) < LAST or way > AT_REST_M_S * (toss.time_s[-1] - toss.time_s[-LAST]):
        return None
    up = rotate(conjugate(turn[-1:]), np.array([[0.0, 0.0, 1.0]]))[0]
    axis = int(np.argmax(np.abs(up)))
    return 2 * axis + int(up[axis] > 0), float(np.median(place[:, 2]))
