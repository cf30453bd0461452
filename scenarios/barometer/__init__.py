"""A cart with a barometer that is pulled up a slope."""
