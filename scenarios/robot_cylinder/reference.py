"""Truth of the robot on cylinders: that of the robot on spheres; the physics is the same."""

from simcompare.scenarios.robot.reference import reference

__all__ = ["reference"]
