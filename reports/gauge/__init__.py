"""Published examples, recomputed: sentences and the table."""
