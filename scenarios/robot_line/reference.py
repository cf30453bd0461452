"""Closed form of the robot with unequal wheels: that of ``odometry``, with another right radius."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from simcompare.model.signals import Signal
from simcompare.model.trajectory import Array
from simcompare.scenarios.odometry.reference import robot_of, signals_of

#: a mark that is reached to within rounding has passed
ROUNDING = 1e-9


def reference(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """Place and heading of the robot, the angles of its wheels, and the marks that have passed.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s], increasing.
        inputs: signals of ``left_rate`` and ``right_rate`` [rad/s].
    """
    robot = robot_of(parameters, parameters["right_larger"])
    signals = signals_of(parameters, robot, time_s, inputs)
    for side in ("left", "right"):
        turns = signals[f"{side}.angle_rad"] / (2 * math.pi)
        signals[f"{side}_encoder.marks"] = np.floor(turns * parameters["marks"] + ROUNDING)
    return signals
