"""A hardware log becomes a recording; every change is recorded."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from simcompare.engine.library import installed_version
from simcompare.errors import InputError
from simcompare.hardware import joints
from simcompare.hardware.conditioning import derived_channels, drive
from simcompare.hardware.conditioning.condition import condition
from simcompare.hardware.logs import importers
from simcompare.hardware.logs import template as templates
from simcompare.hardware.mapping import NOTHING, Mapping
from simcompare.hardware.raw import IMPORT
from simcompare.model.recording import Provenance, Recording


def template(log: str | Path, *, kind: str | None = None) -> str:
    """A mapping file for a log, to be filled in: a line for every column.

    Args:
        log: file or folder.
        kind: format, recognised by content where ``None``.
    """
    path = Path(log)
    with _told_with_path(path):
        name = kind or importers.recognise(path)
        return templates.of_log(importers.read(path, name, NOTHING), path.name, name)


def read(
    path: Path,
    mapping: Mapping,
    *,
    kind: str | None = None,
    strict: bool = False,
    assume_units: bool = False,
    about: dict[str, str] | None = None,
) -> Recording:
    """Reads and conditions a log with a mapping that has been read already."""
    # values of a damaged log may overflow; the checks look at what comes out
    with _told_with_path(path), np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        before = _state(path)
        name = kind or mapping.format or importers.recognise(path)
        raw = importers.read(path, name, mapping)
        joints.settle(raw, mapping, path.name)
        size, digest = _measure(path)
        if _state(path) != before:  # what was read and what was measured are not the same
            raise InputError(str(path), ["changed while it was read; stop its recorder or copy it"])
        provenance = Provenance(
            path.name, digest, size, name, installed_version("simcompare") or "",
            "strict" if strict else "repair", about=about or {},
        )  # fmt: skip
        recording = condition(raw, mapping, provenance, assume_units=assume_units)
    recording = derived_channels.add(recording, mapping.derive, f"{path.name}, derive")
    return drive.noted(recording, mapping.drive, f"{path.name}, drive")


def with_path(text: str, path: Path) -> str:
    """Commands in messages get the path of the log, so that they work when they are pasted."""
    return text.replace(IMPORT, IMPORT.replace("LOG", shlex.quote(str(path))))


@contextmanager
def _told_with_path(path: Path) -> Iterator[None]:
    try:
        yield
    except InputError as error:
        told = [with_path(fault, path) for fault in error.faults]
        if told == [*error.faults]:
            raise
        raise InputError(error.where, told) from error


def _state(path: Path) -> tuple[int, int] | None:
    """Size and time of the last change of a file."""
    try:
        about = path.stat()
    except (OSError, ValueError):
        return None  # its reader says what is wrong
    return (about.st_size, about.st_mtime_ns) if path.is_file() else None


def _measure(path: Path) -> tuple[int, str]:
    """Size and SHA-256 of a file, or of all files of a folder in order of their names."""
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    digest, size = hashlib.sha256(), 0
    try:
        for file in files:
            with file.open("rb") as stream:
                while block := stream.read(1 << 20):
                    digest.update(block)
                    size += len(block)
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    return size, digest.hexdigest()
