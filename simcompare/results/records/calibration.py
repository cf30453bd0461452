"""What calibration.json says of a calibrated sensor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from simcompare.hardware.sensors.calibration import Assumption, Calibration, Pose
from simcompare.model.plain import Finite
from simcompare.results.records.run import Software

#: version of what is stored
FORMAT = 1
Row = tuple[float, ...]
Rows = tuple[Row, ...]
_MATRICES = ("sensitivity", "u_sensitivity", "covariance")
_ROWS = ("offset", "u_offset", "degrees_of_freedom", "noise")


@dataclass(frozen=True)
class PoseRecord:
    """One pose; see :class:`~simcompare.hardware.sensors.calibration.Pose`."""

    name: str
    size: Finite
    reading: Row
    before: Finite
    after: Finite
    u_after: Finite
    fitted: bool


@dataclass(frozen=True)
class Truth:
    """What is true of a simulated device, seen from its box.

    Attributes:
        device: what was simulated.
        sensitivity: S.
        offset: O.
    """

    device: str
    sensitivity: Rows
    offset: Row


@dataclass(frozen=True, kw_only=True)
class CalibrationRecord:
    """A calibration in plain values.

    Attributes:
        format: version of what is stored.
        created: date and time, ISO 8601.
        source: log, table, recording or simulated device.
        kind: "six-position", "ellipsoid", "rate-table" or "two-point".
        unit: of readings, offset and poses.
        sensitivity: S; a reading is S·f + O.
        u_sensitivity: standard uncertainties of its terms.
        offset: O.
        u_offset: standard uncertainties of its terms.
        covariance: of the rows of S one after the other, then O.
        shares: source of uncertainty -> its part of the covariance.
        degrees_of_freedom: of each of these parameters; ``None`` where without limit.
        noise: standard uncertainty of one pose's mean reading, each axis.
        noise_from: where that came from.
        chi2: of what the fit leaves; ``None`` where that told the noise.
        expected_chi2: number of readings less that of parameters.
        condition: of the poses.
        not_separable: what these readings cannot tell apart.
        assumptions: what was taken as known.
        poses: what each pose is off by, before and after.
        truth: of a simulated device.
        software: versions.
        folder: where it is stored, ``None`` where it is not.
        applied: recording that was corrected with it, ``None`` for none.
    """

    format: int = FORMAT
    created: str
    source: str
    kind: str
    unit: str
    sensitivity: Rows
    u_sensitivity: Rows
    offset: Row
    u_offset: Row
    covariance: Rows
    shares: Mapping[str, Rows]
    degrees_of_freedom: tuple[Finite, ...]
    noise: Row
    noise_from: str
    chi2: float | None
    expected_chi2: float
    condition: float
    not_separable: tuple[str, ...]
    assumptions: tuple[Assumption, ...]
    poses: tuple[PoseRecord, ...]
    truth: Truth | None = None
    software: Software
    folder: Path | None = None
    applied: Path | None = None

    @property
    def calibration(self) -> Calibration:
        """What corrects readings."""
        dof = np.nan_to_num(np.array(self.degrees_of_freedom, dtype=float), nan=np.inf)
        poses = (Pose(**{**vars(one), "reading": np.array(one.reading)}) for one in self.poses)
        return Calibration(
            self.kind, self.unit, np.array(self.sensitivity), np.array(self.offset),
            np.array(self.covariance), {k: np.array(v) for k, v in self.shares.items()}, dof,
            np.array(self.noise), self.noise_from, self.chi2, self.expected_chi2, self.condition,
            self.not_separable, self.assumptions, tuple(poses),
        )  # fmt: skip


def rows_of(matrix: np.ndarray) -> Rows:
    """A matrix as plain rows."""
    return tuple(tuple(map(float, row)) for row in matrix)


def plain_of(found: Calibration) -> dict[str, Any]:
    """What a record holds of a calibration."""
    return {
        **vars(found),
        **{name: rows_of(getattr(found, name)) for name in _MATRICES},
        **{name: tuple(map(float, getattr(found, name))) for name in _ROWS},
        "shares": {name: rows_of(share) for name, share in found.shares.items()},
        "poses": tuple(
            PoseRecord(**{**vars(pose), "reading": tuple(map(float, pose.reading))})
            for pose in found.poses
        ),
    }
