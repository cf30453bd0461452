"""A scenario as a file of another simulator, or as a script of one engine."""
