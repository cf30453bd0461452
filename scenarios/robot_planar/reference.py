"""Closed form of the robot seen from the side: that of the robot, with both wheels as one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.robot.reference import body_signals, driven, wheel_signals
from simcompare.scenarios.robot.straight import Straight


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """All signals of the robot in the plane under a constant torque.

    Args:
        parameters: those of the scenario, SI; the torque is that on each wheel of a pair.
        time_s: times from the start on (n,) [s].
    """
    robot, torque = Straight.of(parameters), parameters["torque_N_m"]
    motion = driven(robot, ((0.0, torque),), time_s)
    load = robot.mass_kg * robot.gravity_m_s2 - motion.caster_N
    return {
        **body_signals("chassis", motion, (-robot.behind_m, 0.0, robot.height_m)),
        **wheel_signals("wheel", "axle", motion, (0.0, 0.0, robot.radius_m)),
        "motor.torque_N_m": np.full(len(time_s), 2 * torque),
        "caster.normal_force_N": motion.caster_N,
        "tyre.normal_force_N": load,
    }
