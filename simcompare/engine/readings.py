"""What a controller reads, with an answer for names that no reading has."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Iterable, Iterator, Mapping

from simcompare.errors import UnknownName
from simcompare.model.trajectory import Array

#: a number, or the components of a vector or a quaternion
Reading = float | tuple[float, ...]


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


class Readings(Mapping[str, Reading]):
    """Every signal at one instant by its name: a number, or a tuple of its components.

    What is asked for is worked out then, and nothing else. It is what was known at that instant,
    also where it is read later.

    Args:
        compute: gives the signals (n,) or (n, k) of one owner, such as "chassis", and perhaps more;
            those of all owners for ``None``. The last sample is read.
    """

    def __init__(self, compute: Callable[[str | None], Mapping[str, Array]]) -> None:
        self._compute = compute
        self._found: dict[str, Array] = {}
        self._all: Mapping[str, Array] | None = None

    def __getitem__(self, name: str) -> Reading:
        """A reading; where there is none of that name, tells which there are."""
        if name not in self:
            raise NoSuchReading(name, self)
        last: Reading = self._found[name][-1].tolist()
        return tuple(last) if isinstance(last, list) else last

    def __contains__(self, name: object) -> bool:
        """Whether there is a reading of that name."""
        if name not in self._found and self._all is None:
            self._found |= self._compute(str(name).partition(".")[0])
        return name in self._found

    def __iter__(self) -> Iterator[str]:
        """Names of all readings."""
        return iter(self._every())

    def __len__(self) -> int:
        """How many readings there are."""
        return len(self._every())

    def __repr__(self) -> str:
        """All names and values, as of a dict."""
        return repr(dict(self))

    def _every(self) -> Mapping[str, Array]:
        if self._all is None:
            self._all = self._compute(None)
            self._found |= self._all
        return self._all
