"""Samples: those of a window of time, evenly spaced ones, and what two sources have apart there."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array

#: sample times are multiples of a step, and a window's edge may miss one by rounding only
ROUNDING = 1e-9


def samples(time_s: Array, options: Mapping[str, float]) -> slice:
    """The samples from ``start_s`` to ``end_s`` of a measure's options."""
    start_s, end_s = options["start_s"], options["end_s"]
    slack_s = ROUNDING * max(abs(start_s), abs(end_s))
    first = np.searchsorted(time_s, start_s - slack_s, side="left")
    behind = np.searchsorted(time_s, end_s + slack_s, side="right")
    return slice(int(first), int(behind))


def same(times_s: Array, others_s: Array) -> bool:
    """Whether two sources were sampled at the same times."""
    alike = len(times_s) == len(others_s)
    return alike and bool(np.allclose(times_s, others_s, rtol=1e-9, atol=1e-12))


def largest(errors: Array) -> float | None:
    """Largest error to either side; ``None`` where there is none at all."""
    return float(np.abs(errors).max()) if len(errors) else None


def evenly(samples: int, count: float) -> NDArray[np.intp]:
    """Places of ``count`` evenly spaced samples, the first and the last among them.

    All of them where there are fewer, and one where less than one is asked for.
    """
    taken = max(1, min(round(count), samples))
    return np.linspace(0, samples - 1, taken).round().astype(np.intp)
