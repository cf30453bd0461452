"""How far dead reckoning strays from the truth, with its uncertainty."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation.dead_reckoning import DeadReckoning
from simcompare.measures.heading import wrapped
from simcompare.model.trajectory import Array

#: probability of a coverage region
COVERED = 0.95


@dataclass(frozen=True)
class Drift:
    """Odometry minus truth, sample by sample.

    Attributes:
        time_s: times (n,).
        along_m: error in the direction that odometry heads (n,), positive ahead of the truth.
        across_m: error to the left of it (n,).
        heading_rad: error of the heading (n,), ``None`` where it was not measured.
        distance_m: of both places (n,).
        u_along_m: standard uncertainty (n,).
        u_across_m: standard uncertainty (n,).
        u_heading_rad: standard uncertainty (n,), ``None`` as above.
        u_distance_m: in the direction of the error (n,); where the distance is below twice of it,
            it is not told from 0.
        way_m: length of the true path (n,); that of odometry has marks of both signs in it while
            the robot turns on the spot.
    """

    time_s: Array
    along_m: Array
    across_m: Array
    heading_rad: Array | None
    distance_m: Array
    u_along_m: Array
    u_across_m: Array
    u_heading_rad: Array | None
    u_distance_m: Array
    way_m: Array

    @property
    def per_metre(self) -> float | None:
        """Distance of the ends over the length of the path; ``None`` where nothing was driven."""
        return float(self.distance_m[-1] / self.way_m[-1]) if self.way_m[-1] > 0 else None

    @property
    def u_per_metre(self) -> float | None:
        """Its standard uncertainty."""
        return float(self.u_distance_m[-1] / self.way_m[-1]) if self.way_m[-1] > 0 else None


def drift(
    reckoned: DeadReckoning,
    place_m: Array,
    heading_rad: Array | None = None,
    *,
    u_place_m: float = 0.0,
    u_heading_rad: float = 0.0,
) -> Drift:
    """Holds odometry against a truth at the same times.

    Args:
        reckoned: by odometry.
        place_m: where the robot was (n, 2).
        heading_rad: where it headed (n,).
        u_place_m: standard uncertainty of each coordinate of the truth.
        u_heading_rad: standard uncertainty of the true heading.

    Raises:
        InputError: the truth has another number of samples.
    """
    if np.shape(place_m) != (len(reckoned.time_s), 2):
        fault = f"the truth has the shape {np.shape(place_m)}"
        raise InputError("place_m", [f"{fault}; expected ({len(reckoned.time_s)}, 2)"])
    apart = reckoned.pose[:, :2] - place_m
    covariance = reckoned.covariance[:, :2, :2] + u_place_m**2 * np.eye(2)
    cos, sin = np.cos(reckoned.pose[:, 2]), np.sin(reckoned.pose[:, 2])
    ahead, left = np.column_stack((cos, sin)), np.column_stack((-sin, cos))
    distance = np.hypot(*apart.T)
    safe = np.where(distance > 0, distance, 1.0)
    # where there is no distance it has no direction; the larger axis is on the safe side
    largest = np.sqrt(np.linalg.eigvalsh(covariance)[:, -1])
    turned, u_turned = None, None
    if heading_rad is not None:
        turned = wrapped(reckoned.pose[:, 2] - heading_rad)
        u_turned = np.sqrt(reckoned.covariance[:, 2, 2] + u_heading_rad**2)
    return Drift(
        reckoned.time_s, np.sum(apart * ahead, axis=1), np.sum(apart * left, axis=1), turned,
        distance, _u_of(covariance, ahead), _u_of(covariance, left), u_turned,
        np.where(distance > 0, _u_of(covariance, apart / safe[:, None]), largest),
        _way(place_m),
    )  # fmt: skip


def ellipse(covariance: Array) -> Array:
    """Border (n, 2) about (0, 0) of the region that covers a place of that covariance (2, 2)."""
    size, axes = np.linalg.eigh(covariance)
    half = np.sqrt(np.maximum(size, 0) * -2 * math.log(1 - COVERED))
    angle = np.linspace(0, 2 * math.pi, 73)
    return np.asarray(np.column_stack((np.cos(angle), np.sin(angle))) * half @ axes.T)


def _way(place_m: Array) -> Array:
    """Length of a path up to each sample (n,)."""
    steps = np.hypot(*np.diff(place_m, axis=0).T)
    return np.concatenate(([0.0], np.cumsum(steps)))


def _u_of(covariance: Array, direction: Array) -> Array:
    return np.asarray(np.sqrt(np.einsum("ni,nij,nj->n", direction, covariance, direction)))
