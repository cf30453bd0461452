"""What sensors tell of a motion: Kalman filters, odometry, the angle of a joint."""
