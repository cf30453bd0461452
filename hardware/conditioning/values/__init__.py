"""Checks of the values: gaps, wraps, saturation."""
