"""A scenario as a standalone script of one engine, as its issue tracker or a student needs it."""
