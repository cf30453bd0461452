"""When a device was at rest, told by how little a vector changed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.hardware.conditioning.units.meaning import Claim
from simcompare.hardware.conditioning.work import Work
from simcompare.model.trajectory import Array

#: length of the segments that are called quiet or not [s]
SEGMENT_S = 0.5
_MIN_SAMPLES, _MIN_SEGMENTS = 4, 4
#: parts of a long log that are looked at where a part is enough, and samples in each
_PARTS, _PART = 16, 1 << 16
#: a segment is quiet when its scatter is at most so many times that of the quietest tenth
_QUIET = 3.0


@dataclass(frozen=True)
class Rest:
    """The quiet part of a vector.

    Attributes:
        vector: median over the quiet segments (3,).
        size: median magnitude of their means.
        spread: how far the magnitudes differ, in parts of ``size``.
        scatter: median standard deviation within a segment, all three axes together.
        segments: number of quiet segments.
    """

    vector: Array
    size: float
    spread: float
    scatter: float
    segments: int

    @property
    def steady(self) -> bool:
        """Whether one vector of the same length was there all the time, as gravity is."""
        return self.size > 0 and self.spread < 0.1 and self.scatter < 0.2 * self.size


def excerpts(count: int) -> list[slice]:
    """The whole of a short log, evenly spread parts of a long one."""
    if count <= _PARTS * _PART:
        return [slice(0, count)]
    starts = np.linspace(0, count - _PART, _PARTS).astype(int)
    return [slice(int(start), int(start) + _PART) for start in starts]


def segments(
    columns: Sequence[Callable[[slice], Array]], parts: Iterable[slice], size: int
) -> tuple[Array, Array]:
    """Means (k, c) and variances (k, c) of columns over segments of ``size`` samples."""
    means, variances = [np.empty((0, len(columns)))], [np.empty((0, len(columns)))]
    for part in parts:
        values = np.stack([column(part) for column in columns], axis=1)
        end = len(values) // size * size
        cut = values[:end].reshape(-1, size, len(columns))
        means.append(cut.mean(axis=1))
        variances.append(cut.var(axis=1))
    return np.concatenate(means), np.concatenate(variances)


def samples_in(work: Work, length_s: float) -> int:
    """Samples in a time; fewer in a short stream."""
    count = len(work.time_s)
    step = float(work.time_s[-1] - work.time_s[0]) / max(1, count - 1)
    wanted = round(length_s / step) if step > 0 else _MIN_SAMPLES
    return max(_MIN_SAMPLES, min(wanted, count // (2 * _MIN_SEGMENTS)))


def rest(work: Work, triad: Sequence[Claim]) -> Rest | None:
    """The quiet part, ``None`` where the stream is too short to tell."""
    size = samples_in(work, SEGMENT_S)
    mean, variance = segments([claim.values for claim in triad], [slice(None)], size)
    finite = np.isfinite(mean).all(axis=1) & np.isfinite(variance).all(axis=1)
    mean, variance = mean[finite], variance[finite]
    if len(mean) < _MIN_SEGMENTS:
        return None
    scatter = np.sqrt(variance.sum(axis=1))
    quiet = scatter <= _QUIET * np.quantile(scatter, 0.1)
    length = np.linalg.norm(mean[quiet], axis=1)
    middle = float(np.median(length))
    low, high = np.quantile(length, (0.1, 0.9))
    return Rest(
        np.median(mean[quiet], axis=0), middle,
        float(high - low) / middle if middle > 0 else 0.0,
        float(np.median(scatter[quiet])), int(quiet.sum()),
    )  # fmt: skip
