"""Scenario: the wheeled robot with wheels that are drawn as cylinders."""
