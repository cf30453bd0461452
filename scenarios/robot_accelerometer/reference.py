"""Closed form of a mass that a force sensor holds on a robot driven straight ahead.

The mass is cut out of the body at its centre, so the robot drives as the robot as a whole does; the
force on the mass is m·(a, 0, g), with the robot's own acceleration a.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.robot import reference as robot
from simcompare.scenarios.robot.straight import Straight


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """All signals of the robot, and ``cell.force_N`` (n, 3).

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].
    """
    forces = Straight.of(parameters).forces(parameters["torque_N_m"])
    felt = np.array((forces.acceleration_m_s2, 0.0, parameters["gravity_m_s2"]))
    force = parameters["seismic_mass_kg"] * felt
    cell = {"cell.force_N": np.tile(force, (len(time_s), 1))}
    return {**robot.reference(parameters, time_s), **cell}
