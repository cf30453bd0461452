"""How well a result is known: sentences, tables, figures and the page."""
