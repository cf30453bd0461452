"""A waveform with as many points as a page shows: the lowest and highest of each short time."""

from __future__ import annotations

import numpy as np

from simcompare.lab.numbers import listed
from simcompare.model.plain import Plain
from simcompare.model.trajectory import Array

#: short times that a waveform is divided into
POINTS = 2000


def envelope(time_s: Array, values: Array, most: int = POINTS) -> Plain:
    """Begin of each short time, and the lowest and highest value in it."""
    sound = np.nan_to_num(values)
    starts = np.unique(np.linspace(0, len(sound), min(most, len(sound)) + 1).astype(int))[:-1]
    return {
        "t": listed(np.asarray(time_s)[starts]),
        "low": listed(np.minimum.reduceat(sound, starts)),
        "high": listed(np.maximum.reduceat(sound, starts)),
    }
