"""Scenario: the wheeled robot driven by geared motors with brushes, at a constant voltage."""
