"""Files that are either complete or not there, and never in place of a file of others."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from simcompare.errors import OutputError
from simcompare.model import whole
from simcompare.results.store import RECORD

#: our name, as the files that a program makes tell who made them
MADE_BY = "simcompare"
#: format -> what each of our files of it holds, and no other
MARKS: Mapping[str, bytes] = {
    "html": f'<meta name="generator" content="{MADE_BY}">'.encode(),
    "md": f"<!-- generator: {MADE_BY} -->".encode(),
    "pdf": f"/Creator ({MADE_BY})".encode(),
    "png": f"Software\0{MADE_BY}".encode(),
    "svg": f"<dc:title>{MADE_BY}</dc:title>".encode(),
    "gif": f"Made by {MADE_BY}".encode(),
    "mp4": MADE_BY.encode(),
}


def write(path: Path, content: bytes, mark: bytes) -> Path:
    """Writes a file beside its place and renames it; makes the folder where there is none.

    Args:
        path: where to.
        content: what.
        mark: what each of our files of this kind holds; a file without it is not replaced.

    Raises:
        OutputError: a file of others, or a stored run, is there; or it cannot be written, and
            nothing half-written is left behind.
    """
    path = free(path, mark)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        whole.write(path, content)
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        raise _unwritten(path, error) from None
    return path


def free(path: Path, mark: bytes) -> Path:
    """Where a file may be written: the place itself, or where its link leads.

    Args:
        path: where to.
        mark: what each of our files of this kind holds.

    Raises:
        OutputError: a file of others is there, or what is no file.
    """
    try:
        path = path.resolve() if path.is_symlink() else path
        if path.exists() and not path.is_file():
            raise OutputError(f"{path}: is no file, and is left as it is; choose another place")
        if path.exists() and not _is_ours(path, mark):
            raise OutputError(f"{path}: is another file, and is left as it is; choose another name")
    except OSError as error:
        raise _unwritten(path, error) from None
    return path


def _unwritten(path: Path, error: OSError | ValueError) -> OutputError:
    return OutputError(
        f"{path}: cannot be written ({getattr(error, 'strerror', None) or error});"
        " nothing was kept, free some space or choose another place"
    )


def _is_ours(path: Path, mark: bytes) -> bool:
    """Whether a file is one of ours of the same kind, or empty."""
    old = path.read_bytes()
    return not old or mark in old or _is_of_run(path)


def _is_of_run(path: Path) -> bool:
    """Whether it is called as a report or a figure in the folder of a run, also of an old one."""
    folder = path.parent
    return (path.stem == "report" and (folder / RECORD).is_file()) or (
        folder.name == "figures" and (folder.parent / RECORD).is_file()
    )
