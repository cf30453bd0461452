"""What a controller reads, with an answer for names that no reading has."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from simcompare.errors import UnknownName


class NoSuchReading(UnknownName, KeyError):
    """No reading has that name; names those that there are, the nearest first.

    Args:
        name: the name that was asked for.
        known: the readings that there are.
    """

    def __init__(self, name: object, known: Iterable[str]) -> None:
        super().__init__("reading", str(name), known)
        ranked = sorted(self.known, key=lambda one: -_likeness(str(name), one))
        self.args = (f"no reading is called {name!r}; the nearest first: {', '.join(ranked)}",)

    def __str__(self) -> str:
        """The sentence itself; an error of keys would put it in quotes."""
        return str(self.args[0])


def _likeness(asked: str, name: str) -> float:
    """Names that begin as the one that was asked for stand before all others."""
    return 2.0 * name.startswith(asked) + difflib.SequenceMatcher(None, asked, name).ratio()


class Readings(dict[str, float | tuple[float, ...]]):
    """Every signal now by its name: a number, or a tuple of its components."""

    def __missing__(self, name: object) -> float:
        """Tells which readings there are."""
        raise NoSuchReading(name, self)
