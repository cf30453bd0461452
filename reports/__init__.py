"""Comparison reports: the same figures and tables as HTML, PDF, Markdown and pictures."""
