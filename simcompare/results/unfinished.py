"""The folder of a run while it runs: what has finished is kept in it, part by part.

It has its final name from the beginning and no run.json until the end. Its maker holds the lock on
it for as long as it lives.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path

from simcompare.errors import InputError, OutputError
from simcompare.model import whole

#: folder in that of a run, in which each part is a file
PARTS = "unfinished"
_PART = re.compile(r"[a-z0-9][a-z0-9_-]*\.[a-z0-9]+")
_GOES_ON = "is the folder of a run that still goes on; wait for its end"
#: what a new folder is called after
_STAMP = re.compile(r"\d{8}-\d{6}-.+")


@dataclass(frozen=True, eq=False)
class Unfinished:
    """The folder of a run that has not ended.

    Attributes:
        folder: where the run will lie.
        held: holds the lock on it until :meth:`close`.
    """

    folder: Path
    held: contextlib.ExitStack

    def add(self, name: str, content: bytes) -> None:
        """Keeps a part; an older one of that name is replaced.

        Raises:
            OutputError: it cannot be written; nothing has changed then.
        """
        try:
            (self.folder / PARTS).mkdir(exist_ok=True)
            whole.write(self.folder / PARTS / name, content)
        except OSError as error:
            raise OutputError(
                f"{self.folder}: what has finished cannot be kept ({error.strerror or error});"
                " free some space or choose another --out"
            ) from None

    def parts(self) -> dict[str, bytes]:
        """What was kept, by name."""
        found = {}
        for path in sorted(_inside(self.folder / PARTS)):
            with contextlib.suppress(OSError), whole.opened(path) as file:
                found[path.name] = file.read()
        return found

    def carry(self, made: Path, *, parts: bool) -> None:
        """Puts into a folder that will take the place of this one what is nowhere else.

        Args:
            made: that folder.
            parts: whether what was kept goes along, beside what others have laid there.
        """
        whole.sweep(self.folder / PARTS)
        for path in self.folder.iterdir():
            is_left = not parts if path.name == PARTS else path.stem == "report"
            if is_left or (made / path.name).exists():
                continue
            if path.is_dir() and not path.is_symlink():
                shutil.copytree(path, made / path.name, symlinks=True, copy_function=_linked)
            else:
                _linked(path, made / path.name)

    def drop(self) -> None:
        """Deletes the folder with what was kept in it."""
        shutil.rmtree(self.folder / PARTS, ignore_errors=True)
        self.drop_empty()
        self.close()

    def drop_empty(self) -> None:
        """Deletes the folder where nothing is in it."""
        with contextlib.suppress(OSError):
            _drop_empty(self.folder)

    def close(self) -> None:
        """Gives the lock back."""
        self.held.close()


def begin(folder: Path, created: str, name: str) -> Unfinished:
    """Makes the folder of a run that begins.

    Args:
        folder: in which it is made.
        created: date and time, ISO 8601.
        name: what it is called after the time.

    Raises:
        OutputError: it cannot be made.
    """
    try:
        begun = reserve(folder, created, name)
        (begun.folder / PARTS).mkdir()
    except OSError as error:
        raise OutputError(
            f"--out {folder}: cannot be written to ({error.strerror}); choose another folder"
        ) from None
    return begun


def reserve(folder: Path, created: str, name: str) -> Unfinished:
    """Makes an empty folder with a free name, for this call alone.

    Raises:
        OSError: it cannot be made.
    """
    folder.mkdir(parents=True, exist_ok=True)
    _sweep(folder)
    stamp = created[:19].replace("-", "").replace(":", "").replace("T", "-")
    for number in itertools.count(1):
        place = folder / (f"{stamp}-{name}" if number == 1 else f"{stamp}-{name}-{number}")
        with contextlib.ExitStack() as held, contextlib.suppress(FileExistsError):
            place.mkdir()
            if whole.lock(place, held) is not False:
                return Unfinished(place, held.pop_all())
    raise AssertionError


def opened(folder: Path) -> Unfinished:
    """The folder of a run that was ended early, to go on with it.

    Raises:
        InputError: it is none, its maker still runs, or nobody can know whether it does.
    """
    if not is_unfinished(folder):
        raise InputError(str(folder), ["is not the folder of a run that was ended early"])
    held = contextlib.ExitStack()
    taken = whole.lock(folder, held)
    if not taken:
        held.close()
        raise InputError(str(folder), [_GOES_ON if taken is False else _unknown(folder)])
    return Unfinished(folder, held)


def is_unfinished(folder: Path) -> bool:
    """Whether a folder holds parts of a run that was ended early; a link to one is none."""
    parts = folder / PARTS
    return not folder.is_symlink() and parts.is_dir() and not parts.is_symlink()


def is_running(folder: Path) -> bool | None:
    """Whether the maker of an unfinished run still lives; ``None`` where nobody can know."""
    with contextlib.ExitStack() as held:
        taken = whole.lock(folder, held)
        return None if taken is None else not taken


def is_part(path: Path) -> bool:
    """Whether a path is, by its name, that of a part that was kept."""
    return path.parent.name == PARTS and _PART.fullmatch(path.name) is not None


def resuming(folder: Path) -> str:
    """The command that goes on with a run."""
    return shlex.join(["simcompare", "run", "--resume", str(folder)])


def _unknown(folder: Path) -> str:
    words = shlex.join(["cp", "-r", str(folder), "."])
    return (
        "may still go on: its disk has no locks that would tell; if it has ended, copy it to"
        f" another disk and go on there: {words} && {resuming(Path(folder.resolve().name))}"
    )


def _linked(old: str | Path, new: str | Path) -> None:
    """The same file under another name, which takes no room; a copy where it must be one."""
    try:
        os.link(old, new, follow_symlinks=False)
    except OSError:
        shutil.copy2(old, new, follow_symlinks=False)


def _inside(parts: Path) -> list[Path]:
    """The files of parts; what else lies beside them is left alone."""
    if not parts.is_dir() or parts.is_symlink():
        return []
    return [path for path in parts.iterdir() if _PART.fullmatch(path.name)]


def _sweep(folder: Path) -> None:
    """Deletes folders in which dead writers have kept nothing yet."""
    for path in folder.iterdir():
        if _STAMP.fullmatch(path.name) and path.is_dir() and not path.is_symlink():
            with contextlib.ExitStack() as held, contextlib.suppress(OSError):
                if {one.name for one in path.iterdir()} <= {PARTS} and whole.lock(path, held):
                    _drop_empty(path)


def _drop_empty(folder: Path) -> None:
    """Deletes the folder of a run that keeps nothing.

    Raises:
        OSError: it does.
    """
    parts = folder / PARTS
    if parts.is_dir():
        whole.sweep(parts)
        parts.rmdir()
    folder.rmdir()
