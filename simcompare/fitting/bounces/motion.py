"""The motion of a filmed ball: the richest closed form, with a scale of the picture."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.bounce_models import MODELS, Bounces
from simcompare.fitting.bounces.impacts import Impacts, Track
from simcompare.fitting.bounces.problem import Problem, build
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics import least_squares

_MODEL = MODELS["power+drag"]
UNKNOWNS = (*_MODEL.own, "drop_height_m", "release_time_s", "floor_m", "scale")
#: part of chi squared that a further step would have to bring: a cut needs no more
_ENOUGH = 1e-4
#: what holds unknowns that few flights do not tell
_PRIORS = {"exponent": Prior(0.0, 0.1), "scale": Prior(1.0, 0.05)}


@dataclass(frozen=True)
class Motion:
    """A closed form with its unknowns."""

    problem: Problem
    x: Array

    @property
    def values(self) -> dict[str, Array | float]:
        """Of the unknowns, by name."""
        return self.problem.values(self.x, 0)

    def bounces(self, count: int) -> Bounces:
        """Impacts and apexes, as many as are asked for."""
        return bounce_models.bounces(_MODEL, self.values, count)

    def height(self, time: Array, flight: NDArray[np.int64]) -> Array:
        """As the camera shows it."""
        found = self.bounces(int(flight.max(initial=0)) + 1)
        return bounce_models.height_at(found, self.values, time, flight)

    def one_earlier(self) -> Motion:
        """The same motion, its number 0 the flight before."""
        x, at = self.x.copy(), UNKNOWNS.index("drop_height_m")
        height = x[at]
        x[at] = height / x[0] ** 2
        for _ in range(8):
            x[at] *= height / float(replace(self, x=x).bounces(1).apex_m[1])
        x[UNKNOWNS.index("release_time_s")] -= float(replace(self, x=x).bounces(1).apex_s[1])
        return replace(self, x=x)


def problem_of(
    time: Array, height: Array, u: Array, flight: NDArray[np.int64], gravity: float
) -> Problem:
    """What is minimised: the heights of samples in their flights, less those of the motion."""
    return build(
        [Impacts(track=Track(time, height, u, flight))], _MODEL, unknowns=UNKNOWNS,
        fixed={"gravity_m_s2": gravity}, priors=_PRIORS,
    )  # fmt: skip


def nearest(problem: Problem, start: Array) -> Motion:
    """The motion that follows the samples best."""
    best = least_squares.solve(
        problem.residuals, start[None, :], problem.low, problem.high, problem.size, enough=_ENOUGH
    )
    return Motion(problem, best.x[0])
