"""A cube tossed on a table: where it comes to rest, and on which face."""
