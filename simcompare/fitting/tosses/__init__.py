"""Friction and restitution from tosses of a cube."""
