"""Truth of the robot with spinning wheels: the robot's own, which knows when its tyres slide."""

from simcompare.scenarios.robot.reference import reference

__all__ = ["reference"]
