"""Scenario: a robot that drives a square by its odometry and misses its start."""
