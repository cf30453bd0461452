"""Scenario: the wheeled robot in a plane, with one wheel that stands for both."""
