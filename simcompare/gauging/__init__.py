"""Worked examples with a known answer, recomputed."""
