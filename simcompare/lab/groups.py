"""Groups and what they have made: one folder each, below that of the lab."""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
import shutil
import stat
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simcompare.lab.refusals import Refused
from simcompare.model import whole

#: letters of a group's name; groups; bytes of one of them; bytes that stay free on the disk
_LONGEST, _MOST, _GROUP_BYTES, _FREE_BYTES = 60, 1000, 2 * 10**9, 500 * 10**6
#: recordings of a group, and files that it takes home, together
_MOST_KEPT = 500
#: what joins pictures of people to one
_JOINER = "\u200d"
_KEY = re.compile(r"[a-z0-9]+(?:-[a-z0-9]+)*-[0-9a-f]{10}")
#: names of jobs, results and recordings; names of files to take home
_ID, _FILE = re.compile(r"[0-9a-f]{16}"), re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,120}")


@dataclass(frozen=True)
class Group:
    """A group of students.

    Attributes:
        key: name of its folder.
        name: as it was typed first.
        folder: holds its recordings, results and files.
    """

    key: str
    name: str
    folder: Path

    def recording(self, recording_id: object) -> Path:
        """Folder of a recording.

        Raises:
            Refused: there is none of this id.
        """
        return self._part("recordings", recording_id, "no_recording")

    def result(self, result_id: object) -> Path:
        """Folder of a result.

        Raises:
            Refused: there is none of this id.
        """
        return self._part("results", result_id, "no_result")

    def _part(self, kind: str, part_id: object, fault: str) -> Path:
        if not isinstance(part_id, str) or not _ID.fullmatch(part_id):
            raise Refused(404, fault)
        place = self.folder / kind / part_id
        if not place.is_dir():
            raise Refused(404, fault)
        return place

    def file(self, name: str) -> Path:
        """A file to take home.

        Raises:
            Refused: there is none of this name.
        """
        path = self.folder / "files" / name
        if not _FILE.fullmatch(name) or not _is_file(path):
            raise Refused(404, "no_file")
        return path

    def make_room(self, size: int) -> None:
        """Makes sure that so many bytes more may be stored.

        Args:
            size: bytes; with 0 only the disk is looked at, as the whole folder takes its time.

        Raises:
            Refused: the group has much already, or the disk is full.
        """
        if shutil.disk_usage(self.folder).free - size < _FREE_BYTES:
            raise Refused(507, "disk_full")
        if not size:
            return
        kept = sum(len(_entries(self.folder / part)) for part in ("recordings", "files"))
        if kept >= _MOST_KEPT or _size(self.folder) + size > _GROUP_BYTES:
            raise Refused(507, "group_full", most=_GROUP_BYTES // 10**9, count=_MOST_KEPT)

    def listing(self) -> dict[str, Any]:
        """All that it has."""
        files = sorted(path.name for path in _entries(self.folder / "files") if _is_file(path))
        return {
            "name": self.name,
            "key": self.key,
            "recordings": _documents(self.folder / "recordings", "upload.json"),
            "results": _documents(self.folder / "results", "summary.json"),
            "files": [name for name in files if _FILE.fullmatch(name)],
        }


class Groups:
    """All groups of a lab.

    Args:
        folder: of the lab; it is made where there is none.
    """

    def __init__(self, folder: Path) -> None:
        self._is_new = not folder.exists()
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder.resolve()
        whole.probe(self.folder)

    def leave(self) -> bool:
        """Takes a new folder away in which nobody has left anything; whether there is one."""
        if self._is_new:
            with contextlib.suppress(OSError):  # it is not empty
                self.folder.rmdir()
        return self.folder.is_dir()

    def find(self, name: str) -> Group:
        """The group of a name or key.

        Raises:
            Refused: there is none, or it is no name.
        """
        group = self._stored(self.folder / name) if _KEY.fullmatch(name) else None
        group = group or self._stored(self.folder / key_of(name))
        if group is None:
            raise Refused(404, "no_group", name=name)
        return group

    def join(self, name: object) -> Group:
        """The group of a name, which is new where there is none yet.

        Raises:
            Refused: it is no name, or there are too many groups.
        """
        if not isinstance(name, str):
            raise Refused(400, "no_group_name", most=_LONGEST)
        key = key_of(name)
        if (group := self._stored(self.folder / key)) is not None:
            return group
        if sum(1 for _ in self.all()) >= _MOST:
            raise Refused(429, "too_many_groups")
        place = self.folder / key
        for part in ("recordings", "results", "files"):
            (place / part).mkdir(parents=True, exist_ok=True)
        whole.write(place / "group.json", json.dumps({"name": tidy(name)}).encode())
        return Group(key, tidy(name), place)

    def all(self) -> Iterator[Group]:
        """Every group, by its key."""
        for path in _entries(self.folder):
            if _KEY.fullmatch(path.name) and (group := self._stored(path)) is not None:
                yield group

    def result(self, result_id: str) -> Path | None:
        """Folder of a result, whosever it is."""
        if not _ID.fullmatch(result_id):
            return None
        return next(iter(self.folder.glob(f"*/results/{result_id}")), None)

    def _stored(self, place: Path) -> Group | None:
        found = document(place / "group.json")
        name = found.get("name")
        return Group(place.name, name, place) if isinstance(name, str) else None


def tidy(name: str) -> str:
    """A name as it is kept: letters in their one form, single spaces."""
    return " ".join(unicodedata.normalize("NFC", name).split())


def key_of(name: str) -> str:
    """The name of a group's folder: readable, and no other group's.

    Raises:
        Refused: it is empty, too long, or holds what cannot be printed.
    """
    kept = tidy(name)
    seen = kept.replace(_JOINER, "")
    if not seen or len(kept) > _LONGEST or not seen.isprintable():
        raise Refused(400, "no_group_name", most=_LONGEST)
    plain = unicodedata.normalize("NFKD", kept.casefold()).encode("ascii", "ignore").decode()
    slug = "-".join(re.findall(r"[a-z0-9]+", plain))[:24].strip("-") or "group"
    return f"{slug}-{hashlib.sha256(kept.casefold().encode()).hexdigest()[:10]}"


def _entries(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir())
    except OSError:
        return []


def _is_file(path: Path) -> bool:
    try:
        return stat.S_ISREG(path.lstat().st_mode)
    except OSError:
        return False


def _size(folder: Path) -> int:
    return sum(_bytes(path) for path in folder.rglob("*"))


def _bytes(path: Path) -> int:
    """Of a file; 0 where it has just gone."""
    try:
        found = path.lstat()
    except OSError:
        return 0
    return found.st_size if stat.S_ISREG(found.st_mode) else 0


def _documents(folder: Path, name: str) -> list[dict[str, Any]]:
    """What is told of recordings or results, the newest first."""
    found = [
        {**told, "id": path.name}
        for path in _entries(folder)
        if _ID.fullmatch(path.name) and (told := document(path / name))
    ]
    return sorted(found, key=lambda one: str(one.get("when", "")), reverse=True)


def document(path: Path) -> dict[str, Any]:
    """A small stored document; empty where it is absent or damaged."""
    try:
        with whole.opened(path) as file:
            found = json.loads(file.read())
    except (OSError, ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}
