"""Numbers of things in the sentences of the checks."""

from __future__ import annotations


def amount(number: int, word: str) -> str:
    """``1 gap`` or ``3 gaps``."""
    return f"{number} {word}{'' if number == 1 else 's'}"


def are(number: int, word: str) -> str:
    """``one row is`` or ``3 rows are``."""
    return f"one {word} is" if number == 1 else f"{number} {word}s are"


def times(number: int) -> str:
    """``once`` or ``3 times``."""
    return "once" if number == 1 else f"{number} times"
