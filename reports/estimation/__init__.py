"""Estimations as sentences, figures, tables and a page."""
