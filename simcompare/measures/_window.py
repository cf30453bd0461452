"""Which samples of a recording are taken: those of a window of time, or evenly spaced ones."""

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


def evenly(samples: int, count: float) -> NDArray[np.intp]:
    """Places of ``count`` evenly spaced samples, the first and the last among them.

    All of them where there are fewer, and one where less than one is asked for.
    """
    taken = max(1, min(round(count), samples))
    return np.linspace(0, samples - 1, taken).round().astype(np.intp)
