"""A cart with a range sensor of 8 times 8 zones drives towards a wall, past a ball and a crate."""
