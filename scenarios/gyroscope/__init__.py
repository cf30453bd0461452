"""A turntable with a gyroscope, an accelerometer and a test mass on a force sensor."""
