"""Cells of CSV files, which spreadsheets would take for formulas."""

from __future__ import annotations

import contextlib

#: what a formula begins with
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def cell(value: object) -> object:
    """A value as a cell holds it: an apostrophe stands before a text that is like a formula.

    A + or - alone is none. Names come from scenarios and logs, which may be of others. A number is
    left as it is.
    """
    if not isinstance(value, str) or value in ("+", "-") or not value.startswith(_FORMULA):
        return value
    with contextlib.suppress(ValueError):
        float(value)
        return value
    return f"'{value}"
