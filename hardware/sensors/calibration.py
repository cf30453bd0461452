"""What a calibration knows of a sensor, and what becomes of a reading with it.

A reading is Y = S·f + O + noise: f is what acts on the sensor, in the axes of the fixture or box in
which it was calibrated, S the sensitivity with its cross-axis terms (the identity of a perfect
sensor) and O the offset. A corrected reading is S⁻¹·(Y - O).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from simcompare.errors import InputError
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import Distribution, Kind

#: two-sided coverage probability of every expanded uncertainty of a calibration
COVERAGE = 0.95


@dataclass(frozen=True, eq=False)
class Pose:
    """One standing of the sensor in its calibration, or one known value.

    Where a direction is known, what a reading is off by is taken along it, else of its size.

    Attributes:
        name: such as "+x" or "1000 hPa".
        size: of what acted on it.
        reading: mean of its readings (k,).
        before: what the reading is off by as it is.
        after: what it is off by once it is corrected.
        u_after: standard uncertainty of ``after``, without that of ``size`` where the same size
            calibrated the sensor: that cancels.
        fitted: it took part in the fit; else it only verifies.
    """

    name: str
    size: float
    reading: Array
    before: float
    after: float
    u_after: float
    fitted: bool = True


@dataclass(frozen=True)
class Assumption:
    """What was taken as known, with its uncertainty, and where that came from.

    Attributes:
        quantity: such as "local g".
        value: best estimate.
        u: its standard uncertainty.
        unit: of both.
        source: where the numbers come from.
        effect: what it does to the result.
        shape: of the distribution of what it does to one term.
    """

    quantity: str
    value: float
    u: float
    unit: str
    source: str
    effect: str
    shape: Kind = "normal"


@dataclass(frozen=True)
class Taken:
    """What is taken as known before a calibration.

    Attributes:
        known: best estimate and uncertainty.
        source: where they come from.
    """

    known: Distribution
    source: str = "as stated"

    def assumed(self, quantity: str, unit: str, effect: str) -> Assumption:
        """The same as one of the assumptions of a calibration."""
        known = self.known
        return Assumption(quantity, known.center, known.u, unit, self.source, effect, known.kind)


@dataclass(frozen=True, eq=False)
class Calibration:
    """Sensitivity and offset of one device with their uncertainty.

    Attributes:
        kind: "six-position", "ellipsoid", "rate-table" or "two-point".
        unit: SI, of readings and offset; those of the sensitivity are parts of 1.
        sensitivity: S (k, k), k is 1 or 3.
        offset: O (k,).
        covariance: of the rows of S one after the other, then O (k² + k, k² + k).
        shares: source of uncertainty -> its part of the covariance; they add up to it.
        degrees_of_freedom: of each of these parameters (Welch-Satterthwaite), infinite where all
            their uncertainty is known beforehand.
        noise: standard uncertainty of the mean reading of one pose (k,).
        noise_from: where that number came from.
        chi2: sum of squared residuals, each over its standard uncertainty;
            ``None`` where they told the noise.
        expected_chi2: number of readings less that of parameters; its scatter is √(2·it).
        condition: ratio of the largest to the smallest singular value of the scaled design;
            1.7 for six positions, large where poses hardly differ.
        not_separable: what these readings cannot tell apart, one sentence each.
        assumptions: what was taken as known.
        poses: readings, known values and what is left.
    """

    kind: str
    unit: str
    sensitivity: Array
    offset: Array
    covariance: Array
    shares: Mapping[str, Array]
    degrees_of_freedom: Array
    noise: Array
    noise_from: str
    chi2: float | None
    expected_chi2: float
    condition: float
    not_separable: tuple[str, ...]
    assumptions: tuple[Assumption, ...]
    poses: tuple[Pose, ...]

    @property
    def axes(self) -> int:
        """Number of axes, 1 or 3."""
        return len(self.offset)

    @property
    def u_sensitivity(self) -> Array:
        """Standard uncertainties of the terms of S (k, k)."""
        k = self.axes
        return np.sqrt(np.diag(self.covariance))[: k * k].reshape(k, k)

    @property
    def u_offset(self) -> Array:
        """Standard uncertainties of O (k,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance))[self.axes**2 :], dtype=float)

    def apply(self, values: ArrayLike) -> Array:
        """Corrected readings S⁻¹·(Y - O).

        Args:
            values: readings (k,) or (n, k), in the unit of the calibration; NaN stays NaN.

        Raises:
            InputError: another number of axes.
        """
        readings = self._readings(values)
        corrected = np.linalg.solve(self.sensitivity, (readings - self.offset).T).T
        return np.asarray(corrected.reshape(np.shape(values)), dtype=float)

    def covariance_of(self, values: ArrayLike, u_reading: ArrayLike = 0.0) -> Array:
        """Covariance (n, k, k) of corrected readings.

        Args:
            values: readings (k,) or (n, k).
            u_reading: standard uncertainty of a reading itself (its noise), one number or (k,).
                That of the calibration is the same for all readings: averaging does not lessen it.

        Raises:
            InputError: another number of axes.
        """
        readings = self._readings(values)
        inverse = np.asarray(np.linalg.inv(self.sensitivity), dtype=float)
        corrected = (readings - self.offset) @ inverse.T
        change = _change(inverse, corrected)
        own = inverse * np.square(np.broadcast_to(u_reading, self.axes)) @ inverse.T
        return np.asarray(change @ self.covariance @ change.transpose(0, 2, 1) + own, dtype=float)

    def u(self, values: ArrayLike, u_reading: ArrayLike = 0.0) -> Array:
        """Standard uncertainties of corrected readings, in the shape of the readings."""
        covariance = self.covariance_of(values, u_reading)
        own = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        return np.asarray(own.reshape(np.shape(values)), dtype=float)

    def _readings(self, values: ArrayLike) -> Array:
        readings = np.atleast_2d(np.asarray(values, dtype=float))
        if readings.ndim != 2 or readings.shape[1] != self.axes:
            wanted = f"{self.axes} in the last dimension"
            found = f"values of shape {np.shape(values)}; expected {wanted}, one for each axis"
            raise InputError("calibration", [found])
        return readings


def _change(inverse: Array, corrected: Array) -> Array:
    """Derivatives (n, k, k² + k) of corrected readings: -S⁻¹·(δS·f + δO)."""
    n, k = corrected.shape
    rows = np.einsum("ij,nm->nijm", inverse, corrected).reshape(n, k, k * k)
    return -np.concatenate([rows, np.broadcast_to(inverse, (n, k, k))], axis=2)
