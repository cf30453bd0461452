"""Logs are read in a process of their own, whose limits follow from the size of the log."""

from __future__ import annotations

import contextlib
import errno
import itertools
import json
import os
import tempfile
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from simcompare import errors
from simcompare.errors import InputError, SimcompareError
from simcompare.hardware import carried, confined, importing
from simcompare.hardware.mapping import NOTHING, Mapping
from simcompare.model import plain, user_file, whole
from simcompare.model.recording import Recording

#: a user who knows better gives more memory [MB] or time [s] by these variables
MEMORY_VARIABLE, TIME_VARIABLE = "SIMCOMPARE_LOG_MEMORY_MB", "SIMCOMPARE_LOG_TIME_S"
#: memory: so many times the log, and so much beside it
TIMES, BASE_MB = 10, 256
#: time: so long for any log, and so much more for each megabyte
BASE_S, S_PER_MB = 20.0, 1.0
#: a temporary file may be so much larger than the memory
_DISK_TIMES = 4
#: files of a folder whose sizes are asked for
_MOST_FILES = 10_000
_MB = 1 << 20
_FULL = (
    "is full, and logs are laid down there while they are read; free some space in it, or name"
    " another folder, as in: TMPDIR=/var/tmp"
)


@dataclass(frozen=True)
class _Request:
    """What is asked of the process; ``template`` instead of a recording."""

    path: str
    mapping: Mapping
    kind: str | None = None
    strict: bool = False
    assume_units: bool = False
    about: dict[str, str] | None = None
    template: bool = False


def template(log: str | Path, *, kind: str | None = None) -> str:
    """A mapping file for a log, to be filled in; see ``importing.template``.

    Raises:
        InputError: the log cannot be read, or takes more than a log of its size may.
    """
    with _folder() as folder:
        content = _asked(_Request(str(log), NOTHING, kind, template=True), folder)
    return str(content["template"])


def read(
    path: Path,
    mapping: Mapping,
    *,
    kind: str | None = None,
    strict: bool = False,
    assume_units: bool = False,
    about: dict[str, str] | None = None,
) -> Recording:
    """Reads and conditions a log; see ``importing.read``.

    Raises:
        InputError: what is wrong with the log, or that it takes more than one of its size may.
    """
    request = _Request(str(path), mapping, kind, strict, assume_units, about)
    with _folder() as folder:
        content = _asked(request, folder)
        return carried.put_together(content, folder)


# ---- this process -----------------------------------------------------------------------------


@contextlib.contextmanager
def _folder() -> Iterator[Path]:
    """Where a log is laid down while it is read."""
    try:
        with whole.temporary("simcompare-log-") as folder:
            yield folder
    except OSError as error:
        if not confined.is_full(error):
            raise
        raise InputError(tempfile.gettempdir(), [_FULL]) from None


def _asked(request: _Request, folder: Path) -> plain.Plain:
    path = Path(request.path)
    user_file.check_is_stored(path)
    size = _size(path)
    limits = _limits(size)
    request_ = plain.text(request)
    (folder / confined.REQUEST).write_text(request_, encoding="utf-8")
    ending = confined.run(serve, f"{__name__}:serve", folder, limits)
    answer = folder / confined.ANSWER
    if ending.is_full:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    if not answer.exists():
        raise InputError(str(path), [_why_not(ending, size, limits)])
    if answer.stat().st_size > limits.memory_bytes:
        raise InputError(str(path), [_over("memory", size, limits)])
    content = cast("plain.Plain", json.loads(answer.read_text(encoding="utf-8")))
    if "over" in content:
        raise InputError(str(path), [_over(content["over"], size, limits)])
    if "error" in content:
        raise _restored(content)
    return content


def _size(path: Path) -> int:
    """Bytes of a log that lie on the disk; a file with holes has fewer than it says."""
    try:
        if path.is_dir():
            inside = itertools.islice(path.rglob("*"), _MOST_FILES)
            return sum(_on_disk(one) for one in inside if one.is_file())
        return _on_disk(path)
    except (OSError, ValueError):
        return 0  # the reader says what is wrong


def _on_disk(path: Path) -> int:
    about = path.stat()
    return min(about.st_size, getattr(about, "st_blocks", about.st_size) * 512)


