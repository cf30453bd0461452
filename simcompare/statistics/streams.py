"""Independent streams of random numbers, one for each name.

A stream depends on the seed and on its own names alone. So what one sensor draws stays the same
when another sensor is added, taken away or read in another order.
"""

from __future__ import annotations

import hashlib

import numpy as np


def stream(seed: int, *names: str | int) -> np.random.Generator:
    """The stream of one device, channel or repeat.

    Args:
        seed: of all streams of a run, 0 or more.
        names: whose stream it is, for example ``"imu", "specific_force_m_s2", "noise"``.
    """
    key = "\x1f".join(map(str, names)).encode()
    words = np.frombuffer(hashlib.sha256(key).digest(), dtype="<u4")
    sequence = np.random.SeedSequence(seed, spawn_key=tuple(words.tolist()))
    return np.random.Generator(np.random.PCG64(sequence))
