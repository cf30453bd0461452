"""A seismic mass on a spring and a damper as an accelerometer."""
