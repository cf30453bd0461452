"""Coverage factors of the terms of a calibration."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from simcompare.hardware.sensors.calibration import COVERAGE
from simcompare.hardware.sensors.linear_fit import NOISE
from simcompare.results.records.calibration import CalibrationRecord
from simcompare.statistics import coverage

#: part of the variance of a term below which a source is none of it
_NONE = 1e-6


def kinds(record: CalibrationRecord) -> Mapping[str, Sequence[int]]:
    """Kind of a term -> its places in the covariance."""
    k = len(record.offset)
    found = {
        "scale": [*range(0, k * k, k + 1)],
        "cross-axis": [i for i in range(k * k) if i % (k + 1)],
        "offset": [*range(k * k, k * k + k)],
    }
    return {kind: places for kind, places in found.items() if places}


def factors(record: CalibrationRecord) -> dict[str, float]:
    """Kind of a term -> k for 95 %, of the least certain term of that kind."""
    return {
        kind: _factor(record, max(places, key=lambda i: record.covariance[i][i]))
        for kind, places in kinds(record).items()
    }


def _factor(record: CalibrationRecord, place: int) -> float:
    """K of one term: rectangular sources as they are, all else normal or of Student's t."""
    shapes = {one.quantity: one.shape for one in record.assumptions}
    total = record.covariance[place][place]
    parts = {name: rows[place][place] for name, rows in record.shares.items()}
    bounded = [
        math.sqrt(part)
        for name, part in parts.items()
        if shapes.get(name) == "rectangular" and part > _NONE * total
    ]
    rest = max(total - float(np.sum(np.square(bounded))), 0.0)
    degrees = record.degrees_of_freedom[place]
    if not math.isfinite(degrees) or rest <= _NONE * total:
        return coverage.factor(math.sqrt(rest), math.inf, bounded, COVERAGE)
    # what is left beside the rectangular sources, once the noise alone has few (G.4)
    noise = degrees * (parts[NOISE] / total) ** 2
    return coverage.factor(math.sqrt(rest), noise * (rest / parts[NOISE]) ** 2, bounded, COVERAGE)
