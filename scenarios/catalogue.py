"""Which scenarios there are: the project's, and those in a user's folders.

A scenario is a folder ``<name>/<name>.yaml`` with an optional ``reference.py``. Names are found by
looking at folders only; a file is parsed when it is asked for.
"""

from __future__ import annotations

import importlib.util
import inspect
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.errors import InputError, unknown_or_missing

if TYPE_CHECKING:
    from simcompare.model.signals import Signal
    from simcompare.model.trajectory import Array
    from simcompare.scenarios.scenario_file import ScenarioFile

    Reference = Callable[[Mapping[str, float], Array, Mapping[str, Signal]], dict[str, Array]]

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
    if is_folder:
        inside = path / f"{path.resolve().name or 'NAME'}.yaml"
        if not inside.is_file():
            raise InputError(
                str(path), [f"a scenario folder holds {inside.name}, this one does not"]
            )
        return inside
    raise unknown_or_missing("scenario", name, known)


def load(name: str) -> ScenarioFile:
    """Reads the scenario of that name, folder or file."""
    from simcompare.scenarios.scenario_file import read

    return read(find(name))


def reference_of(path: Path) -> Reference | None:
    """The function ``reference`` beside a scenario file, ``None`` where there is no such module.

    It is called with parameters, times and the signals of the inputs; one that takes no inputs is
    written with the first two alone.

    Raises:
        InputError: the module cannot be imported or has no such function.
    """
    source = path.with_name("reference.py")
    if not source.is_file():
        return None
    name = f"simcompare_reference_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, source)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # dataclasses look their module up by name while it is being executed
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        raise InputError(
            str(source), [f"cannot be imported: {type(error).__name__}: {error}"]
        ) from error
    if not callable(getattr(module, "reference", None)):
        raise InputError(str(source), ["has no function reference(parameters, time_s)"])
    return _with_inputs(module.reference)


def _with_inputs(function: Callable[..., dict[str, Array]]) -> Reference:
    """A reference that is given the inputs, whether or not it wants them."""
    if len(inspect.signature(function).parameters) > 2:
        return function

    def reference(
        parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
    ) -> dict[str, Array]:
        return function(parameters, time_s)

    return reference
