"""Whether a gyroscope turns gravity over the accelerometer as gravity does turn.

What the gyroscope tells is integrated to rotations over spans of a second or two; each should
carry the specific force at the span's begin into that at its end. Axes that are named or counted
otherwise, and other units, are tried the same way.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simcompare import units
from simcompare.hardware.conditioning.units.meaning import Claim
from simcompare.hardware.conditioning.units.rest import excerpts, samples_in, segments
from simcompare.hardware.conditioning.work import Work
from simcompare.model.trajectory import Array

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Indices = NDArray[np.int64]
#: length of the segments of which the mean is taken, and of the spans that are compared [s]
_SEGMENT_S, _MIN_SPAN_S, _MAX_SPAN_S = 0.02, 0.25, 3.0
#: a specific force is gravity where its size is so near to the median
_NEAR_GRAVITY = 0.1
#: a span counts where gravity moved by so much of itself: 6°
_MOVED = 0.1
_MIN_SEGMENTS = 50
#: readings of a gyroscope that explain equally well within so much
_EQUAL = 0.05
_UNITS = ("rad/s", "deg/s", "turn/s", "turn/min")


@dataclass(frozen=True)
class Turning:
    """How a gyroscope fits to an accelerometer.

    Attributes:
        as_it_is: part of gravity's motion over the axes that the gyroscope explains; 1 is all.
        best: the same in the best reading.
        axes: that reading: true rate = axes · given rate.
        unit: unit that the numbers have in that reading, empty for the declared one.
    """

    as_it_is: float
    best: float
    axes: Array
    unit: str


@dataclass(frozen=True)
class _Motion:
    force: Array
    angle: Array
    broken: NDArray[np.bool_]
    step_s: float
    gravity: float


def compare(work: Work, force: Sequence[Claim], turn: Sequence[Claim]) -> Turning | None:
    """The best reading of a gyroscope; ``None`` where gravity hardly turned."""
    motion = _motion(work, force, turn)
    if motion is None:
        return None
    unchanged = np.eye(3)
    plain = _explained(motion, 1.0, [unchanged])
    if plain is None:
        return None
    results = [(plain[0], unchanged, "")]
    if plain[0] < 1 - _EQUAL:
        declared = turn[0].unit_si
        factors = {unit: units.si_of(unit, "")[0] / declared for unit in _UNITS}
        others = {u: f for u, f in factors.items() if not math.isclose(f, 1.0)}
        for unit, factor in {"": 1.0, **others}.items():
            axes = signed_permutations()
            parts = _explained(motion, factor, axes)
            results += [(e, a, unit) for e, a in zip(parts or (), axes, strict=False)]
    top = max(explained for explained, _, _ in results)
    # of equals the one nearest to what is there: an axis that hardly turned says nothing
    best = max(
        (r for r in results if r[0] >= top - _EQUAL), key=lambda r: (not r[2], np.trace(r[1]))
    )
    return Turning(plain[0], *best)


def rotations() -> list[Array]:
    """The 24 rotations that bring axes onto axes, right-handed all."""
    return [turn for turn in signed_permutations() if np.linalg.det(turn) > 0]


def signed_permutations() -> list[Array]:
    """All 48 ways to name and count three axes."""
    made = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), order] = signs
            made.append(matrix)
    return made


def _motion(work: Work, force: Sequence[Claim], turn: Sequence[Claim]) -> _Motion | None:
    size = samples_in(work, _SEGMENT_S)
    columns = [claim.values for claim in (*force, *turn)]
    parts = excerpts(len(work.time_s))
    mean, _ = segments([*columns, lambda part: np.asarray(work.time_s[part])], parts, size)
    if len(mean) < _MIN_SEGMENTS:
        return None
    step = np.diff(mean[:, 6])
    usual = float(np.median(step))
    angle = 0.5 * (mean[1:, 3:6] + mean[:-1, 3:6]) * step[:, None]
    # what is missing, a gap, the border of two parts: no turn is known there
    broken = ~np.isfinite(angle).all(axis=1) | (np.abs(step - usual) > 0.5 * usual)
    angle[broken] = 0.0
    length = np.linalg.norm(mean[:, :3], axis=1)
    gravity = float(np.nanmedian(length)) if np.isfinite(length).any() else 0.0
    if not (usual > 0 and gravity > 0):
        return None
    return _Motion(mean[:, :3], angle, broken, usual, gravity)


def _explained(motion: _Motion, factor: float, axes: Sequence[Array]) -> list[float] | None:
    """Part of gravity's motion that is explained with each way to name the axes."""
    moved, unexplained = 0.0, np.zeros(len(axes))
    count = 0
    both = list(zip(_spans(motion, factor), _spans(motion, -factor), strict=True))
    for (first, end, turned), (_, _, mirrored) in both:
        before, after = motion.force[first], motion.force[end]
        moved += float(np.sum((after - before) ** 2))
        count += len(first)
        for i, matrix in enumerate(axes):
            # a rotation about renamed axes is the same rotation, seen in other axes; a mirrored
            # set of axes turns the other way
            hand = np.linalg.det(matrix)
            rotation = turned if hand > 0 else mirrored
            predicted = rotation.apply(before @ (hand * matrix), inverse=True) @ (hand * matrix).T
            unexplained[i] += float(np.sum((after - predicted) ** 2))
    if count < _MIN_SEGMENTS:
        return None
    return [float(1 - rest / moved) for rest in unexplained]


def _spans(motion: _Motion, factor: float) -> Iterator[tuple[Indices, Indices, Rotation]]:
    """First and last segment of the spans in which gravity moved, and the rotation over each."""
    from scipy.spatial.transform import Rotation

    steps = 1
    turned = Rotation.from_rotvec(motion.angle * factor)
    bad = np.concatenate(([0], np.cumsum(motion.broken)))
    size = np.linalg.norm(motion.force, axis=1)
    calm = np.abs(size - motion.gravity) < _NEAR_GRAVITY * motion.gravity
    while steps * motion.step_s <= _MAX_SPAN_S and len(turned) > steps:
        if steps * motion.step_s >= _MIN_SPAN_S:
            first = np.arange(len(motion.force) - steps)
            shift = np.linalg.norm(motion.force[first + steps] - motion.force[first], axis=1)
            good = calm[first] & calm[first + steps] & (bad[first + steps] == bad[first])
            good &= shift > _MOVED * motion.gravity
            yield first[good], first[good] + steps, turned[good]
        turned = turned[:-steps] * turned[steps:]
        steps *= 2
