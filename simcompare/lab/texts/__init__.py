"""Texts of the lab, in each of its languages."""
