"""Figures, tables, numbers and pages, whatever they show."""
