"""Scenario: the wheeled robot with more torque than its tyres can hold, so that its wheels spin."""
