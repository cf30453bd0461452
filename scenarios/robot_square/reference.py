"""Closed form of the robot on its square: that of ``robot_line``, driven by other rates."""

from __future__ import annotations

from simcompare.scenarios.robot_line.reference import reference as reference
