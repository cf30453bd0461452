"""Parameters from measurements: which fit, how sure they are, and what cannot be told."""
