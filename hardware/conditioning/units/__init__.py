"""Checks of names and units."""
