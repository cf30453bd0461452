"""A carriage that follows a measured motion and carries an accelerometer and a gyroscope."""
