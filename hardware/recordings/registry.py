"""Public recordings of real hardware: where they are, and how they are read.

A data set is a YAML file of this folder. Its files are not part of simcompare: they are found in
the folder that ``SIMCOMPARE_DATA`` names, or fetched from the repository of their authors, at one
commit, into the user's cache. Either way their SHA-256 is checked.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError

from simcompare.errors import InputError, OutputError, UnknownName
from simcompare.hardware.recordings import download
from simcompare.model.estimate_plan import RecordedPlan
from simcompare.model.frozen import Frozen
from simcompare.model.yaml_file import describe, faults_of, read_yaml

#: environment variable with a folder that holds the recordings
FOLDER_VARIABLE = "SIMCOMPARE_DATA"
_FOLDER = Path(__file__).parent


class Source(Frozen):
    """Repository and commit that a data set was published in."""

    repository: str = Field(pattern=r"^[\w.-]+/[\w.-]+$")
    commit: str = Field(pattern=r"^[0-9a-f]{40}$")


class File(Frozen):
    """One file of a data set.

    Attributes:
        path: inside the repository; ``None`` where the file was not published as it is.
        local: inside the folder of ``SIMCOMPARE_DATA``.
        sha256: of its content.
        size_bytes: its size.
    """

    path: str | None = None
    local: str
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    size_bytes: Annotated[int, Field(gt=0)]


class DataSet(Frozen):
    """A public recording.

    Attributes:
        title: a few words.
        text: what it is and what can be learned from it.
        citation: who made it.
        licence: short name of the licence.
        source: repository and commit.
        files: the first one is the log that is imported.
        read: mapping for the importer.
        validation: how scenarios are held against it, one entry for each.
        estimate: how estimators are used on it, one entry for each scenario and estimator.
    """

    title: str
    text: str
    citation: str
    licence: str
    source: Source
    files: tuple[File, ...] = Field(min_length=1)
    read: Mapping[str, Any] = Field(default_factory=dict)
    validation: tuple[Mapping[str, Any], ...] = Field((), alias="validate")
    estimate: tuple[RecordedPlan, ...] = ()

    def url(self, file: File) -> str | None:
        """Where a file is fetched from."""
        if file.path is None:
            return None
        from urllib.parse import quote

        place = f"{self.source.repository}/{self.source.commit}/{quote(file.path)}"
        return f"https://raw.githubusercontent.com/{place}"


@cache
def files() -> dict[str, Path]:
    """Name -> description of every data set."""
    return {path.stem: path for path in sorted(_FOLDER.glob("*.yaml"))}


@cache
def get(name: str) -> DataSet:
    """The data set of that name.

    Raises:
        UnknownName: there is none.
        InputError: its description has faults.
    """
    known = files()
    if name not in known:
        raise UnknownName("public recording", name, known)
    tree, lines, faults = read_yaml(known[name])
    try:
        data_set = DataSet.model_validate(tree)
    except ValidationError as error:
        raise InputError(
            str(known[name]), describe({**faults, **faults_of(error)}, lines)
        ) from None
    if faults:
        raise InputError(str(known[name]), describe(faults, lines))
    return data_set


def local_folder() -> Path | None:
    """The folder that the user named, ``None`` where none is."""
    folder = os.environ.get(FOLDER_VARIABLE)
    return Path(folder) if folder else None


def cache_folder() -> Path:
    """Folder of fetched recordings."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "simcompare" / "recordings"


def place(name: str) -> Path | None:
    """The folder in which all files of a data set are, ``None`` where they are not all here.

    Raises:
        InputError: the user's own folder does not exist.
    """
    local = local_folder()
    if local is not None and not local.is_dir():
        raise InputError(
            FOLDER_VARIABLE, [f"names {local}, which is no folder; correct or unset it"]
        )
    wanted = get(name).files
    for folder in (local, cache_folder()):
        if folder is not None and all((folder / file.local).is_file() for file in wanted):
            return folder
    return None


def locate(name: str) -> list[Path]:
    """The files of a data set, checked.

    Raises:
        InputError: they are not here, or a file is not the one that was registered.
    """
    data_set = get(name)
    folder = place(name)
    if folder is None:
        raise InputError(
            name,
            [
                f"is not on this machine; fetch it with simcompare data fetch {name},"
                f" or name its folder in {FOLDER_VARIABLE}"
            ],
        )
    cure = "" if folder == local_folder() else f"simcompare data fetch {name}"
    paths = [folder / file.local for file in data_set.files]
    for path, file in zip(paths, data_set.files, strict=True):
        _check(path, file, cure or "put the registered file there")
    return paths


def _check(path: Path, file: File, cure: str) -> None:
    try:
        with path.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError as error:
        raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
    if digest != file.sha256:
        raise InputError(
            str(path),
            [
                f"is not the registered file: SHA-256 {digest[:12]}…, expected"
                f" {file.sha256[:12]}…; cure: {cure}"
            ],
        )


def check_names(names: Sequence[str]) -> None:
    """Refuses names that no data set has, all at once.

    Raises:
        InputError: no name at all, or names that are not known; lists those that are.
    """
    known = ", ".join(files())
    unknown = [name for name in names if name not in files()]
    if not names:
        raise InputError("data", [f"name at least one public recording; known: {known}"])
    if unknown:
        shown = ", ".join(map(repr, unknown))
        raise InputError("data", [f"no public recording is called {shown}; known: {known}"])


def fetch(name: str) -> list[Path]:
    """Fetches what is missing or damaged of a data set into the user's cache.

    Raises:
        EngineMissing: pooch is not installed.
        InputError: a file of the user's own folder is not the one that was registered.
        OutputError: a file cannot be fetched or has another content than was registered.
    """
    folder = place(name)
    if folder is not None:
        try:
            return locate(name)
        except InputError:  # what is damaged in the cache is fetched again
            if folder == local_folder():
                raise
    data_set = get(name)
    paths = []
    for file in data_set.files:
        url = data_set.url(file)
        if url is None:
            raise OutputError(
                f"{name}: {file.local} was not published in this form; name the folder that holds"
                f" it in {FOLDER_VARIABLE}"
            )
        target = cache_folder() / file.local
        by_hand = (
            f"download {url} elsewhere and put it at {target}, or let {FOLDER_VARIABLE} name a"
            f" folder that holds {file.local}"
        )
        try:
            download.fetch(url, target, file.sha256, file.size_bytes)
        except OutputError as error:
            raise OutputError(f"{name}: {error}; {by_hand}") from None
        paths.append(target)
    return paths
