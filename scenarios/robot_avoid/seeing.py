"""What a range sensor sees of an arena, and how wrong it is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.kinematics import placed_shapes
from simcompare.engine.rays import Solids
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array

#: zones on a side
ZONES = 8


def standing(scenario: Scenario) -> Solids:
    """All that is fixed in a scene, to be met by rays."""
    fixed = (body for body in scenario.bodies.values() if body.fixed)
    return Solids([shape for body in fixed for shape in placed_shapes(body, body.shapes)])


class RangeErrors:
    """Errors of a multizone time-of-flight sensor, drawn anew for each episode.

    Half of the limits is common to all zones, the other half each zone's own. The data sheet
    DS13754 of the VL53L5CX is their source as a third party quotes it, none of it confirmed here;
    noise and losses are assumptions: 1 % and at least 3 mm, and one zone in twenty.

    Args:
        factor: how many times as large as the sheet's; 0 for none.
        rng: what is drawn from.
    """

    #: limits of accuracy: near [m], far as a part; where far begins [m]
    NEAR_M, FAR, FAR_FROM_M = 0.015, 0.05, 0.2
    NOISE, LEAST_NOISE_M, LOST, COUNT_M, REACH_M = 0.01, 0.003, 0.05, 0.001, 4.0

    def __init__(self, factor: float, rng: np.random.Generator) -> None:
        self.factor, self._rng = factor, rng
        self._bias = (rng.uniform(-0.5, 0.5) + rng.uniform(-0.5, 0.5, ZONES**2)) * factor

    def read(self, true_m: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Readings (64,) [m] and whether each is valid, from true ranges."""
        valid = true_m < self.REACH_M
        if not self.factor:
            return np.where(valid, true_m, self.REACH_M), valid
        true_m = np.minimum(true_m, self.REACH_M)
        limit = np.where(true_m < self.FAR_FROM_M, self.NEAR_M, self.FAR * true_m)
        noise = self.factor * np.maximum(self.LEAST_NOISE_M, self.NOISE * true_m)
        found = true_m + self._bias * limit + noise * self._rng.standard_normal(len(true_m))
        valid &= self._rng.random(len(true_m)) >= self.LOST * self.factor
        counted = np.clip(np.round(found / self.COUNT_M) * self.COUNT_M, 0, self.REACH_M)
        return np.where(valid, counted, self.REACH_M), valid
