"""Scenario: the wheeled robot among obstacles, and the task of driving to a goal."""
