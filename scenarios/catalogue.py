"""Which scenarios there are: the project's, and those in a user's folders.

A scenario is a folder ``<name>/<name>.yaml`` with an optional ``reference.py``. Names are found by
looking at folders only; a file is parsed when it is asked for.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.errors import InputError, unknown_or_missing
from simcompare.model import user_file

if TYPE_CHECKING:
    from simcompare.scenarios.reference_file import Reference
    from simcompare.scenarios.scenario_file import ScenarioFile

#: environment variable with folders of more scenarios, separated as in PATH
FOLDERS_VARIABLE = "SIMCOMPARE_SCENARIOS"
_BUILT_IN = Path(__file__).parent


def folders() -> list[Path]:
    """Folders that are searched, the project's own first.

    Raises:
        InputError: the environment variable names a folder that does not exist.
    """
    more = [Path(part) for part in os.environ.get(FOLDERS_VARIABLE, "").split(os.pathsep) if part]
    missing = [f"there is no folder {folder}" for folder in more if not folder.is_dir()]
    if missing:
        raise InputError(FOLDERS_VARIABLE, missing)
    return [_BUILT_IN, *more]


def files() -> dict[str, Path]:
    """Name -> file of every scenario; a name in an earlier folder hides later ones."""
    files_by_name: dict[str, Path] = {}
    for folder in folders():
        for path in sorted(folder.glob("*/*.yaml")):
            if path.stem == path.parent.name and path.is_file():
                files_by_name.setdefault(path.stem, path)
    return files_by_name


def names() -> list[str]:
    """Names of all scenarios."""
    return sorted(files())


def summaries() -> list[tuple[str, str]]:
    """Name and one line of every scenario, for ``simcompare list``."""
    return [(name, _title(path)) for name, path in sorted(files().items())]


def _title(path: Path) -> str:
    """The ``title`` and ``question`` of a file, read without parsing all of it."""
    texts = {}
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        key, colon, value = line.partition(":")
        if colon and key in ("title", "question"):
            texts[key] = value.strip().strip("\"'")
    return ": ".join(texts[key] for key in ("title", "question") if key in texts)


def find(name: str) -> Path:
    """The file of a scenario given by name, folder or file.

    Raises:
        UnknownName: no scenario of that name.
        InputError: no such file, or a folder without its YAML file.
    """
    known = files()
    if name in known:
        return known[name]
    path = Path(name)
    try:
        is_file, is_folder = path.is_file(), path.is_dir()
    except OSError:  # a name too long for the file system
        is_file = is_folder = False
    if is_file:
        return path
    user_file.check_is_stored(path)
    if is_folder:
        inside = path / f"{path.resolve().name or 'NAME'}.yaml"
        if not inside.is_file():
            raise InputError(
                str(path), [f"a scenario folder holds {inside.name}, this one does not"]
            )
        return inside
    raise unknown_or_missing("scenario", name, known)


def load(name: str, *, trust: bool = False) -> ScenarioFile:
    """Reads the scenario of that name, folder or file.

    Args:
        name: of it.
        trust: say yes to the code beside it, for this time and later.
    """
    from simcompare.scenarios import trust as trusted
    from simcompare.scenarios.scenario_file import read

    path = find(name)
    if trust and has_reference(path):
        trusted.allow(_reference_file(path))
    return read(path)


def has_reference(path: Path) -> bool:
    """Whether there is a module with a reference beside a scenario file; nothing of it is run."""
    return _reference_file(path).is_file()


def reference_of(path: Path) -> Reference | None:
    """The function ``reference`` beside a scenario file, ``None`` where there is no such module.

    It is called with parameters, times and the signals of the inputs. Code that is not ours runs
    in a process of its own, when the function is called.

    Raises:
        InputError: the module cannot be imported or has no such function.
        UntrustedCode: it comes from elsewhere, and nobody has said yes to it.
    """
    from simcompare.scenarios import trust

    if not has_reference(path):
        return None
    source = _reference_file(path)
    if trust.is_ours(source):
        from simcompare.scenarios.reference_file import loaded

        return loaded(source)
    digest = trust.require(source)
    from simcompare.scenarios import outside

    return outside.reference(source.parent.resolve() / source.name, digest)


def _reference_file(path: Path) -> Path:
    return path.with_name("reference.py")
