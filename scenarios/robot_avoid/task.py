"""The task: drive to the goal by what an 8×8 range sensor sees, and touch nothing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from simcompare.engine.range_sensing import REACH_M
from simcompare.errors import InputError
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array
from simcompare.scenarios.robot_avoid.drawing import ROBOT_RADIUS_M, Plan, draw
from simcompare.scenarios.robot_avoid.seeing import DIRECTIONS, Eye

__all__ = ["ACTIONS", "CONTROL_HZ", "LONGEST_S", "OBSERVATIONS", "Episode", "draw"]

#: ranges and whether each is valid, the goal, the robot's own motion, the last action, the memory
OBSERVATIONS = 64 + 64 + 3 + 2 + 2 + DIRECTIONS
#: voltages of the left and of the right motor, as a part of the most
ACTIONS = 2
CONTROL_HZ = 5.0
#: after which an episode is cut off
LONGEST_S = 30.0
GOAL_M = 0.10
#: what distances, speeds and rates are divided by
_ARENA_M, _SPEED_M_S, _RATE_RAD_S = 2.8, 0.3, 5.0


class Steering(Protocol):
    """What the task reads of a simulation: its signals by name."""

    def __getitem__(self, name: str) -> float | tuple[float, ...]:
        """A signal now."""


class Episode:
    """One try in one arena.

    Args:
        scenario: the scene.
        sensors: how large the range sensor's errors are: 0 ideal, 1 those of its data sheet.
        control_Hz: how often the robot acts.
        rng: what the sensor's errors are drawn from.

    Raises:
        InputError: something stands on the start or on the goal; all of it.
    """

    def __init__(
        self, scenario: Scenario, sensors: float, control_Hz: float, rng: np.random.Generator
    ) -> None:
        p = scenario.parameters
        self._most_V, self._radius_m, self._track_m = (
            p["voltage_V"], p["wheel_radius_m"], p["track_m"],
        )  # fmt: skip
        self._plan, self._eye = Plan(p), Eye(scenario, sensors, control_Hz, rng)
        self._control_s = 1 / control_Hz
        self._last, self._change = np.zeros(ACTIONS), np.zeros(ACTIONS)
        x, y, _ = scenario.bodies["chassis"].position_m
        if faults := self._plan.faults(x, y):
            raise InputError(f"arena of {scenario.name}", faults)
        self._place = self._now = (x, y)
        self._start_m = self._away_m = math.dist(self._place, self._plan.goal)
        self._way_m = 0.0

    def inputs(self, action: Array) -> dict[str, float]:
        """Voltages of an action (2,) within -1 and 1, which is noted."""
        given = np.clip(action, -1, 1)
        self._last, self._change = given, given - self._last
        left, right = given.tolist()
        return {"left_drive": left * self._most_V, "right_drive": right * self._most_V}

    def observe(self, read: Steering) -> Array:
        """What the robot knows (159,): all of it is about 1 in size, and within 10."""
        position, turn = read["chassis.position_m"], read["chassis.orientation_wxyz"]
        assert isinstance(position, tuple)
        assert isinstance(turn, tuple)
        ranges, valid = self._eye.see(np.array((*position, *turn)))
        self._nearest_m = float(ranges[valid].min(initial=REACH_M))
        left, right = read["left.rate_rad_s"], read["right.rate_rad_s"]
        assert isinstance(left, float)
        assert isinstance(right, float)
        w, x, y, z = turn
        heading = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        gx, gy = self._plan.goal[0] - position[0], self._plan.goal[1] - position[1]
        bearing = math.atan2(gy, gx) - heading
        own = (
            math.hypot(gx, gy) / _ARENA_M, math.cos(bearing), math.sin(bearing),
            (left + right) * self._radius_m / 2 / _SPEED_M_S,
            (right - left) * self._radius_m / self._track_m / _RATE_RAD_S,
        )  # fmt: skip
        self._now = (position[0], position[1])
        around = self._eye.memory.around(position[0], position[1], heading)
        whole = np.concatenate((ranges / REACH_M, valid, own, self._last, around))
        return np.asarray(np.clip(whole, -10, 10), dtype=float)

    def judge(self) -> tuple[float, bool, Mapping[str, float]]:
        """Reward of the control step that has just been taken, whether all is over, and numbers.

        To be called after ``observe``. Nearing the goal is a potential, which changes no best way
        (Ng, Harada and Russell 1999).
        """
        x, y = self._now
        self._way_m += math.dist((x, y), self._place)
        away_m = math.dist((x, y), self._plan.goal)
        clearance_m = min(self._plan.gaps(x, y).values()) - ROBOT_RADIUS_M
        success, collided = away_m < GOAL_M, clearance_m <= 0
        changed = float(self._change @ self._change)
        reward = 2.0 * (self._away_m - away_m) - 0.1 * self._control_s - 0.001 * changed
        reward -= 0.05 * max(0.0, 0.1 - self._nearest_m) / 0.1
        reward += 10.0 * (success and not collided) - 10.0 * collided
        self._place, self._away_m = (x, y), away_m
        told = {
            "is_success": success and not collided, "collided": collided, "away_m": away_m,
            "way_m": self._way_m, "clearance_m": clearance_m, "straight_m": self._start_m,
        }  # fmt: skip
        return reward, success or collided, told


def straight_on(seen: Array) -> Array:
    """Drives straight at the goal and sees nothing: what a policy has to beat."""
    ahead, aside = seen[129:131].tolist()
    turn = math.atan2(aside, ahead)
    drive = max(0.0, 1 - abs(turn))
    return np.asarray(np.clip((drive - turn, drive + turn), -1, 1), dtype=float)
