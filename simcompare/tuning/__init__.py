"""Numbers for an engine's contact: which drops, what they tell, and the search for numbers."""
