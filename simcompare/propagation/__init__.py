"""Uncertainty of a result of a scenario or of a formula: budgets and Monte Carlo."""
