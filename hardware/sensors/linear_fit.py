"""Sensitivity and offset from readings at known values, by generalised least squares.

The readings of all poses are one vector. Its covariance has a part from noise and parts from what
is not quite known of the known values: these are common to axes and poses, so weights alone would
not do. Where the noise is not known, what the fit leaves tells it, with few degrees of freedom.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors.told_noise import Told, told
from simcompare.model.trajectory import Array

#: poses that differ so little make parameters that the readings hardly tell
WORST_CONDITION = 1e6
#: size of a sensitivity that is none at all: the readings do not change
_NONE = 0.05
#: sensitivity below which an axis is none of that name
_LEAST = 0.5
#: part of a reading below which there is nothing
_DIGITS = 1e-7
NOISE = "noise of the readings"


@dataclass(frozen=True, eq=False)
class Known:
    """Values at which a sensor was read.

    Attributes:
        values: (p, k), best estimates.
        errors: source -> covariance (p·k, p·k) of the values, row after row.
    """

    values: Array
    errors: dict[str, Array]


@dataclass(frozen=True, eq=False)
class Fitted:
    """What a linear fit found; parameters are the rows of S one after the other, then O.

    Attributes:
        sensitivity: S (k, k).
        offset: O (k,).
        shares: source -> its part of the covariance of the parameters.
        degrees_of_freedom: of each parameter.
        left: covariance of what the fit leaves of each pose's readings (p, k, k).
        noise: standard uncertainty of one mean reading (p, k).
        chi2: of the residuals, ``None`` where they told the noise.
        spare: number of readings less that of parameters.
        condition: of the scaled design.
    """

    sensitivity: Array
    offset: Array
    shares: Mapping[str, Array]
    degrees_of_freedom: Array
    left: Array
    noise: Array
    chi2: float | None
    spare: int
    condition: float

    @property
    def covariance(self) -> Array:
        """Of all parameters."""
        return np.asarray(sum(self.shares.values()), dtype=float)


def fit(known: Known, readings: Array, noise: Array | None, noise_dof: float = np.inf) -> Fitted:
    """S and O with their covariance.

    Args:
        known: at which values the sensor was read.
        readings: means of its readings (p, k).
        noise: standard uncertainties of these means (p, k), or ``None``: told by the residuals.
        noise_dof: degrees of freedom of a noise that was told by the scatter of readings.

    Raises:
        InputError: the values do not differ enough, or nothing is left to tell the noise.
    """
    values, axes = known.values, readings.shape[1]
    condition, spare = condition_of(values), readings.size - axes * (axes + 1)
    _check(condition, spare, told=noise is None)
    left, level = None, noise
    if level is None:
        left = _told(values, readings)
        level = np.sqrt(left.of_readings).reshape(readings.shape)
    # no reading has more digits than these; without any noise the equations have no weights
    level = np.maximum(level, _DIGITS * float(np.max(np.abs(readings), initial=0.0)) + 1e-300)
    # weights without cross-axis terms: with those, an error of theirs would come back as a weight
    # and equal where residuals told the noise: weights that hang on few of them gain nothing
    weight = level if left is None else np.full_like(level, np.sqrt(np.mean(np.square(level))))
    gain = _gain(values, _seen(known, np.eye(axes)), weight)
    sensitivity, offset = _split(gain @ readings.ravel(), axes)
    _check_signs(sensitivity)
    parts = _seen(known, sensitivity)
    if axes > 1:
        parts = _seen(known, _without_scatter(sensitivity, gain, parts, level))
    shares = {NOISE: gain * np.square(level).ravel() @ gain.T}
    shares |= {name: gain @ part @ gain.T for name, part in parts.items()}
    chi2 = None if noise is None else _chi2(values, readings, parts, level)
    dof = noise_dof if left is None else left.degrees_of_freedom(gain)
    return Fitted(
        sensitivity, offset, shares, effective_dof(shares, dof),
        _left_covariance(values, gain, _covariance(parts, level)), level, chi2, spare, condition,
    )  # fmt: skip


def _check(condition: float, spare: int, *, told: bool) -> None:
    """Refuses what cannot be solved; ``told``: the residuals must tell the noise."""
    if condition > WORST_CONDITION:
        raise InputError("calibration", [_too_alike(condition)])
    if told and spare < 1:
        raise InputError("calibration", ["has no spare reading to tell the noise: state it"])


def _why(axis: str, scale: float, axes: int) -> str:
    """What makes a sensitivity far too small."""
    if abs(scale) < _NONE and axes == 1:
        return "its readings are equal or nearly so at all known values"
    if abs(scale) < _NONE:
        return f"the readings of +{axis} and −{axis} are equal or nearly so"
    return "two readings of it are mixed up, or the axis has the other sign"


def _check_signs(sensitivity: Array) -> None:
    """Refuses an axis that falls where it should rise."""
    scales = np.diag(sensitivity)
    faults = [
        f"axis {axis} has a sensitivity of {scale:.2g}; expected about 1: "
        f"{_why(axis, scale, len(scales))}"
        for axis, scale in zip("xyz", scales, strict=False)
        if scale < _LEAST
    ]
    if faults:
        raise InputError("calibration", faults)


def condition_of(values: Array) -> float:
    """Condition number of known values (p, k), over their largest size, beside a column of 1."""
    largest = float(np.max(np.linalg.norm(values, axis=1), initial=0.0)) or 1.0
    design = np.column_stack([values / largest, np.ones(len(values))])
    if len(design) < design.shape[1]:
        return np.inf
    singular = np.linalg.svd(design, compute_uv=False)
    return float(singular[0] / max(singular[-1], 1e-300))


def told_condition(condition: float) -> str:
    """A condition number in words."""
    return f"{condition:.2g}" if condition < 1e12 else "without bound"


def _too_alike(condition: float) -> str:
    return (
        f"the known values are too alike to tell sensitivity and offset apart (condition number"
        f" {told_condition(condition)}); add poses that turn each axis up and down"
    )


def _seen(known: Known, sensitivity: Array) -> dict[str, Array]:
    """Errors of known values as they are seen in the readings."""
    through = np.kron(np.eye(len(known.values)), sensitivity)
    return {name: through @ part @ through.T for name, part in known.errors.items()}


def _without_scatter(
    sensitivity: Array, gain: Array, parts: Mapping[str, Array], noise: Array
) -> Array:
    """S whose cross-axis terms are as large as they are but for their own uncertainty.

    The square of an uncertain term is too large by its variance, and squares are what counts where
    errors of known values are seen through it.
    """
    variance = np.diag(gain @ _covariance(parts, noise) @ gain.T)[: sensitivity.size]
    smaller = np.sqrt(np.maximum(sensitivity**2 - variance.reshape(sensitivity.shape), 0.0))
    kept = np.eye(len(sensitivity), dtype=bool)
    return np.where(kept, sensitivity, np.copysign(smaller, sensitivity))


def _rows(values: Array) -> Array:
    """Design of the readings, pose after pose, axis after axis, for the rows of S and O."""
    one = np.eye(values.shape[1])
    return np.vstack([np.hstack([np.kron(one, value), one]) for value in values])


def _gain(values: Array, parts: Mapping[str, Array], noise: Array) -> Array:
    """The matrix that makes parameters of readings."""
    whitener = np.linalg.inv(np.linalg.cholesky(_covariance(parts, noise)))
    return np.asarray(np.linalg.pinv(whitener @ _rows(values)) @ whitener, dtype=float)


def _left(values: Array, gain: Array) -> Array:
    """The matrix that makes of readings what the fit leaves of them."""
    rows = _rows(values)
    return np.eye(len(rows)) - rows @ gain


def _left_covariance(values: Array, gain: Array, covariance: Array) -> Array:
    """Of what is left of the readings of each pose (p, k, k)."""
    left = _left(values, gain)
    whole, k = left @ covariance @ left.T, values.shape[1]
    return np.array([whole[i : i + k, i : i + k] for i in range(0, len(whole), k)])


def _covariance(parts: Mapping[str, Array], noise: Array) -> Array:
    return np.asarray(sum(parts.values()) + np.diag(np.square(noise).ravel()), dtype=float)


def _chi2(values: Array, readings: Array, parts: Mapping[str, Array], noise: Array) -> float:
    left = _left(values, _gain(values, parts, noise)) @ readings.ravel()
    return float(left @ np.linalg.solve(_covariance(parts, noise), left))


def _told(values: Array, readings: Array) -> Told:
    return told(_rows(values), readings.ravel(), (values.ravel() == 0.0).astype(float))


def _split(parameters: Array, axes: int) -> tuple[Array, Array]:
    return parameters[: axes * axes].reshape(axes, axes), parameters[axes * axes :]


def effective_dof(shares: Mapping[str, Array], noise_dof: float | Array) -> Array:
    """Effective degrees of freedom (JCGM 100:2008, G.4): all but the noise is known beforehand."""
    noise = np.diag(shares[NOISE])
    total = np.diag(np.asarray(sum(shares.values())))
    with np.errstate(divide="ignore"):
        return np.asarray(noise_dof * np.square(total / noise), dtype=float)
