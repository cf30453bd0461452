"""Restitution and drag from the times of measured bounces."""
