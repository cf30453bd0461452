"""What a verb found, stored as JSON in a folder of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from simcompare.model import plain
from simcompare.results import store
from simcompare.results.records.answered import Answered

Found = TypeVar("Found", bound=Answered)


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