def _limits(size: int) -> confined.Limits:
    megabytes = _told(MEMORY_VARIABLE, BASE_MB + TIMES * size / _MB)
    memory = int(megabytes * _MB)
    seconds = _told(TIME_VARIABLE, BASE_S + S_PER_MB * size / _MB)
    return confined.Limits(memory, _DISK_TIMES * memory, seconds)


def _told(variable: str, otherwise: float) -> float:
    told = os.environ.get(variable)
    if told is None:
        return otherwise
    try:
        number = float(told)
    except ValueError:
        number = 0.0
    if not 1 <= number <= 1e9:
        raise InputError(variable, [f"is {told!r}; expected a number between 1 and 1e9"])
    return number


def _why_not(ending: confined.Ending, size: int, limits: confined.Limits) -> str:
    if ending.is_late:
        return _over("time", size, limits)
    if not ending.signal:
        return f"cannot be read: its reader failed ({ending.said or 'it says nothing'}); try again"
    return (
        f"its reader was ended by signal {ending.signal}: the file is damaged, or the machine has"
        " too little memory; try again, or copy the file from the device again"
    )


def _over(what: str, size: int, limits: confined.Limits) -> str:
    memory, disk = limits.memory_bytes / _MB, limits.file_bytes / _MB
    if what == "time":
        limit, variable, more = f"{limits.seconds:.0f} s", TIME_VARIABLE, 10 * limits.seconds
    else:
        limit = f"{memory if what == 'memory' else disk:.0f} MB"
        variable, more = MEMORY_VARIABLE, 10 * memory
    return (
        f"needs more {what} than a log of {_spoken(size)} may take ({limit}): it is damaged, or"
        f" holds far more than it seems; if it is right, allow more: {variable}={more:.0f}"
    )


def _spoken(size: int) -> str:
    for unit, scale in (("GB", 1e9), ("MB", 1e6), ("kB", 1e3)):
        if size >= scale:
            return f"{size / scale:.3g} {unit}"
    return f"{size} bytes"


def _restored(content: plain.Plain) -> Exception:
    """The error that the process met."""
    kind = getattr(errors, content["error"], None)
    if not (isinstance(kind, type) and issubclass(kind, SimcompareError)):
        failed = RuntimeError(f"{content['error']}: {content['text']}")
        failed.add_note(content["trace"])
        return failed
    error = kind.__new__(kind)
    error.args = tuple(content["args"])
    state = content["state"].items()
    error.__dict__.update({k: tuple(v) if isinstance(v, list) else v for k, v in state})
    if content["trace"]:
        error.add_note(content["trace"])
    return error


# ---- the other process ------------------------------------------------------------------------


def serve(folder: Path) -> None:
    """Reads the log of a request, and writes what was found, or what hindered it."""
    text = (folder / confined.REQUEST).read_text(encoding="utf-8")
    try:
        content = _answered(plain.of_plain(_Request, json.loads(text)), folder)
        confined.answer(folder, content)
    except Exception as error:
        if confined.is_full(error):
            raise
        over = _exceeded(error)
        content = {"over": over} if over else _told_error(error)
        del error
    else:
        return
    confined.answer(folder, content)


def _answered(request: _Request, folder: Path) -> plain.Plain:
    path = Path(request.path)
    if request.template:
        return {"template": importing.template(path, kind=request.kind)}
    recording = importing.read(
        path, request.mapping, kind=request.kind, strict=request.strict,
        assume_units=request.assume_units, about=request.about,
    )  # fmt: skip
    return carried.take_apart(recording, folder)


def _exceeded(error: BaseException) -> str:
    """Which limit an error comes from, empty where from none."""
    for cause in _chain(error):
        name = type(cause).__name__
        if isinstance(cause, MemoryError) or "OutOfMemory" in name:
            return "memory"
        if isinstance(cause, OSError) and cause.errno == errno.ENOMEM:
            return "memory"
        if isinstance(cause, OSError) and cause.errno == errno.EFBIG:
            return "room on the disk"
    return ""


def _chain(error: BaseException | None) -> Iterator[BaseException]:
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _told_error(error: Exception) -> plain.Plain:
    cause = error if not isinstance(error, SimcompareError) else error.__cause__
    trace = "".join(traceback.format_exception(cause)) if cause is not None else ""
    name = type(error).__name__
    state = {k: v for k, v in vars(error).items() if not k.startswith("__")}
    told: plain.Plain = {"error": name, "trace": trace, "text": str(error)}
    if isinstance(error, SimcompareError):
        told |= {"args": list(error.args), "state": state}
    return told
