"""Where a sensor lay still in a recording, and what it read there on average.

A recording is cut into blocks of half a second. A block is still where no axis scatters much more
than in the quietest blocks, and where its mean is that of the block before. Means of blocks scatter
by more than white noise would make them, for offsets wander: so their scatter within poses, pooled
over all of them, tells the standard uncertainty of a pose's mean.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.hardware.sensors.calibrated import Readings
from simcompare.hardware.sensors.six_position import nearest
from simcompare.model.trajectory import Array

#: length of a block, and blocks that a pose has at least; one at each end is left out [s]
BLOCK_S, FEWEST = 0.5, 4
#: a still block scatters by at most so much more than the quietest tenth of them
OVER_QUIET = 2.0
#: and by at most so much at all [m/s²]; cheap sensors scatter by 0.05
MOST_M_S2 = 0.15
#: the direction of two blocks of one pose differs by at most this [rad]
SAME_RAD = np.radians(1.0)


@dataclass(frozen=True, eq=False)
class StillPose:
    """One stretch at rest.

    Attributes:
        start_s: where it begins.
        end_s: where it ends.
        blocks: means of its blocks (b, 3) [m/s²].
    """

    start_s: float
    end_s: float
    blocks: Array

    @property
    def mean(self) -> Array:
        """What it read (3,) [m/s²]."""
        return np.asarray(self.blocks.mean(axis=0), dtype=float)


def find(time_s: Array, force_m_s2: Array) -> tuple[StillPose, ...]:
    """Stretches at which an accelerometer lay still.

    Args:
        time_s: times (n,) [s].
        force_m_s2: its readings (n, 3).

    Raises:
        InputError: none is found.
    """
    starts = np.arange(time_s[0], time_s[-1] - BLOCK_S, BLOCK_S)
    edges = np.searchsorted(time_s, [*starts, starts[-1] + BLOCK_S] if len(starts) else [])
    parts = [force_m_s2[a:b] for a, b in itertools.pairwise(edges)]
    if len(parts) < FEWEST:
        raise InputError("still poses", [f"the recording is shorter than {FEWEST * BLOCK_S:g} s"])
    with np.errstate(invalid="ignore"):
        means = np.array([part.mean(axis=0) if len(part) else [np.nan] * 3 for part in parts])
        spread = np.array([part.std(axis=0).max() if len(part) else np.nan for part in parts])
    found = [
        StillPose(float(starts[a]), float(starts[b - 1] + BLOCK_S), means[a:b])
        for a, b in _stretches(_still(spread), means)
    ]
    if not found:
        cure = f"let the sensor lie still for {FEWEST * BLOCK_S + 1:g} s or more in each pose"
        raise InputError("still poses", [f"none was found; {cure}"])
    return tuple(found)


def readings_of(poses: tuple[StillPose, ...]) -> Readings:
    """Means with their uncertainty; a pose near an axis has its name, others have numbers."""
    names = tuple(
        nearest(pose.mean) or f"pose {number}" for number, pose in enumerate(poses, start=1)
    )
    left = np.concatenate([pose.blocks - pose.mean for pose in poses])
    dof = sum(len(pose.blocks) - 1 for pose in poses)
    scatter = np.sqrt(np.sum(left**2, axis=0) / dof)
    u = np.array([scatter / np.sqrt(len(pose.blocks)) for pose in poses])
    told = f"the scatter of means over {BLOCK_S:g} s within the poses"
    return Readings(names, np.array([pose.mean for pose in poses]), u, told, float(dof))


def _still(spread: Array) -> NDArray[np.bool_]:
    known = spread[np.isfinite(spread)]
    if not len(known):
        return np.zeros(len(spread), dtype=bool)
    quiet = float(np.quantile(known, 0.1))
    return np.asarray(spread <= min(OVER_QUIET * quiet, MOST_M_S2))


def _stretches(still: NDArray[np.bool_], means: Array) -> list[tuple[int, int]]:
    """First and one past the last block of each pose, without those at its ends."""
    found, first = [], 0
    for k in range(1, len(still) + 1):
        goes_on = k < len(still) and still[k] and still[k - 1] and _alike(means[k - 1], means[k])
        if not goes_on:
            if still[first] and k - first >= FEWEST + 2:
                found.append((first + 1, k - 1))
            first = k
    return found


def _alike(before: Array, after: Array) -> bool:
    cosine = before @ after / (np.linalg.norm(before) * np.linalg.norm(after))
    return bool(cosine >= np.cos(SAME_RAD))
