"""Unequal wheels and a wrong track told apart by driving a square both ways.

Clockwise and counter-clockwise a larger right wheel turns the robot to the left, while a wrong
track turns it too far to the side to which it turns anyway. So the ends of both courses tell both
errors (J. Borenstein and L. Feng, Measurement and Correction of Systematic Odometry Errors in
Mobile Robots, IEEE Trans. Robotics and Automation 12 (1996) 869: UMBmark). Here the two numbers are
fitted by least squares through exact dead reckoning, weighted with what is known of the ends; the
authors' formulas are kept beside it.

The mean of both radii cannot be told from a closed course, and stays as it was: a straight line of
known length tells it. A turn tells only the track for a radius, so what the mean leaves open of
itself it leaves open of the track: their errors go together.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation.dead_reckoning import AT_ORIGIN, Pose, Wheels, from_counts
from simcompare.model.trajectory import Array

#: most steps of Gauss and Newton, and the change of both ratios that ends them
MAX_STEPS, ENOUGH = 20, 1e-12
#: condition number of both columns, scaled, beyond which the two errors are not told apart
MOST_CONDITION = 1e3


@dataclass(frozen=True)
class Course:
    """A course that was driven, and where it ended.

    Attributes:
        time_s: times (n,).
        counts: of the left and of the right encoder (n,) each.
        end_m: measured end (2,).
        start: measured start.
    """

    time_s: Array
    counts: tuple[Array, Array]
    end_m: tuple[float, float]
    start: Pose = AT_ORIGIN


@dataclass(frozen=True)
class Separation:
    """What both directions tell of the wheels.

    Attributes:
        diameters: E_d, diameter of the right wheel over that of the left one.
        track: E_b, true track over the believed one.
        u_diameters: standard uncertainty.
        u_track: standard uncertainty for the mean radius as believed; where that is wrong by a
            part, so is the track.
        correlation: of both.
        corrected: wheels that odometry should believe; the mean radius is the one from before, and
            what it leaves open is in the uncertainty of the track, with the correlations.
        chi2: what is left, squared, over its uncertainty.
        degrees_of_freedom: measured coordinates less two.
        before_m: root mean square distance of odometry's ends from the measured ones, as believed.
        after_m: the same with the corrected wheels.
    """

    diameters: float
    track: float
    u_diameters: float
    u_track: float
    correlation: float
    corrected: Wheels
    chi2: float
    degrees_of_freedom: int
    before_m: float
    after_m: float


def separate(
    courses: Sequence[Course], marks: float, believed: Wheels, u_end_m: float
) -> Separation:
    """Fits E_d and E_b to the ends of courses in both directions.

    Args:
        courses: at least one in each direction.
        marks: in one turn of a wheel.
        believed: the wheels that odometry believed until now.
        u_end_m: standard uncertainty of each coordinate of an end, its start included.

    Raises:
        InputError: courses that do not tell both, or an uncertainty that is not above 0.
    """
    faults = []
    if not 0 < u_end_m < math.inf:
        faults.append(f"u_end_m {u_end_m:g} is no standard uncertainty; expected a number above 0")
    if len(courses) < 2:
        faults.append(f"{len(courses)} course; expected at least one in each direction")
    if faults:
        raise InputError("courses", faults)
    ratios = np.ones(2)
    for _ in range(MAX_STEPS):
        left, jacobian, weight = _residuals(courses, marks, believed, ratios, u_end_m)
        normal = jacobian.T @ weight @ jacobian
        _check(normal)
        step = np.linalg.solve(normal, jacobian.T @ weight @ left)
        ratios = ratios + step
        if np.all(np.abs(step) < ENOUGH):
            break
    covariance = np.asarray(np.linalg.inv(normal), dtype=float)
    left, _, weight = _residuals(courses, marks, believed, ratios, u_end_m)
    before, *_ = _residuals(courses, marks, believed, np.ones(2), u_end_m)
    u = np.sqrt(np.diag(covariance))
    # what a wrong mean radius does to the ratios that fit
    by_mean = covariance @ jacobian.T @ weight @ -_by_mean(courses, marks, believed, ratios)
    corrected = _corrected(believed, ratios, covariance, by_mean)
    return Separation(
        float(ratios[0]), float(ratios[1]), float(u[0]), float(u[1]),
        float(covariance[0, 1] / (u[0] * u[1])), corrected,
        float(left @ weight @ left), left.size - 2, _rms(before), _rms(left),
    )  # fmt: skip


def by_formula(
    side_m: float, track_m: float, clockwise_m: Array, counterclockwise_m: Array
) -> tuple[float, float]:
    """E_d and E_b by the formulas of Borenstein and Feng, from the mean errors along x.

    Courses start along x. Errors are the true end less that of odometry, one row an end.

    Args:
        side_m: of the square.
        track_m: as believed.
        clockwise_m: errors of the clockwise ends (n, 2).
        counterclockwise_m: errors of the counter-clockwise ends (n, 2).
    """
    right, left = (float(np.mean(np.asarray(e)[:, 0])) for e in (clockwise_m, counterclockwise_m))
    too_far = (right + left) / (4 * side_m)  # in each turn
    bend = (left - right) / (4 * side_m)  # on each side
    quarter = math.pi / 2
    if not bend:
        return 1.0, quarter / (quarter + too_far)
    radius = side_m / 2 / math.sin(bend / 2)
    return (radius + track_m / 2) / (radius - track_m / 2), quarter / (quarter + too_far)


def _wheels(believed: Wheels, ratios: Array) -> Wheels:
    mean = (believed.left_radius_m + believed.right_radius_m) / 2
    ratio = float(ratios[0]) * believed.right_radius_m / believed.left_radius_m
    return replace(
        believed,
        left_radius_m=2 * mean / (1 + ratio), right_radius_m=2 * mean * ratio / (1 + ratio),
        track_m=believed.track_m * float(ratios[1]),
    )  # fmt: skip


def _corrected(believed: Wheels, ratios: Array, covariance: Array, by_mean: Array) -> Wheels:
    """The wheels with their uncertainties: the ratios' own, and all that the mean radius does."""
    wheels, chain = _wheels(believed, ratios), _chain(believed, ratios)
    mean = (wheels.left_radius_m + wheels.right_radius_m) / 2
    grown = np.array([wheels.left_radius_m, wheels.right_radius_m, 0.0]) / mean + chain @ by_mean
    of_mean = float(believed.covariance[:2, :2].sum()) / 4
    total = chain @ covariance @ chain.T + of_mean * np.outer(grown, grown)
    u = np.sqrt(np.diag(total))
    alike = np.clip(total / np.outer(u, u), -1, 1)  # rounding
    return replace(
        wheels, u_left_radius_m=float(u[0]), u_right_radius_m=float(u[1]), u_track_m=float(u[2]),
        correlation=float(alike[0, 1]), track_correlation=(float(alike[0, 2]), float(alike[1, 2])),
    )  # fmt: skip


