"""Data sheets of sensors."""
