"""A window of time in a recording, both ends included."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.trajectory import Array

#: sample times are multiples of a step, and a window's edge may miss one by rounding only
ROUNDING = 1e-9


def samples(time_s: Array, options: Mapping[str, float]) -> slice:
    """The samples from ``start_s`` to ``end_s`` of a measure's options."""
    start_s, end_s = options["start_s"], options["end_s"]
    slack_s = ROUNDING * max(abs(start_s), abs(end_s))
    first = np.searchsorted(time_s, start_s - slack_s, side="left")
    behind = np.searchsorted(time_s, end_s + slack_s, side="right")
    return slice(int(first), int(behind))
