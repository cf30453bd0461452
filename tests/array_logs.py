"""What the tests of array files share."""

from __future__ import annotations

import os

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.logs import importers
from simcompare.hardware.mapping import NOTHING

TIMES = np.arange(100) * 0.01
START_NS = 1_700_000_000_000_000_001


class Evil:
    """Runs a command when it is unpickled."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return os.system, (f"touch {self.mark}",)


def load(path):
    return importers.read(path, importers.recognise(path), NOTHING)


def faults(path):
    with pytest.raises(InputError) as error:
        load(path)
    assert path.name in str(error.value)
    return " | ".join(error.value.faults)


def values(log, name, stream=0):
    return log.streams[stream].column(name).values


def survives(path, kind, data, count=150, seed=3):
    """Changes and cuts a valid file; every time there are numbers or a typed error."""
    random = np.random.default_rng(seed)
    refused = 0
    for number in range(count):
        bad = bytearray(data[: random.integers(8, len(data))] if number % 3 == 0 else data)
        for at in random.integers(0, len(bad), random.integers(1, 4)):
            bad[at] = random.integers(0, 256)
        path.write_bytes(bad)
        try:
            log = importers.read(path, kind, NOTHING)
        except InputError:
            refused += 1
            continue
        assert all(len(c.values) == len(s) for s in log.streams for c in s.columns)
    return refused
