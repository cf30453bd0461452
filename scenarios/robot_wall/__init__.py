"""Scenario: the wheeled robot that nears a wall in a curve, driven by two different voltages."""
