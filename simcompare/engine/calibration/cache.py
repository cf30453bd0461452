"""What was found out about an engine, kept in the user's cache, since it takes a second.

It is found again when the question, the engine's version, its adapter or any of our code changes.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

import platformdirs


class Versioned(Protocol):
    """What of a backend tells whether an answer still holds."""

    @property
    def name(self) -> str:
        """The engine's name."""

    def version(self) -> str:
        """Version of the engine."""


def folder() -> Path:
    """Where answers are kept; SIMCOMPARE_CACHE names another folder."""
    own = os.environ.get("SIMCOMPARE_CACHE") or platformdirs.user_cache_dir("simcompare")
    return Path(own) / "calibrations"


def known(backend: Versioned, asked: Mapping[str, Any]) -> dict[str, Any] | None:
    """The answer to a question where the cache has it."""
    key = _key(backend, asked)
    # what is not there, or damaged, is found again
    with contextlib.suppress(OSError, ValueError, TypeError, KeyError, AttributeError):
        return None if key is None else _read(folder() / f"{key}.json")
    return None


def kept(
    backend: Versioned, asked: Mapping[str, Any], find: Callable[[], dict[str, Any]]
) -> dict[str, Any]:
    """The answer to a question about an engine, from the cache where it is there.

    Args:
        backend: the engine's backend.
        asked: the question, as plain values.
        find: finds the answer, as plain values.
    """
    before = known(backend, asked)
    if before is not None:
        return before
    found, key = plain(find()), _key(backend, asked)
    if key is None:
        return found
    path = folder() / f"{key}.json"
    with contextlib.suppress(OSError):  # where nothing can be kept, it is found again
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{os.getpid()}")
        text = json.dumps(found)
        part.write_text(f"{_digest(text)}\n{text}", encoding="utf-8")
        try:
            part.replace(path)
        except OSError:
            part.unlink()
    return found


def plain(found: dict[str, Any]) -> dict[str, Any]:
    """The same as it comes out of the cache: tuples are lists there."""
    again: dict[str, Any] = json.loads(json.dumps(found))
    return again


def _read(path: Path) -> dict[str, Any]:
    digest, _, text = path.read_text(encoding="utf-8").partition("\n")
    if digest != _digest(text):  # changed, or cut off
        raise ValueError(path)
    found: dict[str, Any] = json.loads(text)
    return found


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _key(backend: Versioned, asked: Mapping[str, Any]) -> str | None:
    """What an answer depends on: the question; engine and all our code.

    ``None`` where the backend has no file, so that a change of it would not be seen.
    """
    module = sys.modules.get(type(backend).__module__)
    own = getattr(module, "__file__", None)
    if own is None:
        return None
    # beside a module that is in no package may lie anything
    adapter = Path(own).parent if getattr(module, "__package__", "") else Path(own)
    code = [_code(adapter), _code(Path(__file__).parents[2])]
    parts = [backend.name, backend.version(), *code, json.dumps(asked)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:32]


@functools.cache
def _code(folder: Path) -> str:
    """Digest of a module, or of all of a folder, read once in a process."""
    digest = hashlib.sha256()
    for path in [folder] if folder.is_file() else sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()
