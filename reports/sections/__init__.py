"""Sections of a report: a template name and a dictionary."""
