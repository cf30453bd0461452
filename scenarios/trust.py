"""Code beside a scenario runs if it is ours, or if the user has said yes to it.

What was said yes to is remembered by its digest: changed code is asked for again. The digest is
that of all code in the scenario's folder and below. Hidden folders, such as .git, and those of an
installed Python, such as a .venv, are left out: no code from there runs (see ``sealed``).
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import sysconfig
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

from simcompare.engine.calibration import cache
from simcompare.errors import InputError, UntrustedCode

#: how files end that Python may run
_CODE = re.compile(
    r".*\.(py|pyw|pyc|pyo|pth|so|so\.[0-9.]+|pyd|dll|dylib|zip|egg|whl)", re.IGNORECASE | re.DOTALL
)
#: files of code beside a scenario, bytes of them, and whatever is looked at to find them
_MOST_FILES, _MOST_BYTES, _MOST_PLACES = 2000, 64 * 2**20, 200_000
#: files by which a folder with an installation of Python is known
_INSTALLED = ("pyvenv.cfg", "conda-meta")
_SHIPPED = Path(__file__).resolve().parent
#: said yes to in this process, also where nothing can be kept
_allowed: set[str] = set()


def is_ours(source: Path) -> bool:
    """Whether code is shipped with simcompare or with an installed package."""
    installed = (sysconfig.get_path(name) for name in ("purelib", "platlib"))
    places = [_SHIPPED, *(Path(folder).resolve() for folder in installed)]
    return any(source.resolve().is_relative_to(place) for place in places)


def allow(source: Path) -> None:
    """Remembers a yes to the code in the folder of a file."""
    remember(digest_of(source))


def remember(digest: str) -> None:
    """Remembers a yes to code that has a digest."""
    _allowed.add(digest)
    with contextlib.suppress(OSError):  # then it holds for this process
        _folder().mkdir(parents=True, exist_ok=True)
        (_folder() / digest).touch()


def require(source: Path) -> str:
    """The digest of the code in the folder of a file.

    Raises:
        UntrustedCode: nobody has said yes to it.
    """
    digest = digest_of(source)
    if digest not in _allowed and not (_folder() / digest).is_file():
        raise UntrustedCode(source, digest)
    return digest


def digest_of(source: Path) -> str:
    """SHA-256 of all code in the folder of a file and below, with its names.

    Raises:
        InputError: there is too much of it, or it cannot be read.
    """
    return digest(source.parent, code(source.parent))


def digest(folder: Path, found: Mapping[Path, str]) -> str:
    """SHA-256 of code by its place in a folder."""
    whole = hashlib.sha256()
    for path in sorted(found):
        name = os.fsencode(path.relative_to(folder)).hex()
        whole.update(f"{found[path]} {name}\n".encode())
    return whole.hexdigest()


def code(folder: Path) -> dict[Path, str]:
    """Each file of code in a folder and below, and its SHA-256.

    Raises:
        InputError: there is too much of it, or it cannot be read.
    """
    found, sizes = {}, Counter[Path]()
    for path in _files(folder):
        try:
            sizes[path] = path.stat().st_size
            if sizes.total() > _MOST_BYTES:
                raise _too_much(folder, sizes, f"{_MOST_BYTES >> 20} MB of code")
            found[path] = hashlib.sha256(path.read_bytes()).hexdigest()
        except OSError as error:
            raise InputError(str(path), [f"cannot be read: {error.strerror or error}"]) from None
        if len(found) > _MOST_FILES:
            raise _too_much(folder, Counter([*found]), f"{_MOST_FILES} files of code")
    return found


def is_code(name: str) -> bool:
    """Whether Python may run a file of that name."""
    return _CODE.fullmatch(name) is not None


def _files(folder: Path) -> Iterator[Path]:
    seen, places = set(), Counter[Path]()
    for inside, folders, files in os.walk(folder, followlinks=True):
        here, real = Path(inside), Path(inside).resolve()
        folders[:] = sorted(filter(lambda name: not _is_left_out(here / name), folders))
        if real in seen:
            folders.clear()
            continue
        seen.add(real)
        places[here] += len(files) + len(folders)
        if places.total() > _MOST_PLACES:
            raise _too_much(folder, places, f"{_MOST_PLACES} files")
        yield from (here / name for name in files if is_code(name) and (here / name).is_file())


def _is_left_out(folder: Path) -> bool:
    """Whether no code of a folder is looked at, and none runs; what Python compiled neither."""
    is_known = folder.name.startswith(".") or folder.name == "__pycache__"
    return is_known or any((folder / name).exists() for name in _INSTALLED)


def _too_much(folder: Path, found: Counter[Path], most: str) -> InputError:
    """That a folder holds too much, and where most of it is."""
    parts = Counter[str]()
    for path, count in found.items():
        parts[(*path.relative_to(folder).parts, "")[0]] += count
    ((first, _),) = parts.most_common(1)
    where = f", most of them in {first}" if (folder / first).is_dir() and first else ""
    cure = f"move {first} elsewhere" if where else "give the scenario a folder of its own"
    return InputError(
        str(folder),
        [f"holds more than {most} beside the scenario{where}: too much to read; {cure}"],
    )


def _folder() -> Path:
    return cache.folder().with_name("trusted")
