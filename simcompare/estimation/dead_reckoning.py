"""Odometry: the pose of a robot on two wheels by dead reckoning, with its uncertainty.

Two kinds of error must not be mixed (JCGM 100:2008, 4.3 and F.1.2.4):

* **Random**: an encoder tells a place of the wheel to one mark. The error of a count is evenly
  spread over a mark, so a difference of two that are independent is triangular, u = 1/√6 of a mark.
  They do not add up to a random walk: in the sum of all counts the ones between cancel. At even
  speed samples and marks beat, and the errors of a whole stretch may be alike: so much is taken as
  alike as the counts allow. Where there is a sample for each mark, that is on the safe side, up to
  five times. The limit: errors of two stretches, and of both wheels, are taken as independent. A
  single course whose stretches fit the marks can err by half as much again.
* **Systematic**: radii and track are wrong by the same amount all the way. Their effect is the
  sensitivity of the pose, which grows with the way, and never falls by taking more samples.

Both are propagated to first order through the exact arcs of ``hardware.sensors.odometer``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation import dead_reckoning_errors
from simcompare.hardware.sensors import odometer
from simcompare.model.trajectory import Array

Pose = tuple[float, float, float]
AT_ORIGIN: Pose = (0.0, 0.0, 0.0)
#: names of what is systematic, in the order of ``Wheels.covariance`` and of the sensitivities
SYSTEMATIC = ("left_radius_m", "right_radius_m", "track_m")


@dataclass(frozen=True)
class Wheels:
    """What odometry believes of its robot.

    Attributes:
        left_radius_m: effective radius of the left wheel.
        right_radius_m: effective radius of the right wheel.
        track_m: effective distance of the wheels.
        u_left_radius_m: standard uncertainty.
        u_right_radius_m: standard uncertainty.
        u_track_m: standard uncertainty.
        correlation: of the two radii's errors: 1 for wheels measured with one calliper that is off.
        track_correlation: of the track's error with those of the left and the right radius; closed
            courses tell only the track for a radius, so there they are nearly 1.
    """

    left_radius_m: float
    right_radius_m: float
    track_m: float
    u_left_radius_m: float = 0.0
    u_right_radius_m: float = 0.0
    u_track_m: float = 0.0
    correlation: float = 0.0
    track_correlation: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        faults = [
            f"{name} {value:g} is no size of a robot; expected a number above 0"
            for name in SYSTEMATIC
            if not 0 < (value := getattr(self, name)) < math.inf
        ]
        faults += [
            f"u_{name} {value:g} is no standard uncertainty; expected 0 or more"
            for name in SYSTEMATIC
            if not 0 <= (value := getattr(self, f"u_{name}")) < math.inf
        ]
        for value in (self.correlation, *self.track_correlation):
            if not -1 <= value <= 1:
                faults.append(f"correlation {value:g} is not between -1 and 1")
        if faults:
            raise InputError("wheels", faults)

    @property
    def covariance(self) -> Array:
        """Of left radius, right radius and track (3, 3) [m²]."""
        u = np.array([self.u_left_radius_m, self.u_right_radius_m, self.u_track_m])
        left, right = self.track_correlation
        alike = np.array(
            [[1.0, self.correlation, left], [self.correlation, 1.0, right], [left, right, 1.0]]
        )
        return np.asarray(alike * np.outer(u, u))


@dataclass(frozen=True)
class DeadReckoning:
    """A path as odometry tells it.

    Attributes:
        time_s: times (n,).
        pose: x [m], y [m] and heading [rad] (n, 3).
        way_m: length of the path up to each sample (n,), backwards counted as well.
        random: covariance of the pose from counts or noise (n, 3, 3).
        sensitivity: change of the pose with left radius, right radius and track (n, 3, 3).
        by_start: covariance of the pose from that of the start (n, 3, 3).
        wheels: what was believed.
    """

    time_s: Array
    pose: Array
    way_m: Array
    random: Array
    sensitivity: Array
    by_start: Array
    wheels: Wheels

    @property
    def systematic(self) -> Array:
        """Covariance of the pose from radii and track, the same error all the way (n, 3, 3)."""
        return self.sensitivity @ self.wheels.covariance @ np.swapaxes(self.sensitivity, 1, 2)

    @cached_property
    def covariance(self) -> Array:
        """Of the pose, random, systematic and from the start together (n, 3, 3)."""
        return np.asarray(self.random + self.systematic + self.by_start)

    @property
    def u(self) -> Array:
        """Standard uncertainties of x, y and heading (n, 3)."""
        # of errors that cancel, rounding leaves a little below 0
        return np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=1, axis2=2), 0.0))


def from_counts(
    time_s: Array,
    counts: tuple[Array, Array],
    marks: float,
    wheels: Wheels,
    start: Pose = AT_ORIGIN,
    *,
    u_start: Pose = AT_ORIGIN,
) -> DeadReckoning:
    """The path from two encoders' counts.

    Args:
        time_s: times (n,).
        counts: marks that have passed at the left and at the right wheel (n,) each.
        marks: marks in one turn of the wheel (those of the motor's shaft times the gear ratio).
        wheels: what is believed of the robot.
        start: first pose.
        u_start: its standard uncertainties.

    Raises:
        InputError: arrays that do not fit each other, or are not finite.
    """
    _check(time_s, counts, "counts")
    if not 0 < marks < math.inf:
        raise InputError("marks", [f"{marks:g} in a turn; expected a number above 0"])
    mark_rad = 2 * math.pi / marks
    angles = tuple(np.asarray(c, dtype=float) * mark_rad for c in counts)
    found = _reckoned(time_s, (angles[0], angles[1]), wheels, start, u_start)
    kept = _counted_on(counts)
    radii = np.array([wheels.left_radius_m, wheels.right_radius_m])
    u_m = radii * mark_rad / math.sqrt(12)
    rolled = _rolled((angles[0][kept], angles[1][kept]), wheels)
    driven = odometer.arcs(*rolled, wheels.track_m, start[2])
    random = dead_reckoning_errors.of_counts(
        driven, wheels.track_m, u_m, np.column_stack(counts)[kept]
    )
    # the samples that were left out have what the one before them has
    at = np.searchsorted(kept, np.arange(len(time_s)), side="right") - 1
    return replace(found, random=random[at])


def from_rates(
    time_s: Array,
    rates_rad_s: tuple[Array, Array],
    wheels: Wheels,
    start: Pose = AT_ORIGIN,
    *,
    u_rad_s: float = 0.0,
    u_start: Pose = AT_ORIGIN,
) -> DeadReckoning:
    """The path from the rates of two wheels, straight lines between samples.

    Args:
        time_s: times (n,), increasing.
        rates_rad_s: of the left and of the right wheel (n,) each.
        wheels: what is believed of the robot.
        start: first pose.
        u_rad_s: standard uncertainty of one rate by noise, independent from sample to sample.
        u_start: standard uncertainties of the first pose.

    Raises:
        InputError: arrays that do not fit each other, or are not finite.
    """
    _check(time_s, rates_rad_s, "rates_rad_s")
    steps = np.diff(time_s)
    left, right = (
        np.concatenate(([0.0], np.cumsum(steps * (rate[1:] + rate[:-1]) / 2)))
        for rate in map(np.asarray, rates_rad_s)
    )
    found = _reckoned(time_s, (left, right), wheels, start, u_start)
    driven = odometer.arcs(*_rolled((left, right), wheels), wheels.track_m, start[2])
    radii = np.array([wheels.left_radius_m, wheels.right_radius_m])
    # a rate serves in the steps before and after it, half of each; taken as if in the one after
    u_m = steps[:, None] * radii * u_rad_s
    return replace(found, random=dead_reckoning_errors.of_noise(driven, wheels.track_m, u_m))


def _check(time_s: Array, pair: tuple[Array, Array], name: str) -> None:
    """Raises where the arrays are no two records of one clock."""
    shapes = {np.shape(time_s), *(np.shape(values) for values in pair)}
    faults = []
    if len(shapes) > 1 or len(np.shape(time_s)) != 1 or len(time_s) < 2:
        found = ", ".join(str(np.shape(values)) for values in (time_s, *pair))
        faults.append(f"time, left and right have the shapes {found}; expected (n,) of all, n > 1")
    elif not all(np.all(np.isfinite(values)) for values in (time_s, *pair)):
        faults.append("has values that are not finite; without one all that follows is unknown")
    elif np.any(np.diff(time_s) <= 0):
        faults.append("its times do not increase")
    if faults:
        raise InputError(name, faults)


def _rolled(angles: tuple[Array, Array], wheels: Wheels) -> tuple[Array, Array]:
    return angles[0] * wheels.left_radius_m, angles[1] * wheels.right_radius_m


def _reckoned(
    time_s: Array, angles: tuple[Array, Array], wheels: Wheels, start: Pose, u_start: Pose
) -> DeadReckoning:
    """The path and its sensitivities, without random errors."""
    driven = odometer.arcs(*_rolled(angles, wheels), wheels.track_m, start[2])
    way = np.concatenate(([0.0], np.cumsum(np.abs(driven.way_m))))
    pose = odometer.poses(driven, start)
    none = np.zeros((len(time_s), 3, 3))
    found = dead_reckoning_errors.of_wheels(driven, angles, wheels.track_m)
    by_start = dead_reckoning_errors.of_start(pose, u_start)
    time_s = np.asarray(time_s, dtype=float)
    return DeadReckoning(time_s, pose, way, none, found, by_start, wheels)


def _counted_on(counts: tuple[Array, Array]) -> Array:
    """Samples at which a count is another than at the one kept before, and the first.

    More samples than marks tell nothing new; their errors are not independent.
    """
    changed = (np.diff(counts[0]) != 0) | (np.diff(counts[1]) != 0)
    return np.concatenate(([0], np.flatnonzero(changed) + 1))
