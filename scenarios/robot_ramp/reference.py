"""Closed form of the robot under a torque that grows from nothing along a straight line."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.robot.reference import SIDES, driven, robot_signals
from simcompare.scenarios.robot.straight import Straight


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """All signals of the robot under a ramp of torque, cubic in time; see the robot's own.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].
    """
    torque, ramp_s = parameters["torque_N_m"], parameters["ramp_s"]
    motion = driven(Straight.of(parameters), ((0.0, 0.0), (ramp_s, torque)), time_s)
    held = np.interp(time_s, (0.0, ramp_s), (0.0, torque))
    torques = {f"{side}_motor.torque_N_m": held for side in SIDES}
    return {**robot_signals(parameters, motion), **torques}
