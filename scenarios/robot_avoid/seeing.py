"""What the range sensor of the robot tells of an arena: as an ideal one, or as a real one would."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.kinematics import placed_shapes
from simcompare.engine.range_sensing import REACH_M
from simcompare.engine.rays import Solids
from simcompare.hardware.sensors import multizone
from simcompare.hardware.sensors.zone_view import seen_by
from simcompare.model.rotations import rotate
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array

#: where the sensor looks from, in the chassis' frame [m]: ahead of the axle
EYE_M = (0.06, 0.0, 0.02)
#: rays on a side of a zone, enough to see two things in one; an ideal sensor has one ray
RAYS = 2

Flags = NDArray[np.bool_]


def standing(scenario: Scenario) -> tuple[Solids, list[str]]:
    """All that is fixed in a scene, to be met by rays, and which body each shape is of."""
    fixed = {name: body for name, body in scenario.bodies.items() if body.fixed}
    placed = [(n, shape) for n, body in fixed.items() for shape in placed_shapes(body, body.shapes)]
    return Solids([shape for _, shape in placed]), [name for name, _ in placed]


class Eye:
    """A VL53L5CX: ideal, or as its data sheet describes it; then device, light and surfaces differ.

    Args:
        scenario: the scene.
        factor: how many times as large as the sheet's its errors are, and the light on the scene;
            0 for a sensor that reads the distance along one ray in each zone at once.
        control_Hz: how often it is asked; a frame is held until the next one.
        rng: what the device, the light, the reflectances and all scatter are drawn from.
    """

    def __init__(
        self, scenario: Scenario, factor: float, control_Hz: float, rng: np.random.Generator
    ) -> None:
        self._solids, owners = standing(scenario)
        sheet = multizone.drawn(seed=int(rng.integers(2**32)))
        numbers, self._is_ideal, self._rng = sheet.numbers, factor == 0, rng
        self._device = replace(
            sheet, stays=factor * sheet.stays, scatter=factor,
            ambient_klux=factor * float(rng.uniform(0, numbers.ambient_klux)),
        )  # fmt: skip
        matt = {name: rng.uniform(numbers.grey, numbers.white) for name in dict.fromkeys(owners)}
        self._matt = np.array([*(matt[name] for name in owners), 0.0])
        rays = sheet.rays(1 if self._is_ideal else RAYS).reshape(-1, 3)
        self._lengths = np.linalg.norm(rays, axis=1)
        self._rays = np.vstack((EYE_M, rays / self._lengths[:, None]))
        self._every, self._asked = math.ceil(control_Hz / sheet.rate_Hz - 1e-9), 0
        self._late = 0.0 if self._is_ideal else sheet.latency_s * control_Hz
        self._poses: deque[Array] = deque(maxlen=math.ceil(self._late) + 1)
        self._found: Flags | None = None

    def see(self, pose: Array) -> tuple[Array, Flags]:
        """Its latest frame: ranges (64,) [m] along its axis, and whether each can be trusted.

        What cannot is told as its reach.

        Args:
            pose: of the chassis now (7,): position [m] and quaternion.
        """
        self._poses.append(pose)
        if self._asked % self._every == 0:
            self._frame = self._look(self._pose_then())
        self._asked += 1
        return self._frame

    def _pose_then(self) -> Array:
        """The pose in the middle of the frame, between those that were noted."""
        back = min(self._late, len(self._poses) - 1)
        later = int(back)
        if back == later:
            return self._poses[-1 - later]
        part = back - later
        pose = (1 - part) * self._poses[-1 - later] + part * self._poses[-2 - later]
        pose[3:] /= np.linalg.norm(pose[3:])
        return pose

    def _look(self, pose: Array) -> tuple[Array, Flags]:
        turned = rotate(pose[None, 3:], self._rays)
        place, along = turned[0] + pose[:3], turned[1:]
        if self._is_ideal:
            ranges = self._solids.distances(place, along)[0] / self._lengths
            valid = ranges < REACH_M
        else:
            seen = seen_by(self._solids.cast(place, along), along, self._lengths, self._matt)
            frame = self._device.read(seen, self._rng, self._found)
            ranges, valid = frame.range_m[0], frame.valid[0]
            self._found = frame.targets[0] > 0
        return np.where(valid, ranges, REACH_M), valid
