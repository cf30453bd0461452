"""Parameters from signals over time."""
