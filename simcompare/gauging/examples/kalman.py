"""The Kalman filter of speed and acceleration, at rest after many steps."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from simcompare.estimation import consistency, kalman, linear, speed_filter
from simcompare.gauging.check import Check
from simcompare.gauging.example import Example
from simcompare.model.trajectory import Array

_STEP_S, _JERK, _NOISE = 0.01, 1.0, np.diag([0.02**2, 0.05**2])
_GAIN = (("0.02827884", "0.00565889"), ("0.03536806", "0.82821491"))
_COVARIANCE = (("1.13115374e-5", "1.41472243e-5"), ("1.41472243e-5", "2.07053727e-3"))
#: bias of the accelerometer [m/s²] that the filter knows nothing of, and what it makes of it
_BIAS, _ERRORS = 0.1, ("0.03414682", "0.09849973")
#: after so many steps nothing of the start is left: the slower one of two parts fades by 0.97 each
_STEPS = 2000


def _checks() -> Iterator[Check]:
    transition, noise = speed_filter.matrices(_STEP_S, _JERK)
    model = linear.Linear(transition, noise, np.eye(2), _NOISE)
    gain = linear.steady_gain(model)
    yield from _matrix("K", _GAIN, gain)
    belief = kalman.Belief(np.zeros(2), np.eye(2))
    for step in range(_STEPS):
        belief = kalman.predict(belief, model.move(belief.mean, step))
        # the vehicle stands still, and its accelerometer does not say so
        reading = np.array([0.0, _BIAS])
        belief = kalman.update(belief, reading, model.expect(belief.mean, step)).belief
    yield from _matrix("P", _COVARIANCE, belief.covariance)
    fading = np.sort(np.abs(np.linalg.eigvals((np.eye(2) - gain) @ transition)))
    yield Check("slow eigenvalue of (I - K)·F", "0.97154176", float(fading[1]))
    yield Check("fast eigenvalue", "0.1716108", float(fading[0]))
    for name, exact, error in zip("va", _ERRORS, belief.mean, strict=True):
        yield Check(f"error of {name} at a bias of 0.1 m/s²", exact, float(error))
    low, high = consistency.band(2, 200)
    yield Check("NEES of 200 runs, 95 %, low", "1.73240883", low)
    yield Check("NEES of 200 runs, 95 %, high", "2.28652741", high)


def _matrix(name: str, exact: tuple[tuple[str, ...], ...], computed: Array) -> Iterator[Check]:
    for i, row in enumerate(exact):
        for k, text in enumerate(row):
            yield Check(f"{name}{i + 1}{k + 1}", text, float(computed[i, k]))


EXAMPLE = Example(
    "Kalman filter of speed and acceleration: gain, covariance, consistency",
    "Algebraic Riccati equation, solved with scipy's solve_discrete_are (the filter iterates);"
    " steps of 10 ms, jerk of 1 m²/s⁵, noise of 0.02 m/s and 0.05 m/s². NEES: quantiles of χ² with"
    " 400 degrees of freedom over 200, with mpmath.",
    _checks,
    kind="exact",
    closed_form=True,
)
