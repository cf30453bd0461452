"""What a page asks: nothing in it is believed before it has been looked at."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.glossary import LANGUAGES
from simcompare.hardware.recordings import published
from simcompare.model.settings import CONTACT_LEVELS
from simcompare.scenarios import catalogue

#: ids that the server gives
_ID = re.compile(r"[A-Za-z0-9_-]{1,80}")
#: most parts of a list or a table that a page sends
_MOST = 1000
#: all that a page can ask, and what the server adds to it
_PAGE = (
    "scenario", "engine", "engines", "levels", "parameters", "contact", "recording", "result",
    "struck", "points", "metres", "published", "still",
)  # fmt: skip
_SERVER = ("folder", "id", "language", "kind", "path", "name")


@dataclass(frozen=True)
class Asked:
    """The request of a job; each function reads one part of it.

    Files and folders of this machine cannot be named: only what the catalogue lists.
    """

    request: Mapping[str, Any]

    def check(self) -> None:
        """Refuses what nobody reads: it may be a slip of the pen.

        Raises:
            InputError: some of it is unknown.
        """
        unknown = sorted(self.request.keys() - {*_PAGE, *_SERVER})
        if unknown:
            known = ", ".join(_PAGE)
            faults = [f"{one!r:.60} is not known; known: {known}" for one in unknown]
            raise InputError("request", faults)

    def scenario(self, key: str = "scenario") -> str:
        """The name of a scenario of the catalogue.

        Raises:
            InputError: it is no text.
            UnknownName: there is none of that name.
        """
        return self.one_of(key, catalogue.names())

    def one_of(self, key: str, known: Sequence[str], otherwise: str | None = None) -> str:
        """One of some names."""
        value = self.text(key, otherwise)
        if value not in known:
            raise UnknownName(key, value, known)
        return value

    @property
    def language(self) -> str:
        """The language of the page."""
        return self.one_of("language", LANGUAGES, LANGUAGES[0])

    def text(self, key: str, otherwise: str | None = None) -> str:
        """A text."""
        value = self.request.get(key, otherwise)
        if value is None:
            raise InputError(key, ["is missing; this job needs one"])
        if not isinstance(value, str):
            raise InputError(key, ["expected a text"])
        return value

    def engines(self) -> list[str]:
        """Names of engines, each once; all where none are asked for.

        Raises:
            UnknownName: one of them does not exist.
        """
        return self._names("engines", engines.names()) or engines.names()

    def engine(self) -> str:
        """The name of one engine."""
        return self.one_of("engine", engines.names())

    def levels(self) -> list[str]:
        """Contact levels, each once; none where none are asked for.

        Raises:
            UnknownName: one of them does not exist.
        """
        return self._names("levels", CONTACT_LEVELS)

    def _names(self, key: str, known: Sequence[str]) -> list[str]:
        listed = self._list(key)
        for name in listed:
            if name not in known:
                raise UnknownName(key.removesuffix("s"), str(name), known)
        return list(dict.fromkeys(listed))

    def parameters(self) -> dict[str, float]:
        """Parameters of the scenario by name, SI."""
        return _numbers("parameters", self._table("parameters"))

    def own(self) -> dict[str, float]:
        """The student's own contact values, as ``{"ENGINE.VALUE": number}``."""
        found: dict[str, float] = {}
        for engine, values in self._table("contact").items():
            if not isinstance(values, Mapping):
                raise InputError(f"contact of {engine}", ["expected values by name"])
            numbers = _numbers(f"contact of {engine}", values)
            found |= {f"{engine}.{name}": value for name, value in numbers.items()}
        return found

    def folder(self) -> Path:
        """The folder of the group, which the server names."""
        return Path(self.text("folder"))

    def recording(self) -> Path | None:
        """The folder of a recording; ``None`` where none is named."""
        name = self.request.get("recording")
        if name is None:
            return None
        return self._part("recordings", name)

    def published(self) -> str | None:
        """The name of published bounces; ``None`` where none are named.

        Raises:
            UnknownName: there are none of that name.
        """
        if self.request.get("published") is None:
            return None
        return self.one_of("published", [*published.tables()])

    def result(self) -> Path | None:
        """The folder of a result; ``None`` where none is named."""
        name = self.request.get("result")
        return None if name is None else self._part("results", name)

    def _part(self, kind: str, name: object) -> Path:
        if not isinstance(name, str) or not _ID.fullmatch(name):
            raise InputError(kind, ["expected the id of one"])
        place = self.folder() / kind / name
        if not place.is_dir():
            raise InputError(kind, [f"there is none with the id {name}"])
        return place

    def struck(self) -> set[int]:
        """Places of impacts that are left out, the first is 0."""
        found = set()
        for number in self._list("struck"):
            if not isinstance(number, int) or isinstance(number, bool):
                raise InputError("struck", ["expected whole numbers of impacts"])
            found.add(number)
        return found

    def _list(self, key: str) -> list[Any]:
        value = self.request.get(key) or []
        if not isinstance(value, list) or len(value) > _MOST:
            raise InputError(key, [f"expected a list of at most {_MOST}"])
        return value

    def _table(self, key: str) -> Mapping[str, Any]:
        value = self.request.get(key) or {}
        if not isinstance(value, Mapping) or len(value) > _MOST:
            raise InputError(key, [f"expected at most {_MOST} values by name"])
        return value


def number(value: object, where: str) -> float:
    """A finite number.

    Raises:
        InputError: it is none.
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(where, ["expected a finite number"])
    return float(value)


def _numbers(where: str, values: Mapping[str, Any]) -> dict[str, float]:
    return {str(name): number(value, f"{where}, {name}") for name, value in values.items()}
