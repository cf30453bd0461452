"""What a verb found, stored as JSON in a folder of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Protocol, TypeVar

from simcompare.model import plain
from simcompare.results import store


class _Result(Protocol):
    """A record that knows when it was made; it has a field ``folder``."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def created(self) -> str: ...


Found = TypeVar("Found", bound=_Result)


def save(found: Found, out: Path, name: str, file: str) -> Found:
    """Writes a result into a new folder below ``out``, and returns it with its place filled in.

    Args:
        found: the result.
        out: where the folder is made.
        name: how its name ends.
        file: that is written in it.

    Raises:
        OutputError: it cannot be written.
    """
    with store.new_folder(out, found.created, name, "results") as (place, partial):
        stored = replace(found, folder=place)
        (partial / file).write_text(plain.text(stored, indent=1) + "\n", encoding="utf-8")
    return stored
