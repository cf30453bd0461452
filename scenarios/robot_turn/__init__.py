"""Scenario: the wheeled robot in a curve, because its wheels are driven by different torques."""
