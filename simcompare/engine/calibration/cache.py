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
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeVar

import platformdirs

from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.model import whole
from simcompare.model.plain import Finite, of_plain, plain

Answer = TypeVar("Answer")


class Versioned(Protocol):
    """What of a backend tells whether an answer still holds."""

    @property
    def name(self) -> str:
        """The engine's name."""

    def version(self) -> str:
        """Version of the engine."""


@dataclass(frozen=True)
class _Refusal:
    """That there is no answer, why, and the longest step with which there is one [s]."""

    cannot: str
    longest_step_s: Finite


def folder() -> Path:
    """Where answers are kept; SIMCOMPARE_CACHE names another folder."""
    own = os.environ.get("SIMCOMPARE_CACHE") or platformdirs.user_cache_dir("simcompare")
    return Path(own) / "calibrations"


def known(backend: Versioned, question: object, kind: type[Answer]) -> Answer | None:
    """The answer to a question where the cache has it.

    Raises:
        CannotCalibrate: it says that there is none.
    """
    path = _path(backend, question)
    stored = None
    # what is not there, or damaged, is found again
    with contextlib.suppress(OSError, ValueError, TypeError, KeyError, AttributeError):
        stored = None if path is None else _read(path, kind)
    if isinstance(stored, _Refusal):
        raise CannotCalibrate(stored.cannot, stored.longest_step_s)
    return stored


def kept(
    backend: Versioned, question: object, kind: type[Answer], find: Callable[[], Answer]
) -> Answer:
    """The answer to a question about an engine, from the cache where it is there.

    Args:
        backend: the engine's backend.
        question: what is asked, a frozen record.
        kind: the type of its answer.
        find: finds the answer.

    Raises:
        CannotCalibrate: there is none; that takes longest to find out, so it is kept, too.
    """
    before = known(backend, question, kind)
    if before is not None:
        return before
    path = _path(backend, question)
    try:
        found = plain(find())
    except CannotCalibrate as error:
        _write(path, plain(_Refusal(str(error), error.longest_step_s)))
        raise
    _write(path, found)
    return of_plain(kind, found)  # as it comes out of the cache


def _write(path: Path | None, found: object) -> None:
    if path is None:
        return
    with contextlib.suppress(OSError):  # where nothing can be kept, it is found again
        path.parent.mkdir(parents=True, exist_ok=True)
        text = json.dumps(found)
        whole.write(path, f"{_digest(text)}\n{text}".encode())


def _read(path: Path, kind: type[Answer]) -> Answer | _Refusal:
    digest, _, text = path.read_text(encoding="utf-8").partition("\n")
    if digest != _digest(text):  # changed, or cut off
        raise ValueError(path)
    found = json.loads(text)
    if isinstance(found, dict) and "cannot" in found:
        return of_plain(_Refusal, found)
    return of_plain(kind, found)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _path(backend: Versioned, question: object) -> Path | None:
    """The file of an answer, named after what it depends on: question, engine and all our code.

    ``None`` where the backend has no file, so that a change of it would not be seen.
    """
    module = sys.modules.get(type(backend).__module__)
    own = getattr(module, "__file__", None)
    if own is None:
        return None
    # beside a module that is in no package may lie anything
    adapter = Path(own).parent if getattr(module, "__package__", "") else Path(own)
    code = [_code(adapter), _code(Path(__file__).parents[2])]
    key = _digest("\n".join([backend.name, backend.version(), *code, repr(question)]))
    return folder() / f"{key[:32]}.json"


@functools.cache
def _code(folder: Path) -> str:
    """Digest of a module, or of all of a folder, read once in a process."""
    digest = hashlib.sha256()
    for path in [folder] if folder.is_file() else sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()
