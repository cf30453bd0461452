"""Closed form of the robot that drives straight on and meets nothing: that of ``robot_motor``."""

from __future__ import annotations

from simcompare.scenarios.robot_motor.reference import reference

__all__ = ["reference"]
