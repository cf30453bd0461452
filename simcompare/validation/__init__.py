"""Simulation judged against a recording: signals, values and timings, as a record."""
