"""What is kept of a recording in its folder, for the jobs that come later."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from simcompare.errors import InputError
from simcompare.lab import recordings
from simcompare.lab.asked import Asked
from simcompare.lab.groups import document
from simcompare.model import recording_store, whole

#: what the server writes of it
_TOLD = "recording.json"
#: letters of a job's id in the names of its files
_LETTERS = 6


def drop_of(place: Path) -> dict[str, Any] | None:
    """What was recorded of a ball; ``None`` where nothing bounced."""
    found = document(place / _TOLD).get("drop")
    return found if isinstance(found, dict) else None


def source_of(place: Path) -> Path:
    """The file that was sent.

    Raises:
        InputError: it is gone.
    """
    found = next(iter(sorted(place.glob("source.*"))), None)
    if found is None:
        raise InputError("recording", ["its file is gone; send it again"])
    return found


@contextlib.contextmanager
def fittable(place: Path, struck: set[int]) -> Iterator[Path]:
    """What a fit reads: the recording as it was read when it came, without struck-out impacts.

    Raises:
        InputError: there is no such impact.
    """
    stored = place / recordings.IMPORTED
    if not stored.is_dir():
        yield source_of(place)
        return
    if not struck:
        yield stored
        return
    with TemporaryDirectory(prefix="simcompare-") as folder:
        less = recordings.without(recording_store.load(stored), struck)
        yield recording_store.save(less, Path(folder) / place.name)


def files(folder: Path) -> Path:
    """Where a group's files are that can be taken home."""
    place = folder / "files"
    place.mkdir(exist_ok=True)
    return place


def name_of(asked: Asked, what: str, ending: str) -> str:
    """What a file to take home is called: what is in it, and a few letters of its job."""
    return f"{asked.scenario()}-{what}-{asked.text('id')[:_LETTERS]}.{ending}"


def file(folder: Path, name: str, text: str) -> str:
    """Stores a file that can be taken home; its name."""
    whole.write(files(folder) / name, text.encode("utf-8"))
    return name