def _chain(believed: Wheels, ratios: Array) -> Array:
    """Change of left radius, right radius and track with both ratios (3, 2), at a given mean."""
    wheels = _wheels(believed, ratios)
    mean = (wheels.left_radius_m + wheels.right_radius_m) / 2
    start = believed.right_radius_m / believed.left_radius_m
    ratio = wheels.right_radius_m / wheels.left_radius_m
    per_ratio = 2 * mean / (1 + ratio) ** 2 * start
    return np.array([[-per_ratio, 0.0], [per_ratio, 0.0], [0.0, believed.track_m]])


def _by_mean(courses: Sequence[Course], marks: float, believed: Wheels, ratios: Array) -> Array:
    """Change of the predicted ends with the mean radius at given ratios (2c,)."""
    wheels = _wheels(believed, ratios)
    radii = np.array([wheels.left_radius_m, wheels.right_radius_m])
    found = [from_counts(c.time_s, c.counts, marks, wheels, c.start) for c in courses]
    return np.concatenate([f.sensitivity[-1, :2, :2] @ radii / radii.mean() for f in found])


def _residuals(
    courses: Sequence[Course], marks: float, believed: Wheels, ratios: Array, u_end_m: float
) -> tuple[Array, Array, Array]:
    """Measured less predicted ends (2c,), their change with both ratios (2c, 2), and weights."""
    wheels, chain = _wheels(believed, ratios), _chain(believed, ratios)
    left, jacobian = [], []
    weight = np.zeros((2 * len(courses), 2 * len(courses)))
    for k, course in enumerate(courses):
        found = from_counts(course.time_s, course.counts, marks, wheels, course.start)
        left.append(np.asarray(course.end_m) - found.pose[-1, :2])
        jacobian.append(found.sensitivity[-1, :2] @ chain)
        spread = found.random[-1, :2, :2] + u_end_m**2 * np.eye(2)
        weight[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = np.linalg.inv(spread)
    return np.concatenate(left), np.vstack(jacobian), weight


def _check(normal: Array) -> None:
    scale = np.sqrt(np.diag(normal))
    if np.all(scale > 0):
        shape = normal / np.outer(scale, scale)
        if np.linalg.cond(shape) < MOST_CONDITION**2:
            return
    fault = "do not tell unequal wheels from a wrong track; drive the course in both directions"
    raise InputError("courses", [fault])


def _rms(left: Array) -> float:
    return math.sqrt(2 * float(np.mean(left**2)))
