"""Simulation against reality: alignment, statistics, the split of the gap, and plain words."""
