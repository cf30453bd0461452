"""A seismic mass on a spring and a damper, swept through all frequencies."""
