"""A ball dropped on a floor."""
