"""Checks of the clock: order, gaps, jumps, resolution."""
