"""What a calibration says in sentences."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from simcompare.hardware.sensors.calibrated import Readings
from simcompare.hardware.sensors.calibration import COVERAGE
from simcompare.notation import number
from simcompare.reports.calibration import coverage
from simcompare.reports.render import numbers
from simcompare.reports.run.listing import joined
from simcompare.results.records.calibration import CalibrationRecord, PoseRecord
from simcompare.statistics.budget import coverage_factor
from simcompare.statistics.distributions import Distribution
from simcompare.units import symbol

#: chance of a χ² as large, below which readings and their uncertainties do not agree
_UNLIKELY = 0.01
#: k of a normal distribution, less and more than Monte Carlo may be off by
_NORMAL, _ABOVE = 1.95, 1.97
#: poses whose directions are within this are one direction [rad]
_ONE_RAD = math.radians(5.0)
#: kind -> what makes χ² too large
_TOO_LARGE = {
    "six-position": "poses are off the vertical by more than was stated, or moved",
    "ellipsoid": "a pose moved, or the sensor's characteristic is curved (non-linearity)",
    "rate-table": "rates were not held, or the offset wandered",
    "two-point": "known pressures are less sure than was stated, or the line is curved",
}


def answer(record: CalibrationRecord) -> list[str]:
    """What was found, in a few sentences."""
    return [_before_and_after(record), _terms(record), *_verified(record), *_true(record)]


def notes(record: CalibrationRecord) -> list[str]:
    """What the reader must know of it."""
    return [_agreement(record), _poses(record), *_limits(record)]


def _before_and_after(record: CalibrationRecord) -> str:
    fitted = [pose for pose in record.poses if pose.fitted]
    before, after = (_largest(fitted, which) for which in ("before", "after"))
    what = "known values" if record.kind == "two-point" else "poses"
    return (
        f"As it is, the sensor is off by up to {_size(before, record.unit)} in these {what};"
        f" once corrected, by up to {_size(after, record.unit)}"
        f" (u of a corrected reading: {_size(_u_corrected(record), record.unit)})."
    )


def _terms(record: CalibrationRecord) -> str:
    """Offset and scale errors in words."""
    sensitivity, offset = np.array(record.sensitivity), np.array(record.offset)
    scale = np.diag(sensitivity) - 1
    axes = "xyz" if len(offset) == 3 else ("",)
    scales = _listed(axes, 100 * scale, 100 * np.diag(np.array(record.u_sensitivity)))
    offsets = _listed(axes, offset, np.array(record.u_offset))
    text = f"Offset {offsets} {symbol(record.unit)}; scale error {scales} %"
    if len(offset) == 1:
        return text + "."
    cross = np.abs(sensitivity - np.diag(np.diag(sensitivity)))
    row, column = np.unravel_index(int(np.argmax(cross)), cross.shape)
    u = record.u_sensitivity[row][column]
    told = number(100 * float(cross[row, column]), 100 * u)
    return f"{text}; cross-axis terms up to {told} % ({'xyz'[column]} seen by {'xyz'[row]})."


def _listed(axes: str | tuple[str, ...], values: np.ndarray, u: np.ndarray) -> str:
    told = (
        f"{axis} {number(float(value), float(one))}".strip()
        for axis, value, one in zip(axes, values, u, strict=True)
    )
    return ", ".join(told)


def _verified(record: CalibrationRecord) -> list[str]:
    poses = [pose for pose in record.poses if not pose.fitted]
    if not poses:
        return []
    before, after = (_largest(poses, which) for which in ("before", "after"))
    k = pose_coverage(record)
    inside = sum(abs(pose.after) <= k * pose.u_after for pose in poses)
    return [
        f"In {len(poses)} other poses, which took no part, | |f| − g | was up to"
        f" {_size(before, record.unit)} and is now up to {_size(after, record.unit)};"
        f" {inside} of {len(poses)} are within their 95 % uncertainty."
    ]


def _true(record: CalibrationRecord) -> list[str]:
    if record.truth is None:
        return []
    worst = max(abs(one) for one in deviations(record))
    verdict = "all within three standard uncertainties" if worst <= 3 else "beyond three"
    return [
        f"The true S and O of this simulated device are recovered to {worst:.1f} standard"
        f" uncertainties at most: {verdict}."
    ]


def deviations(record: CalibrationRecord) -> list[float]:
    """Recovered less true, in standard uncertainties, of S row after row and then O."""
    assert record.truth is not None
    found = np.concatenate([np.ravel(record.sensitivity), record.offset])
    true = np.concatenate([np.ravel(record.truth.sensitivity), record.truth.offset])
    u = np.concatenate([np.ravel(record.u_sensitivity), record.u_offset])
    return [float(one) for one in (found - true) / u]


def _agreement(record: CalibrationRecord) -> str:
    if record.chi2 is None:
        dof = _least_dof(record)
        return (
            f"The noise of a mean reading was told by {record.noise_from}: there are few degrees of"
            f" freedom ({dof:.3g} at least), and no test of the uncertainties is left."
        )
    if not record.expected_chi2:
        return "As many readings as unknowns: nothing is left that could test the uncertainties."
    from scipy import stats

    expected = record.expected_chi2
    wanted = f"{expected:g} ± {math.sqrt(2 * expected):.2g}"
    text = f"The sum χ² is {record.chi2:.3g} where {wanted} is expected"
    if stats.chi2.sf(record.chi2, expected) < _UNLIKELY:
        return f"{text}: {_TOO_LARGE[record.kind]}. The uncertainties are too small then."
    if stats.chi2.cdf(record.chi2, expected) < _UNLIKELY:
        return f"{text}: poses scatter less than was stated; a smaller --level would fit them."
    return f"{text}: readings and their uncertainties agree."


def _poses(record: CalibrationRecord) -> str:
    if record.kind == "two-point":
        return (
            f"O is the reading at 0 {symbol(record.unit)}, far from these values, and errors of O"
            " and S go together: between the known values a corrected reading is known far better"
            " than O."
        )
    return (
        f"Condition number of the poses: {record.condition:.2g} (six positions have 1.7; beyond 100"
        " they are spread too little)."
    )


def _limits(record: CalibrationRecord) -> list[str]:
    found = coverage.factors(record)
    text = f"Uncertainties are standard uncertainties; {100 * COVERAGE:g} % intervals need"
    if _NORMAL < min(found.values()) <= max(found.values()) < _ABOVE:
        return [f"{text} k = 1.96."]
    text += f" k = {joined([f'{k:.2f} ({kind})' for kind, k in found.items()])}"
    if min(found.values()) < _NORMAL:
        text += ", less than 1.96 where a rectangular source does most of it"
    if max(found.values()) > _ABOVE:
        text += ", more where noise was told with few degrees of freedom"
    return [f"{text}."]


def pose_coverage(record: CalibrationRecord) -> float:
    """Coverage factor k that is large enough for every pose."""
    return coverage_factor(_least_dof(record), COVERAGE)


def _least_dof(record: CalibrationRecord) -> float:
    return min((d for d in record.degrees_of_freedom if math.isfinite(d)), default=math.inf)


def of_few_poses(readings: Readings, gravity: Distribution) -> str:
    """What poses tell that are too few for a calibration."""
    counts = Counter(readings.names)
    poses = ", ".join(f"{name} ({times})" for name, times in counts.items())
    sizes = np.linalg.norm(readings.means, axis=1)
    up = readings.means / sizes[:, None]
    mean = up.mean(axis=0)
    mean /= np.linalg.norm(mean)
    if float(np.min(up @ mean)) < math.cos(_ONE_RAD):
        return f"still poses that are there: {poses}"
    off = float(np.mean(sizes)) - gravity.center
    scatter = float(np.std(sizes) / math.sqrt(max(len(sizes), 1)))
    u = math.hypot(gravity.u, scatter)
    axis = "xyz"[int(np.argmax(np.abs(mean)))]
    return (
        f"all {len(sizes)} still poses lie one way ({poses}), and tell one number: readings are off"
        f" g by {number(off, u)} m/s² in size; that is an offset of {axis}, a scale error of {axis}"
        f" of {number(100 * off / gravity.center, 100 * u / gravity.center)} %, or a mixture, and"
        f" one direction cannot tell which"
    )


def _largest(poses: list[PoseRecord], which: str) -> float:
    return max((abs(float(getattr(pose, which))) for pose in poses), default=0.0)


def _u_corrected(record: CalibrationRecord) -> float:
    """Largest standard uncertainty of a corrected component in these poses."""
    readings = np.array([pose.reading for pose in record.poses])
    return float(record.calibration.u(readings).max())


def _size(value: float, unit: str) -> str:
    return f"{numbers.plain(value, 2)} {symbol(unit)}"
