"""Worked examples, a file each: what is known and from where, and how it is computed here."""
