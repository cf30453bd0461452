"""Scenario: the wheeled robot under a torque that grows, so that its acceleration grows with it."""
