"""A table of results held against simulations: one experiment in each row."""
