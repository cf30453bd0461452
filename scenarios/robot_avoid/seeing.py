"""What the range sensor of the robot tells of an arena: as an ideal one, or as a real one would."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.kinematics import placed_shapes
from simcompare.engine.range_sensing import REACH_M, zone_rays
from simcompare.engine.rays import Solids
from simcompare.hardware.sensors import multizone
from simcompare.hardware.sensors.zone_view import seen_by
from simcompare.model.rotations import rotate
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array

#: zones on a side
ZONES = 8
#: rays on a side of a zone, enough to see two things in one; an ideal sensor has one ray
RAYS = 2
#: what is lower than this is the floor [m]
FLOOR_M = 0.025
#: directions about the robot in which it remembers, and for how long [s]
DIRECTIONS, MEMORY_S = 24, 3.0
#: things are near from here on [m], from the middle of the chassis
NEAR_M = 0.6

Flags = NDArray[np.bool_]


def standing(scenario: Scenario) -> tuple[Solids, list[str]]:
    """All that is fixed in a scene, to be met by rays, and which body each shape is of."""
    fixed = {name: body for name, body in scenario.bodies.items() if body.fixed}
    placed = [(n, shape) for n, body in fixed.items() for shape in placed_shapes(body, body.shapes)]
    return Solids([shape for _, shape in placed]), [name for name, _ in placed]


class Eye:
    """A VL53L5CX: ideal, or as its data sheet describes it; then device, light and surfaces differ.

    Args:
        scenario: the scene, with a sensor ``eye`` on the chassis that looks ahead.
        factor: how many times as large as the sheet's its errors are, and the light on the scene;
            0 for a sensor that reads the distance along one ray in each zone at once.
        control_Hz: how often it is asked; a frame is held until the next one.
        rng: what the device, the light, the reflectances and all scatter are drawn from.

    Attributes:
        memory: of its frames.
    """

    def __init__(
        self, scenario: Scenario, factor: float, control_Hz: float, rng: np.random.Generator
    ) -> None:
        self._solids, owners = standing(scenario)
        eye_m = np.array(scenario.sensors["eye"].position_m)
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
        self._rays = np.vstack((eye_m, rays / self._lengths[:, None]))
        self._every, self._asked = math.ceil(control_Hz / sheet.rate_Hz - 1e-9), 0
        self._late = 0.0 if self._is_ideal else sheet.latency_s * control_Hz
        self._poses: deque[Array] = deque(maxlen=math.ceil(self._late) + 1)
        self._found: Flags | None = None
        self.memory = Memory(eye_m, control_Hz / self._every)

    def see(self, pose: Array) -> tuple[Array, Flags]:
        """Its latest frame: ranges (64,) [m] along its axis, and whether each can be trusted.

        What cannot is told as its reach.

        Args:
            pose: of the chassis now (7,): position [m] and quaternion.
        """
        self._poses.append(pose)
        if self._asked % self._every == 0:
            then = self._pose_then()
            self._frame = self._look(then)
            self.memory.note(then, *self._frame)
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
            ranges = self._solids.ranges(place, along) / self._lengths
            valid = ranges < REACH_M
        else:
            seen = seen_by(self._solids.cast(place, along), along, self._lengths, self._matt)
            frame = self._device.read(seen, self._rng, self._found)
            ranges, valid = frame.range_m[0], frame.valid[0]
            self._found = frame.targets[0] > 0
        return np.where(valid, ranges, REACH_M), valid


class Memory:
    """What was seen about the robot in the last seconds, and where that is from it now.

    A sensor that looks ahead does not see what the robot drives past. Of each column of zones the
    nearest thing that is no floor is kept.

    Args:
        eye_m: where the sensor looks from (3,), in the chassis' frame.
        rate_Hz: frames in a second.
    """

    def __init__(self, eye_m: Array, rate_Hz: float) -> None:
        self._places = np.full((math.ceil(MEMORY_S * rate_Hz), ZONES, 2), np.inf)
        self._eye_m, self._rays, self._count = eye_m, zone_rays(ZONES)[:, 0], 0

    def note(self, pose: Array, ranges: Array, valid: Flags) -> None:
        """Notes a frame: ranges (64,) [m] and whether they can be trusted, at a pose (7,)."""
        own = self._eye_m + ranges[:, None] * self._rays
        placed = rotate(pose[None, 3:], own) + pose[:3]
        far = np.where(valid & (placed[:, 2] > FLOOR_M), ranges, np.inf).reshape(ZONES, ZONES)
        row, column = far.argmin(axis=0), np.arange(ZONES)
        nearest = placed.reshape(ZONES, ZONES, 3)[row, column, :2]
        nearest[~np.isfinite(far[row, column])] = np.inf
        self._places[self._count % len(self._places)] = nearest
        self._count += 1

    def around(self, x: float, y: float, heading: float) -> Array:
        """How near something is in each direction (24,), from straight ahead to the left.

        1 at the middle of the chassis, 0 from ``NEAR_M`` on.
        """
        away = self._places.reshape(-1, 2) - (x, y)
        away = away[np.isfinite(away[:, 0])]
        near = 1 - np.minimum(np.hypot(away[:, 0], away[:, 1]) / NEAR_M, 1)
        turn = (np.arctan2(away[:, 1], away[:, 0]) - heading) / (2 * math.pi)
        found = np.zeros(DIRECTIONS)
        np.maximum.at(found, np.rint(turn * DIRECTIONS).astype(int) % DIRECTIONS, near)
        return found
