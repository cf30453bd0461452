"""Code beside a scenario runs if it is ours, or if the user has said yes to it.

What was said yes to is remembered by its digest: changed code is asked for again.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sysconfig
from collections.abc import Iterator
from pathlib import Path

from simcompare.engine.calibration import cache
from simcompare.errors import InputError, UntrustedCode

#: how files end that Python may run
_CODE = frozenset(
    [".py", ".pyw", ".pyc", ".pyo", ".so", ".pyd", ".dll", ".dylib", ".zip", ".egg", ".whl"]
)  # fmt: skip
#: files and folders beside a scenario through which code is looked for, and bytes of it
_MOST_PLACES, _MOST_BYTES = 2000, 64 * 2**20
_SHIPPED = Path(__file__).resolve().parent
#: said yes to in this process, also where nothing can be kept
_allowed: set[str] = set()


def is_ours(source: Path) -> bool:
    """Whether code is shipped with simcompare or with an installed package."""
    installed = (sysconfig.get_path(name) for name in ("purelib", "platlib"))
    places = [_SHIPPED, *(Path(folder).resolve() for folder in installed)]
    return any(source.resolve().is_relative_to(place) for place in places)


def allow(source: Path) -> None:
    """Remembers a yes to the code in the folder of a file."""
    digest = digest_of(source)
    _allowed.add(digest)
    with contextlib.suppress(OSError):  # then it holds for this process
        _folder().mkdir(parents=True, exist_ok=True)
        (_folder() / digest).touch()


def require(source: Path) -> str:
    """The digest of the code in the folder of a file.

    Raises:
        UntrustedCode: nobody has said yes to it.
    """
    digest = digest_of(source)
    if digest not in _allowed and not (_folder() / digest).is_file():
        raise UntrustedCode(source, digest)
    return digest


def digest_of(source: Path) -> str:
    """SHA-256 of all code in the folder of a file and below, with its names.

    Raises:
        InputError: there is too much of it, or it cannot be read.
    """
    folder, whole, size = source.parent, hashlib.sha256(), 0
    for path in sorted(_code(folder)):
        size += path.stat().st_size
        if size > _MOST_BYTES:
            raise _too_much(folder)
        try:
            content = hashlib.sha256(path.read_bytes()).hexdigest()
        except OSError as error:
            raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
        whole.update(f"{content} {os.fsencode(path.relative_to(folder)).hex()}\n".encode())
    return whole.hexdigest()


def _code(folder: Path) -> Iterator[Path]:
    seen, places = set(), 0
    for inside, folders, files in os.walk(folder, followlinks=True):
        real = Path(inside).resolve()
        # what Python compiled itself is not read where such code runs
        kept = [] if real in seen else [name for name in folders if name != "__pycache__"]
        folders[:] = kept
        seen.add(real)
        places += len(files) + len(folders)
        if places > _MOST_PLACES:
            raise _too_much(folder)
        paths = (Path(inside, name) for name in files)
        yield from (path for path in paths if path.suffix.lower() in _CODE and path.is_file())


def _too_much(folder: Path) -> InputError:
    return InputError(
        str(folder),
        ["holds too much beside the scenario to look at its code; give it a folder of its own"],
    )


def _folder() -> Path:
    return cache.folder().with_name("trusted")
