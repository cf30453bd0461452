"""A device that lies on the floor: what its accelerometer and gyroscope read at rest."""
