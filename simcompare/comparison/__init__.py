"""Trajectories held against a truth become scores."""
