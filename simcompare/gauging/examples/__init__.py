"""Worked examples, a file each: what is published and where, and how it is computed here."""
