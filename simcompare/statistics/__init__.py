"""Noise, agreement, grid convergence, correlation and least squares."""
