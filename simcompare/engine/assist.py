"""Which of our helps are asked for, in words: all, none, or some by name."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.engine.helps import HELPS, known
from simcompare.errors import InputError, UnknownName

#: words of the command line for all helps and for none
ALL, NONE = "all", "none"


def chosen(text: str | Sequence[str]) -> frozenset[str]:
    """Helps from ``all``, ``none`` or names with commas.

    Raises:
        UnknownName: one of them does not exist.
        InputError: ``all`` or ``none`` beside others.
    """
    words = text.split(",") if isinstance(text, str) else text
    asked = [word.strip() for word in words if word.strip()]
    if asked == [ALL]:
        return frozenset(HELPS)
    if asked == [NONE]:
        return frozenset()
    for word in asked:
        if word in (ALL, NONE):
            raise InputError("--assist", [f"{word!r} stands alone; found {text!r}"])
        if word not in HELPS:
            raise UnknownName("help", word, [*HELPS, ALL, NONE])
    if not asked:
        raise InputError(
            "--assist", [f"names no help; expected {ALL}, {NONE} or some of {known()}"]
        )
    return frozenset(asked)
