"""A block that slides on a plane until friction stops it."""
