"""Motion and sensors with constant matrices, and the gain at which their filter settles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation.kalman import Expected, Motion
from simcompare.model.trajectory import Array


@dataclass(frozen=True, eq=False)
class Linear:
    """Motion and sensors with constant matrices.

    Attributes:
        transition: F. noise: Q. observation: H. measurement_noise: R.
    """

    transition: Array
    noise: Array
    observation: Array
    measurement_noise: Array

    def move(self, mean: Array, step: int) -> Motion:
        """The motion of any step."""
        return Motion(self.transition @ mean, self.transition, self.noise)

    def expect(self, mean: Array, step: int) -> Expected:
        """What is read after any step."""
        return Expected(self.observation @ mean, self.observation, self.measurement_noise)


def steady_gain(model: Linear) -> Array:
    """The gain at which a filter with constant matrices settles, from the Riccati equation.

    Raises:
        InputError: there is none, such as where a state is never seen.
    """
    from scipy.linalg import solve_discrete_are

    try:
        before = solve_discrete_are(
            model.transition.T, model.observation.T, model.noise, model.measurement_noise
        )
    except np.linalg.LinAlgError:
        raise InputError(
            "filter",
            [
                "the gain does not settle: a state is not seen by any sensor, or a noise is 0;"
                " expected a state that the measurements tell, and a measurement noise above 0"
            ],
        ) from None
    s = model.observation @ before @ model.observation.T + model.measurement_noise
    return np.asarray(np.linalg.solve(s, model.observation @ before).T)
