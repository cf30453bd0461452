"""One tree of errors; every message says what was found, what was expected and what to do.

Every error that a user can cause derives from :class:`SimcompareError` and carries the exit code
with which the command line ends (2: usage or file, 3: an engine is missing or broken).
"""

from __future__ import annotations

import difflib
import itertools
import os
import re
import shlex
import sys
import traceback
from collections.abc import Iterable, Sequence
from pathlib import Path

#: exit code of what Ctrl-C, or the end of a terminal or of a batch job, has ended
INTERRUPTED = 130
#: folder of our own code
_HERE = Path(__file__).parent
#: faults of a file that are told; whoever made so many made most of them the same way
_TOLD = 50
#: how names of files end, and no name of ours
_ENDING = re.compile(r"\.[A-Za-z]\w{0,7}$")


class SimcompareError(Exception):
    """Anything simcompare reports to its user in one sentence.

    Attributes:
        exit_code: exit code of the command line.
    """

    exit_code = 2

    def __reduce__(self) -> tuple[object, ...]:
        """As it is, also where its class takes other arguments than the message."""
        return _restored, (type(self), self.args, self.__dict__)

    def _render_traceback_(self) -> list[str]:
        """What a notebook shows in place of a traceback: the user's own line, and the message."""
        frames = traceback.extract_tb(self.__traceback__)
        before = itertools.takewhile(lambda frame: not _is_ours(frame.filename), frames)
        where = [f"line {frame.lineno}: {frame.line}" for frame in [*before][-1:]]
        return [*where, f"{type(self).__name__}: {self}"]


def _is_ours(file: str) -> bool:
    return Path(file).is_relative_to(_HERE)


def _restored(
    kind: type[SimcompareError], args: tuple[object, ...], state: dict[str, object]
) -> SimcompareError:
    error = kind.__new__(kind)
    error.args = args
    error.__dict__.update(state)
    return error


class InputError(SimcompareError):
    """A file or an argument is not what it must be.

    Args:
        where: file (and place) or argument in which the faults stand.
        faults: every fault found, one sentence each.
    """

    def __init__(self, where: str, faults: Sequence[str]) -> None:
        self.where = where
        self.faults = tuple(faults)
        where = where.replace("\n", "\\n")  # a name may hold one, and forge a line
        if len(self.faults) == 1:
            message = f"{where}: {self.faults[0]}"
        else:
            lines = "".join(f"\n  - {fault}" for fault in self.faults[:_TOLD])
            more = len(self.faults) - _TOLD
            lines += f"\n  - … and {more} more" if more > 0 else ""
            message = f"{where}: {len(self.faults)} faults{lines}"
        super().__init__(message)


class UntrustedCode(InputError):
    """Code from elsewhere would have to run, and the user has not said yes to it.

    Args:
        source: the file.
        digest: of all code in its folder.
    """

    def __init__(self, source: Path, digest: str) -> None:
        self.source, self.digest = source, digest
        super().__init__(
            str(source),
            [
                f"is code from elsewhere (SHA-256 {digest[:12]}), and was not run;"
                " read it, and if you trust all Python files of its folder, add --trust once"
            ],
        )


