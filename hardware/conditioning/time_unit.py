"""Times of the samples in seconds."""

from __future__ import annotations

import numpy as np

from simcompare import units
from simcompare.hardware.conditioning.work import Work


def check(work: Work) -> None:
    """Makes ``work.time_s``."""
    stream = work.stream
    if stream.time is None:
        if stream.increment_s is not None:
            work.time_s = stream.start_s + np.arange(len(stream)) * stream.increment_s
        return
    column = stream.column(stream.time)
    factor, _, _ = units.si_of(column.unit or "s", "time")
    work.time_s = column.values * factor
