"""What an engine keeps on its side, for as long as somebody holds the token of it."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class Kept:
    """A token.

    Attributes:
        number: what the engine calls that which it keeps.
    """

    number: int


class Keeper:
    """Gives tokens, and has the engine free what nobody holds any more.

    Args:
        free: called with the number of what is to be freed.
    """

    def __init__(self, free: Callable[[int], object]) -> None:
        self._free = free
        self._alive: set[int] = set()

    def hold(self, number: int) -> Kept:
        """The token of something that the engine keeps from now on."""
        kept = Kept(number)
        self._alive.add(number)
        weakref.finalize(kept, self._let_go, number).atexit = False
        return kept

    def close(self) -> None:
        """Frees nothing any more: the engine is gone."""
        self._alive.clear()

    def _let_go(self, number: int) -> None:
        if number in self._alive:
            self._alive.remove(number)
            self._free(number)
