"""Scenario: a two-wheeled robot that a constant torque on its wheels drives straight ahead."""
