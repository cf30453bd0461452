"""A table of results against simulations: sentences, figures, tables and the page."""
