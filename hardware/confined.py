"""One task in a process of its own, with limits of memory, disk and time.

Readers of foreign formats are large programs that were not made for hostile or damaged files: a
few kilobytes may ask for all memory, or never end. Their process is ended then, not the user's.
What it found comes back as JSON and plain numbers, which cannot execute anything.

On Linux the process is a fork where that is safe, which costs a few milliseconds; where other
threads run (a notebook), and on other systems, it is a new Python. Only Linux limits memory and
disk.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import json
import math
import os
import re
import select
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from simcompare.model.plain import Plain

#: files of the folder in which a task and its answer are, and all that is printed
REQUEST, ANSWER, NOISE = "request.json", "answer.json", "noise"
#: what is left of a limit when the process ends itself, should nobody else end it [s]
_GRACE_S = 5
#: how a process ends that finds no room for its files; what the system says then
_FULL, _NO_ROOM = 28, (errno.ENOSPC, errno.EDQUOT)
#: what BLAS libraries start no more threads by, and their function for the same
_ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
_BLAS_THREADS = re.compile(r"(/\S*openblas\S*)$", re.MULTILINE)
_SET_THREADS = [f"{a}openblas_set_num_threads{b}" for a in ("scipy_", "") for b in ("64_", "")]

#: takes the folder of a task, does it, and writes the answer there
Task = Callable[[Path], None]


@dataclass(frozen=True)
class Limits:
    """What a task may take.

    Attributes:
        memory_bytes: beside what the interpreter and its libraries need.
        file_bytes: size of each file that it lays down.
        seconds: until it has to end.
    """

    memory_bytes: int
    file_bytes: int
    seconds: float


@dataclass(frozen=True)
class Ending:
    """How the process of a task ended.

    Attributes:
        is_late: whether the time was over.
        signal: what killed it, 0 where nothing did.
        said: the last line that it printed, such as why it failed.
        is_full: whether there was no room for its files.
    """

    is_late: bool = False
    signal: int = 0
    said: str = ""
    is_full: bool = False


def run(task: Task, target: str, folder: Path, limits: Limits) -> Ending:
    """Does a task in a process, and waits for its end; nothing of it goes on.

    Args:
        task: what is done.
        target: the same as ``module:function``, for a new Python.
        folder: of the task; temporary files are made there, too.
        limits: what it may take.
    """
    start = _forked if fork_is_safe() else _started
    with start(task, target, folder, limits) as ending:
        return ending


def fork_is_safe() -> bool:
    """Whether this process can go on in a copy of itself: no other thread holds a lock there."""
    return sys.platform == "linux" and threading.active_count() == 1


def is_full(error: BaseException) -> bool:
    """Whether an error says that a disk is full."""
    is_known = isinstance(error, OSError) and error.errno in _NO_ROOM
    return is_known or os.strerror(errno.ENOSPC) in str(error)


def answer(folder: Path, content: Plain) -> None:
    """Writes what a task found."""
    partial = folder / f"{ANSWER}.partial"
    partial.write_text(json.dumps(content, default=str), encoding="utf-8")
    partial.rename(folder / ANSWER)


@contextlib.contextmanager
def _forked(task: Task, target: str, folder: Path, limits: Limits) -> Iterator[Ending]:
    del target
    reading, writing = os.pipe()  # its other end closes with the child, however that ends
    child = os.fork()
    if child == 0:
        _be_the_child(task, folder, limits)
    os.close(writing)
    try:
        ready, _, _ = select.select([reading], [], [], limits.seconds)
    finally:
        os.close(reading)
        _kill(child)
        _, status = os.waitpid(child, 0)
    killed_by = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
    no_room = os.WIFEXITED(status) and os.WEXITSTATUS(status) == _FULL
    yield Ending(not ready, killed_by, _last_line(folder), no_room)


def _last_line(folder: Path) -> str:
    try:
        with (folder / NOISE).open("rb") as file:
            file.seek(-min(file.seek(0, os.SEEK_END), 1000), os.SEEK_END)
            lines = file.read().decode("utf-8", errors="replace").split("\n")
    except OSError:
        return ""
    return next((line.strip() for line in reversed(lines) if line.strip()), "")


def _be_the_child(task: Task, folder: Path, limits: Limits) -> NoReturn:
    code = 0
    try:
        os.setsid()
        _redirect(folder)
        _confine(folder, limits)
        task(folder)
    except BaseException as error:  # noqa: BLE001  (the other process tells the last line)
        code = _FULL if is_full(error) else 0
        with contextlib.suppress(OSError):
            os.write(2, traceback.format_exc().encode("utf-8", errors="replace"))
    finally:
        os._exit(code)


def _redirect(folder: Path) -> None:
    """What libraries print goes into a file, and nothing can be read."""
    noise = os.open(folder / NOISE, os.O_CREAT | os.O_WRONLY | os.O_APPEND)
    nothing, end = os.pipe()
    os.close(end)
    for descriptor, instead in ((0, nothing), (1, noise), (2, noise)):
        os.dup2(instead, descriptor)


@contextlib.contextmanager
def _started(task: Task, target: str, folder: Path, limits: Limits) -> Iterator[Ending]:
    del task
    module, _, function = target.partition(":")
    told = [str(folder), limits.memory_bytes, limits.file_bytes, limits.seconds]
    code = (
        f"import sys; sys.path[:] = {sys.path!r}; from {__name__} import be_started;"
        f" from {module} import {function}; be_started({function}, *{told!r})"
    )
    with (folder / NOISE).open("ab") as noise:
        process = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.DEVNULL, stdout=noise, stderr=noise, start_new_session=True,
            env={**os.environ, **_ONE_THREAD},
        )  # fmt: skip
    is_late = False
    try:
        process.wait(limits.seconds)
    except subprocess.TimeoutExpired:
        is_late = True
    finally:
        _kill(process.pid) if hasattr(os, "killpg") else process.kill()
        code_ = process.wait()
    yield Ending(is_late, max(-code_, 0), _last_line(folder), code_ == _FULL)


def be_started(task: Task, folder: str, memory_bytes: int, file_bytes: int, seconds: float) -> None:
    """What a new Python does."""
    try:
        _confine(Path(folder), Limits(memory_bytes, file_bytes, seconds))
        task(Path(folder))
    except Exception as error:
        if not is_full(error):
            raise
        sys.exit(_FULL)


def _kill(child: int) -> None:
    """Ends a process that has not been waited for, and all that it started."""
    for end in (os.killpg, os.kill):  # it leads no group before its first step
        with contextlib.suppress(ProcessLookupError, PermissionError):
            end(child, signal.SIGKILL)


def _confine(folder: Path, limits: Limits) -> None:
    """Puts this process under its limits; what it was told by signals before is forgotten."""
    import tempfile

    tempfile.tempdir = str(folder)
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGALRM"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
    if hasattr(signal, "alarm"):  # should the parent be gone
        signal.alarm(math.ceil(limits.seconds) + _GRACE_S)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: it ends with its parent
        _limit(limits)


def _limit(limits: Limits) -> None:
    import resource

    _use_one_thread()
    # data, not address space: maps of files on disk are no memory
    _lower(resource.RLIMIT_DATA, _data_bytes() + limits.memory_bytes)
    _lower(resource.RLIMIT_FSIZE, limits.file_bytes)
    _lower(resource.RLIMIT_CORE, 0)


def _use_one_thread() -> None:
    """Lets BLAS start its threads now, and use none: their stacks are no memory of the task."""
    os.environ.update(_ONE_THREAD)
    maps = Path("/proc/self/maps").read_text(encoding="utf-8", errors="replace")
    for path in set(_BLAS_THREADS.findall(maps)):
        with contextlib.suppress(OSError):
            library = ctypes.CDLL(path)
            for name in _SET_THREADS:
                if hasattr(library, name):
                    getattr(library, name)(1)


def _lower(kind: int, wanted: int) -> None:
    """Sets a limit, where none that is lower is there."""
    import resource

    _, most = resource.getrlimit(kind)
    value = wanted if most == resource.RLIM_INFINITY else min(wanted, most)
    resource.setrlimit(kind, (value, value))


def _data_bytes() -> int:
    """What this process has of its own already."""
    for line in (
        Path("/proc/self/status").read_text(encoding="ascii", errors="replace").splitlines()
    ):
        if line.startswith("VmData:"):
            return int(line.split()[1]) * 1024
    return 0
