"""Files and folders that are written whole or not at all, whoever else writes there.

What is being written has a hidden name of its own beside its place, and takes the place in one
step. A writer holds a lock on it for as long as it lives; the next writer in the same folder
deletes what dead ones have left. Where a file system has no locks, nobody can know who is dead:
everything stays.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import os
import re
import secrets
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from io import BufferedReader
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows has no such locks
    fcntl = None  # type: ignore[assignment]

#: the hidden names; nothing in them comes from the place, whose name may be as long as can be
_HIDDEN = re.compile(r"\.simcompare-[0-9a-f]{16}\.partial")
#: what the system says where a folder is not empty
_TAKEN = (errno.ENOTEMPTY, errno.EEXIST, errno.EACCES)
#: of Linux: names are taken from the current folder; both change places
_AT_FDCWD, _EXCHANGE = -100, 2


@contextlib.contextmanager
def folder(place: Path) -> Iterator[Path]:
    """An empty hidden folder, which is put in place when the block ends without an error.

    Args:
        place: where it will lie; a folder that is there then is replaced.

    Raises:
        OSError: it cannot be written; nothing has changed then.
    """
    with _hidden(place, Path.mkdir) as made:
        yield made
        _put(made, place)


def write(place: Path, content: bytes) -> None:
    """Writes a file; an older one is replaced.

    Raises:
        OSError: it cannot be written; nothing has changed then.
    """
    with _hidden(place, lambda path: path.open("xb").close()) as made:
        made.write_bytes(content)
        made.replace(place)


@contextlib.contextmanager
def temporary(prefix: str) -> Iterator[Path]:
    """A folder for the time of the block; what killed processes have left of such goes, too.

    Args:
        prefix: what its name begins with, and that of nothing else.

    Raises:
        OSError: it cannot be made.
    """
    for left in Path(tempfile.gettempdir()).glob(f"{prefix}*"):
        _sweep(left)
    with _locked(lambda: Path(tempfile.mkdtemp(prefix=prefix))) as made:
        yield made


def probe(inside: Path) -> None:
    """Proves that a folder can be written to.

    Raises:
        OSError: it cannot.
    """
    with _hidden(inside / "probe", Path.mkdir):
        pass


def sweep(inside: Path) -> None:
    """Deletes what dead writers have left in a folder."""
    with contextlib.suppress(OSError):
        for entry in os.scandir(inside):
            if _HIDDEN.fullmatch(entry.name):
                _sweep(Path(entry.path))


@contextlib.contextmanager
def opened(path: Path, *, links: bool = False) -> Iterator[BufferedReader]:
    """A file of a stored folder, opened for reading: a pipe or a device is none.

    Args:
        path: the file.
        links: whether a link to a file is one.

    Raises:
        OSError: it is none, or cannot be opened.
    """
    if not stat.S_ISREG(path.stat(follow_symlinks=links).st_mode):
        raise OSError("it is no file" if links else "it is no file, or a link")
    opener = _followed if links else _not_followed
    with open(path, "rb", opener=opener) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):  # it has just been changed
            raise OSError("it is no file")
        yield file


def lock(path: Path, held: contextlib.ExitStack) -> bool | None:
    """Takes the lock on a file or folder for as long as ``held`` is open.

    Returns:
        Whether it could be taken; it cannot where another process has it, or nothing is there.
        ``None`` where there are no locks, so that nobody can know.
    """
    if fcntl is None:
        return None
    try:
        handle = os.open(path, os.O_RDONLY)
        held.callback(os.close, handle)
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return os.path.samestat(os.fstat(handle), path.stat())
    except (BlockingIOError, FileNotFoundError):
        return False
    except OSError:  # this file system has no locks
        return None


@contextlib.contextmanager
def _hidden(place: Path, make: Callable[[Path], None]) -> Iterator[Path]:
    """Something hidden beside a place, locked, which is gone afterwards whatever happens."""

    def begin() -> Path:
        path = place.with_name(f".simcompare-{secrets.token_hex(8)}.partial")
        make(path)
        return path

    sweep(place.parent)
    with _locked(begin) as made:
        yield made


@contextlib.contextmanager
def _locked(make: Callable[[], Path]) -> Iterator[Path]:
    """Something new, locked, which is gone afterwards."""
    with contextlib.ExitStack() as stack:
        while True:
            made = make()
            stack.callback(_remove, made)
            if lock(made, stack) is not False:  # else a writer has just taken it for a dead one's
                break
        yield made


def _followed(path: str, flags: int) -> int:
    """Opens a file; the writer of a pipe is not waited for."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _not_followed(path: str, flags: int) -> int:
    """Opens a file that is no link."""
    return _followed(path, flags | getattr(os, "O_NOFOLLOW", 0))


def _sweep(path: Path) -> None:
    with contextlib.ExitStack() as held:
        if lock(path, held):
            _remove(path)


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def _put(made: Path, place: Path) -> None:
    """Puts a folder in its place; what was there has the hidden name afterwards."""
    try:
        made.rename(place)
    except OSError as error:
        if error.errno not in _TAKEN or not place.is_dir():
            raise
        if not _exchanged(made, place):
            _put_in_two_steps(made, place)


def _exchanged(one: Path, other: Path) -> bool:
    """Lets two folders change places in one step, where the system can."""
    exchange = getattr(ctypes.CDLL(None), "renameat2", None) if os.name == "posix" else None
    if exchange is None:
        return False
    names = os.fsencode(one), os.fsencode(other)
    return bool(exchange(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _EXCHANGE) == 0)


def _put_in_two_steps(made: Path, place: Path) -> None:
    old = place.with_name(f".simcompare-{secrets.token_hex(8)}.partial")
    place.rename(old)
    try:
        made.rename(place)
    except OSError:
        old.rename(place)
        raise
    _remove(old)
