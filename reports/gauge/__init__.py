"""Worked examples, recomputed: sentences and the table."""
