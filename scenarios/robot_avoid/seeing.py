"""What a range sensor sees of an arena: boxes and posts that stand upright on a floor."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array

#: zones on a side, and how far their middles are apart: 45° are shared evenly
ZONES, ZONE_RAD = 8, math.radians(45 / 8)
#: added to components of directions: it changes only a 0, by which nothing can be divided
_TINY = 1e-150


def zone_directions() -> Array:
    """Middles of all zones (64, 3), row by row from above, in each from the left; x is the axis."""
    angles = (np.arange(ZONES) - (ZONES - 1) / 2) * ZONE_RAD
    up, left = np.meshgrid(-angles, -angles, indexing="ij")
    found = np.column_stack((np.ones(ZONES**2), np.tan(left).ravel(), np.tan(up).ravel()))
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True), dtype=float)


class Standing:
    """The fixed shapes of a scene, met by rays from one place.

    Args:
        scenario: the scene; its boxes and cylinders stand upright, its plane is z = 0.
    """

    def __init__(self, scenario: Scenario) -> None:
        boxes, posts = [], []
        for body in scenario.bodies.values():
            for shape in body.shapes if body.fixed else ():
                if shape.type == "box":
                    turn = 2 * math.atan2(body.orientation_wxyz[3], body.orientation_wxyz[0])
                    boxes.append((*body.position_m, *shape.size_m, math.cos(turn), math.sin(turn)))
                elif shape.type == "cylinder":
                    posts.append((*body.position_m, shape.radius_m, shape.length_m))
        box, post = np.array(boxes).reshape(-1, 8), np.array(posts).reshape(-1, 5)
        self._box, self._half = box[:, :3], box[:, 3:6, None] / 2
        self._cos, self._sin = box[:, 6:7], box[:, 7:8]
        self._post, self._radius, self._height = post[:, :3], post[:, 3:4], post[:, 4:5] / 2

    def distances(self, origin: Array, directions: Array) -> Array:
        """How far each ray goes until it meets something (n,) [m]; ``inf`` for nothing.

        Args:
            origin: where all rays begin (3,) [m].
            directions: unit vectors (n, 3).
        """
        x, y, z = directions.T + _TINY
        floor = np.where(z < 0, -origin[2] / z, np.inf)[None]
        return np.asarray(
            np.concatenate((floor, self._boxes(origin, x, y, z), self._posts(origin, x, y, z))).min(
                axis=0
            ),
            dtype=float,
        )

    def _boxes(self, origin: Array, x: Array, y: Array, z: Array) -> Array:
        """By slabs (Kay and Kajiya 1986)."""
        cos, sin, away = self._cos, self._sin, origin - self._box
        up = np.broadcast_to(z, (len(cos), len(z)))
        along = np.stack((cos * x + sin * y, cos * y - sin * x, up), 1) + _TINY
        ax, ay = away[:, :1], away[:, 1:2]
        place = np.stack((cos * ax + sin * ay, cos * ay - sin * ax, away[:, 2:]), 1)
        middle, half = -place / along, self._half / np.abs(along)
        return _met((middle - half).max(axis=1), (middle + half).min(axis=1))

    def _posts(self, origin: Array, x: Array, y: Array, z: Array) -> Array:
        """Within a tube and between two planes."""
        away = origin - self._post
        ax, ay, az = away[:, :1], away[:, 1:2], away[:, 2:]
        across = x * x + y * y
        beside = ax * y - ay * x
        inside = (self._radius**2 - beside * beside / across) / across
        middle, half = -(ax * x + ay * y) / across, np.sqrt(np.maximum(inside, 0))
        up, high = -az / z, self._height / np.abs(z)
        near, far = np.maximum(middle - half, up - high), np.minimum(middle + half, up + high)
        return _met(np.where(inside < 0, np.inf, near), far)


def _met(near: Array, far: Array) -> Array:
    return np.where((near <= far) & (near >= 0), near, np.inf)


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
