"""Calibration of an accelerometer from still poses whose directions nobody knows.

At rest the size of what a sensor feels is g however it lies: its readings lie on an ellipsoid, the
image of a sphere. That tells O and S·Sᵀ, 9 numbers of 12. What is left open is a rotation of the
sensor in its box: S is given as the symmetric root of S·Sᵀ, which turns the least.
Levelling does not matter here, and poses need not be square.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from simcompare.errors import InputError
from simcompare.hardware.sensors.calibrated import About, Readings, calibration_of
from simcompare.hardware.sensors.calibration import Calibration, Taken
from simcompare.hardware.sensors.linear_fit import NOISE, Fitted, effective_dof, told_condition
from simcompare.hardware.sensors.six_position import SOMEWHERE, UNIT
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import Distribution

#: terms of a symmetric S, then O
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
PARAMETERS = len(_PAIRS) + 3
#: poses spread evenly have about 10; from here on a term is hardly told
WORST_CONDITION = 200.0
#: part of a direction from which on a term belongs to it
_PART = 0.3
#: rounds in which weights follow the shape of the ellipsoid
_ROUNDS = 2

NOT_SEPARABLE = (
    "A rotation of the sensor in its box: only O and S·Sᵀ are found, 9 of 12 numbers; S is given as"
    " its symmetric root.",
    "The unit of g and the sensitivity: an error of g scales all of S.",
    "A curvature of the characteristic and the shape of the ellipsoid.",
    "Changes with temperature: S and O hold at the temperature of the calibration.",
)


def calibrate(readings: Readings, gravity: Taken = SOMEWHERE) -> Calibration:
    """S, but for a rotation, and O of an accelerometer.

    Args:
        readings: in nine or more still poses, well spread.
        gravity: what is known of g [m/s²].

    Raises:
        InputError: too few poses, or poses that are spread too little; says which are missing.
    """
    means, g = readings.means, gravity.known.center
    if len(means) < PARAMETERS:
        raise InputError("ellipsoid", [_too_few(len(means))])
    parameters = np.array([1.0, 1, 1, 0, 0, 0, 0, 0, 0])
    _check_spread(_jacobian(parameters, means), g)
    for _ in range(_ROUNDS):
        weight = _weights(parameters, readings)
        parameters = _solved(parameters, means, g, weight)
    found = _fitted(parameters, readings, weight, gravity.known)
    assumptions = (gravity.assumed("local g", UNIT, "scales all of S"),)
    about = About("ellipsoid", UNIT, NOT_SEPARABLE, assumptions, "local g")
    nothing = np.zeros(len(means), dtype=bool)
    bare = calibration_of(about, found, readings, nothing, np.empty((0, 3)), g)
    poses = zip(bare.poses, np.sqrt(found.left[:, 0, 0]), strict=True)
    return replace(
        bare, poses=tuple(replace(pose, u_after=float(u), fitted=True) for pose, u in poses)
    )


def _too_few(count: int) -> str:
    return (
        f"{count} still poses; expected {PARAMETERS} or more, better 15, for as many unknown"
        f" numbers: add poses with each axis up, down and half way between"
    )


def _terms(parameters: Array) -> tuple[Array, Array]:
    """S, symmetric, and O."""
    sensitivity = np.empty((3, 3))
    for value, (i, j) in zip(parameters, _PAIRS, strict=False):
        sensitivity[i, j] = sensitivity[j, i] = value
    return sensitivity, parameters[len(_PAIRS) :]


def _corrected(parameters: Array, means: Array) -> tuple[Array, Array, Array]:
    """Sizes, directions, and these seen through S⁻¹."""
    sensitivity, offset = _terms(parameters)
    corrected = np.linalg.solve(sensitivity, (means - offset).T).T
    size = np.linalg.norm(corrected, axis=1)
    along = corrected / size[:, None]
    return size, along, np.linalg.solve(sensitivity, along.T).T


def _jacobian(parameters: Array, means: Array) -> Array:
    """Derivatives (p, 9) of the sizes: -(S⁻¹·n)·(δS·f + δO)."""
    size, along, seen = _corrected(parameters, means)
    columns = [
        seen[:, i] * along[:, j] + (seen[:, j] * along[:, i] if i != j else 0.0) for i, j in _PAIRS
    ]
    return -np.column_stack([np.column_stack(columns) * size[:, None], seen])


def _weights(parameters: Array, readings: Readings) -> Array:
    """One over the standard uncertainty of each size (p,); 1 where it is not known."""
    if readings.u is None:
        return np.ones(len(readings.means))
    _, _, seen = _corrected(parameters, readings.means)
    return np.asarray(1 / np.sqrt(np.sum((seen * readings.u) ** 2, axis=1)), dtype=float)


def _solved(start: Array, means: Array, g: float, weight: Array) -> Array:
    from scipy.optimize import least_squares

    def left(parameters: Array) -> Array:
        return weight * (_corrected(parameters, means)[0] - g)

    def change(parameters: Array) -> Array:
        return weight[:, None] * _jacobian(parameters, means)

    solution = least_squares(
        left, start, change,
        x_scale=np.repeat([1.0, g], [6, 3]), xtol=1e-15, ftol=1e-15, gtol=1e-15,
    )  # fmt: skip
    return np.asarray(solution.x, dtype=float)


def _fitted(parameters: Array, readings: Readings, weight: Array, gravity: Distribution) -> Fitted:
    jacobian = _jacobian(parameters, readings.means)
    left = _corrected(parameters, readings.means)[0] - gravity.center
    spare = len(left) - PARAMETERS
    u, dof = _noise_of_sizes(left, spare, weight, readings)
    gain = np.linalg.pinv(jacobian / u[:, None]) / u
    free = np.eye(len(left)) - jacobian @ gain
    variance = np.maximum(np.diag(free * u**2 @ free.T), 0.0)
    shares = _shares(parameters, gain, u, gravity)
    told = readings.u is None
    return Fitted(
        *_terms(parameters), shares, effective_dof(shares, dof),
        variance[:, None, None] * np.eye(3),
        np.repeat(u[:, None], 3, axis=1) if readings.u is None else readings.u,
        None if told else float(np.sum((left / u) ** 2)),
        spare, _condition(jacobian, gravity.center),
    )  # fmt: skip


def _noise_of_sizes(
    left: Array, spare: int, weight: Array, readings: Readings
) -> tuple[Array, float]:
    """Standard uncertainty of each size (p,), and its degrees of freedom."""
    if readings.u is not None:
        return 1 / weight, readings.degrees_of_freedom
    if spare < 1:
        raise InputError("ellipsoid", ["no pose to spare tells the noise: add one, or state it"])
    return np.full(len(left), np.sqrt(left @ left / spare)), float(spare)


def _shares(parameters: Array, gain: Array, u: Array, gravity: Distribution) -> dict[str, Array]:
    """Parts of the covariance of the rows of S, then O."""
    whole, (sensitivity, _) = _whole(), _terms(parameters)
    per_g = np.concatenate([-sensitivity.ravel() / gravity.center, np.zeros(3)])
    return {
        NOISE: whole @ (gain * u**2 @ gain.T) @ whole.T,
        "local g": gravity.u**2 * np.outer(per_g, per_g),
    }


def _whole() -> Array:
    """The matrix (12, 9) that makes of these parameters the rows of S and O."""
    whole = np.zeros((12, PARAMETERS))
    for column, (i, j) in enumerate(_PAIRS):
        whole[3 * i + j, column] = whole[3 * j + i, column] = 1.0
    whole[9:, len(_PAIRS) :] = np.eye(3)
    return whole


def _condition(jacobian: Array, g: float) -> float:
    singular = np.linalg.svd(jacobian * np.repeat([1 / g, 1.0], [6, 3]), compute_uv=False)
    return float(singular[0] / max(singular[-1], 1e-300))


def _check_spread(jacobian: Array, g: float) -> None:
    """Refuses poses that hardly tell a term, and says which poses would."""
    scaled = jacobian * np.repeat([1 / g, 1.0], [6, 3])
    _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    weak = directions[singular < singular[0] / WORST_CONDITION]
    if len(weak):
        worst = np.sqrt(np.sum(weak**2, axis=0))
        told = [_advice(k) for k in range(PARAMETERS) if worst[k] > _PART]
        wanted = "; ".join(dict.fromkeys(told))
        raise InputError("ellipsoid", [
            f"the poses are spread too little (condition number"
            f" {told_condition(_condition(jacobian, g))}; expected {WORST_CONDITION:g} or less):"
            f" {wanted}"
        ])  # fmt: skip


def _advice(parameter: int) -> str:
    if parameter < len(_PAIRS):
        i, j = _PAIRS[parameter]
        if i != j:
            return f"add poses half way between {'xyz'[i]} and {'xyz'[j]}"
    else:
        i = parameter - len(_PAIRS)
    return f"turn {'xyz'[i]} up and down"
