"""The folder of code from elsewhere, closed to all of it that nobody has said yes to.

In the process in which such code runs, a file of code in its folder is opened only as it was when
the yes was given. What lies in hidden folders was not looked at, and is not opened.
"""

from __future__ import annotations

import hashlib
import os
import sys
import threading
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simcompare.errors import InputError
from simcompare.scenarios import trust

#: events of Python that open a file, and which of their words names it
_EVENTS = {"open": 0, "import": 1, "ctypes.dlopen": 0}


def seal(source: Path, digest: str) -> None:
    """Closes the folder of a file for the rest of this process.

    Raises:
        InputError: the code in it is not that of the digest.
    """
    folder = source.parent
    code = trust.code(folder)
    if trust.digest(folder, code) != digest:
        raise InputError(str(source), ["code of its folder has changed since you said yes to it"])
    known = {path.resolve(): sha256 for path, sha256 in code.items()}
    sys.addaudithook(_Guard(folder.resolve(), known))


class _Guard:
    """Looks at each file that is to be opened.

    Args:
        folder: that is closed.
        known: what is open all the same, with its SHA-256.
    """

    def __init__(self, folder: Path, known: Mapping[Path, str]) -> None:
        self._folder, self._known = folder, known
        self._own = threading.local()
        # the Python that runs, and what its user has added to it
        roots = [Path(path).resolve() for path in (sys.prefix, sys.base_prefix, *sys.path)]
        self._installed = [root for root in roots if folder in root.parents]

    def __call__(self, event: str, words: tuple[Any, ...]) -> None:
        if event not in _EVENTS or getattr(self._own, "is_looking", False):
            return
        path = words[_EVENTS[event]]
        is_path = isinstance(path, (str, bytes, os.PathLike))
        if not is_path or (event == "open" and words[2] & (os.O_WRONLY | os.O_RDWR)):
            return
        self._own.is_looking = True
        try:
            self._look(Path(os.fsdecode(path)))
        finally:
            self._own.is_looking = False

    def _look(self, path: Path) -> None:
        if not trust.is_code(path.name):
            return
        real = path.resolve()
        if real in self._known:
            if hashlib.sha256(real.read_bytes()).hexdigest() != self._known[real]:
                raise PermissionError(f"{path} has changed since you said yes to its folder")
        elif real.exists() and (self._is_closed(real) or self._is_closed(path.absolute())):
            raise PermissionError(f"{path} is none of the code that you said yes to")

    def _is_closed(self, path: Path) -> bool:
        is_installed = any(path.is_relative_to(root) for root in self._installed)
        return path.is_relative_to(self._folder) and not is_installed
