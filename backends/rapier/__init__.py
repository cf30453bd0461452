"""Rapier: bodies in space with coordinates of their own, in single precision."""
