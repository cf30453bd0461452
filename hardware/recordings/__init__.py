"""Published facts as small tables, each with its citation and uncertainty."""
