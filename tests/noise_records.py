"""Records of noise whose truth is known."""

from __future__ import annotations

import numpy as np

from simcompare.model.trajectory import Array

#: NBS Monograph 140, annex 8.E
NBS14_PHASE = np.array(
    [0, 103.11111, 123.22222, 157.33333, 166.44444, 48.55555, -96.33333, -2.22222, 111.88889, 0.0]
)


def thousand_points() -> Array:
    """The rates of NIST SP 1065, 12.4."""
    number, values = 1234567890, []
    for _ in range(1000):
        values.append(number / 2147483647)
        number = 16807 * number % 2147483647
    return np.array(values)
