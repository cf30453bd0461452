"""Which formats can be read: one file ``<format>_.py`` each in this folder, and entry points.

An importer is a module (or object) with

* ``TITLE``: what it reads, in a few words;
* ``recognises(head: Head) -> int``: 0 (not mine) to 100 (certainly mine), by content, not by name;
* ``read(path: Path, mapping: Mapping) -> RawLog``: raises ``InputError`` that names file and place.

Other packages add theirs by an entry point of the group ``simcompare.importers``.
"""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
import zipfile
from pathlib import Path
from typing import Protocol, cast

from simcompare.errors import EngineMissing, InputError, NoSuchFile, SimcompareError, UnknownName
from simcompare.hardware.logs import foreign
from simcompare.hardware.mapping import Mapping
from simcompare.hardware.raw import IMPORT, Head, RawLog, told_apart

ENTRY_POINT_GROUP = "simcompare.importers"
#: bytes by which a format is recognised
HEAD_BYTES = 1 << 16
#: from here on an importer is believed, whatever else the file looks like
_CERTAIN = 50
_FOLDER = Path(__file__).parent


class Importer(Protocol):
    """What every importer offers."""

    TITLE: str

    def recognises(self, head: Head) -> int:
        """How certain it is that the log is of this format, 0 to 100."""
        ...

    def read(self, path: Path, mapping: Mapping) -> RawLog:
        """Reads the whole log."""
        ...


@functools.cache
def targets() -> dict[str, str]:
    """Every known format and where its importer is, as a module or ``module:attribute``."""
    modules = {
        path.stem[:-1]: f"simcompare.hardware.logs.{path.stem}"
        for path in sorted(_FOLDER.glob("[a-z]*_.py"))
    }
    for point in importlib.metadata.entry_points(group=ENTRY_POINT_GROUP):
        modules.setdefault(point.name, point.value)
    return modules


def get(name: str) -> Importer:
    """The importer of a format.

    Raises:
        UnknownName: there is none.
    """
    known = targets()
    if name not in known:
        raise UnknownName("format", name, known)
    module, _, attribute = known[name].partition(":")
    loaded = importlib.import_module(module)
    return cast(Importer, getattr(loaded, attribute) if attribute else loaded)


def head_of(path: Path) -> Head:
    """The beginning of a log.

    Raises:
        InputError: there is no such file, it is empty, or it cannot be read.
    """
    try:
        if path.is_dir():
            inside = sorted(str(p.relative_to(path)) for p in path.rglob("*") if p.is_file())
            return Head(path, b"", tuple(inside[:1000]))
        with path.open("rb") as file:
            start = file.read(HEAD_BYTES)
    except FileNotFoundError:
        raise NoSuchFile(path) from None
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    if not start:
        raise InputError(str(path), ["is empty; expected a log with at least two samples"])
    members: list[str] = []
    if start.startswith(b"PK\x03\x04"):
        try:
            with zipfile.ZipFile(path) as archive:
                members = archive.namelist()
        except (zipfile.BadZipFile, OSError, NotImplementedError, ValueError) as error:
            raise InputError(
                str(path), [f"is a damaged zip archive ({error}); copy it from the device again"]
            ) from None
    return Head(path, start, tuple(members))


def recognise(path: Path) -> str:
    """Name of the format that a log has, by its content.

    Raises:
        InputError: none fits, or several fit equally well.
    """
    head = head_of(path)
    certainty = {name: get(name).recognises(head) for name in targets()}
    best = max(certainty.values(), default=0)
    names = [name for name, value in certainty.items() if value == best]
    other = foreign.kind_of(head)
    if other and best < _CERTAIN:
        raise InputError(str(path), [other])
    if best <= 0:
        cure = f"name it ({', '.join(targets())}): {IMPORT} --as FORMAT"
        raise InputError(str(path), [f"is of no known format; {cure}"])
    if len(names) > 1:
        raise InputError(
            str(path), [f"may be {' or '.join(names)}; say which: {IMPORT} --as {names[0]}"]
        )
    return names[0]


def read(path: Path, kind: str, mapping: Mapping) -> RawLog:
    """Reads a log with the importer of a format.

    Raises:
        SimcompareError: what is wrong with the file, or which package is missing.
    """
    importer = get(kind)
    try:
        log = importer.read(path, mapping)
        for stream in log.streams:  # so that a mapping can reach each column
            names = told_apart(column.name for column in stream.columns)
            for column, name in zip(stream.columns, names, strict=True):
                column.name = name
        return log
    except SimcompareError:
        raise
    except ModuleNotFoundError as error:
        cure = "pip install 'simcompare[hardware]'"
        raise EngineMissing(f"the reader of {kind} logs", error.name or "?", cure) from None
    # libraries that read damaged files may raise anything; the user needs one sentence
    except Exception as error:
        raise InputError(
            str(path),
            [
                f"cannot be read as {importer.TITLE}: {type(error).__name__}: {error};"
                f" the file is damaged, or of another format: {IMPORT} --as FORMAT"
            ],
        ) from error