class UnknownName(SimcompareError):
    """A scenario, engine, parameter or preset of that name does not exist.

    Args:
        kind: what was looked for ("scenario", "engine", …).
        name: the name that was given.
        known: the names that exist.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        self.kind, self.name, self.known = kind, name, tuple(sorted(known))
        near = difflib.get_close_matches(name, self.known, n=3, cutoff=0.5)
        if not self.known:
            super().__init__(f"no {kind} is called {name!r:.100}; there is none at all")
            return
        hint = f"did you mean {' or '.join(near)}?" if near else f"known: {', '.join(self.known)}"
        super().__init__(f"no {kind} is called {name!r:.100}; {hint}")


class NoSuchFile(InputError):
    """A path leads to nothing, or to no file or folder as is expected.

    Names what is nearly called so in its folder.

    Args:
        path: as it was given.
        expected: what it should lead to, such as "a fit.json of simcompare fit".
    """

    def __init__(self, path: str | Path, expected: str = "") -> None:
        folder = Path(path).parent
        if exists(Path(path)):
            fault = "is a folder" if Path(path).is_dir() else "is a file"
        elif not folder.is_dir():
            fault = f"there is no folder {folder}"
        else:
            near = _near_files(Path(path))
            fault = "there is no such file or folder"
            fault += f"; did you mean {' or '.join(near)}?" if near else ""
        super().__init__(str(path), [fault + (f"; expected {expected}" if expected else "")])


def unknown_or_missing(kind: str, name: str, known: Iterable[str]) -> SimcompareError:
    """The error for what is neither a known name nor a file, whichever of both was meant."""
    if _is_path(name) and not exists(Path(name)):
        return NoSuchFile(name)
    return UnknownName(kind, name, known)


def _is_path(name: str) -> bool:
    """Whether a text can only mean a file: a slash, a dot before it, or the end of a file."""
    return os.sep in name or name.startswith((".", "~")) or bool(_ENDING.search(name))


def exists(path: Path) -> bool:
    """Whether a path leads to something; a name that no file system takes does not."""
    try:
        return path.exists()
    except OSError:  # a name too long for the file system
        return False


def _near_files(path: Path) -> list[str]:
    """What lies beside a path and is nearly called so, as it can be typed."""
    try:
        names = sorted(entry.name for entry in os.scandir(path.parent))
    except OSError:
        return []
    plain = {name.lower(): name for name in names if not name.startswith(".")}
    near = difflib.get_close_matches(path.name.lower(), plain, n=3, cutoff=0.6)
    return [str(path.with_name(plain[name])) for name in near]


class UnknownVariant(UnknownName):
    """An engine has no variant of that name.

    Args:
        engine: name of the engine.
        name: the name that was given.
        known: the variants that it has.
    """

    def __init__(self, engine: str, name: str, known: Iterable[str]) -> None:
        super().__init__(f"variant of {engine}", name, known)
        cure = f"it has {', '.join(self.known)}" if self.known else "it has none; leave it out"
        self.args = (f"{engine} has no variant {name!r}; {cure}",)


class SignalLacking(UnknownName):
    """A source cannot give a signal; what needs it stays without a value.

    Args:
        source: name of the source.
        signal: the signal.
        reason: why.
        known: the signals that it has.
    """

    def __init__(self, source: str, signal: str, reason: str, known: Iterable[str]) -> None:
        super().__init__(f"signal of {source}", signal, known)
        self.args = (f"{source} does not give {signal}: {reason}",)


class EngineElsewhere(UnknownName):
    """An engine that simcompare cannot run; a user who has it can carry scenes there.

    Args:
        name: the name that was given.
        title: the engine's full name.
        why: why it cannot run.
        cures: what can be done, a sentence or a command each.
        known: the engines that can run.
    """

    def __init__(
        self, name: str, title: str, why: str, cures: Sequence[str], known: Iterable[str]
    ) -> None:
        super().__init__("engine", name, known)
        lines = "".join(f"\n  - {cure}" for cure in cures)
        self.args = (f"{title} cannot run here. {why}{lines}",)


class OutputError(SimcompareError):
    """The results could not be written; nothing half-written is left behind."""


class BackendError(SimcompareError):
    """An engine cannot do what was asked of it."""

    exit_code = 3


class EngineMissing(BackendError):
    """The engine's package is not installed.

    Args:
        engine: name of the engine.
        module: what was not found.
        install: the command that cures it.
        kind: what that is, a "module" of Python, a "library" of the system or a "program".
    """

    def __init__(self, engine: str, module: str, install: str, kind: str = "module") -> None:
        self.engine, self.module, self.install = engine, module, install
        super().__init__(
            f"{engine} is not installed (no {kind} {module!r}); cure: {to_paste(install)}"
        )


def to_paste(command: str) -> str:
    """A command that installs something, as it works here: this Python's pip, root without sudo."""
    python = min(os.path.relpath(sys.executable), sys.executable, key=len)
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        command = command.replace("sudo ", "")
    return command.replace("pip install", f"{shlex.quote(python)} -m pip install")


class EngineBroken(BackendError):
    """The engine's package is installed and cannot be loaded."""


class Unsupported(BackendError):
    """The engine has no such feature; the scenario cannot run on it as it is."""


class ReadBackMismatch(BackendError):
    """The engine holds another value than the one that was set.

    Args:
        engine: name of the engine.
        rows: one sentence for each value that differs.
    """

    def __init__(self, engine: str, rows: Sequence[str]) -> None:
        self.engine, self.rows = engine, tuple(rows)
        super().__init__(f"{engine} did not take what was set: " + "; ".join(rows))


class SimulationDiverged(BackendError):
    """The engine produced numbers that are not finite."""
