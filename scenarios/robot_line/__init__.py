"""Scenario: a robot with unequal wheels on a line that its odometry believes straight."""
