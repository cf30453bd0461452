"""Which engines there are: a file or folder each in ``backends/``, and other packages' entries.

Names are found without importing anything; a backend is imported when it is asked for.
"""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare.engine import elsewhere
from simcompare.errors import EngineBroken, EngineElsewhere, InputError, UnknownName, UnknownVariant

if TYPE_CHECKING:
    from simcompare.engine.backend import Backend
    from simcompare.engine.variants import Variant

ENTRY_POINT_GROUP = "simcompare.backends"
#: what stands between the name of an engine and that of its variant
VARIANT = ":"
#: what every backend has: values, and functions
_VALUES = ("name", "features", "known_limits", "mapping")
_FUNCTIONS = ("version", "open", "simulate")
_FOLDER = Path(__file__).parents[1] / "backends"


@functools.cache
def _built_in() -> dict[str, str]:
    """Engine -> ``module:attribute`` for every file ``<engine>_.py`` of the backends' folder.

    An engine that needs more files has a folder of its name, and its object in ``backend.py``.
    """
    files = {path.stem[:-1]: path.stem for path in _FOLDER.glob("[a-z]*_.py")}
    folders = {path.parent.name for path in _FOLDER.glob("[a-z]*/backend.py")}
    found = files | {name: f"{name}.backend" for name in folders}
    return {name: f"simcompare.backends.{found[name]}:BACKEND" for name in sorted(found)}


def targets() -> dict[str, str]:
    """Every known engine and where its backend is, as ``module:attribute``."""
    found = dict(_built_in())
    for point in importlib.metadata.entry_points(group=ENTRY_POINT_GROUP):
        found.setdefault(point.name, point.value)
    return found


def names() -> list[str]:
    """Names of all known engines: the built-in ones first, then other packages', sorted."""
    built_in = list(_built_in())
    return built_in + sorted(set(targets()) - set(built_in))


def split(name: str) -> tuple[str, str]:
    """An engine and its variant, which is empty for the engine as it comes."""
    engine, _, variant = name.partition(VARIANT)
    return engine, variant


def quick_variants(engine: str) -> Mapping[str, Variant]:
    """Variants of a built-in engine, by name, without importing its backend."""
    if not (_FOLDER / engine / "variants.py").is_file():
        return {}
    found: Mapping[str, Variant] = importlib.import_module(
        f"simcompare.backends.{engine}.variants"
    ).VARIANTS
    return found


def get(name: str) -> Backend:
    """The backend of that name, or of an engine's variant, such as "engine:variant".

    Raises:
        UnknownName: no such engine; names the nearest, or tells why it cannot run here. Or the
            engine has no such variant; names those that it has.
        EngineBroken: the backend's own code cannot be imported, or lacks what a backend has.
    """
    engine, variant = split(name)
    backend = _backend(engine)
    if VARIANT not in name:
        return backend
    known = getattr(backend, "variants", {})
    if variant not in known:
        raise UnknownVariant(engine, variant, known)
    made: Backend = backend.with_variant(variant)  # type: ignore[attr-defined]
    return made


def _backend(name: str) -> Backend:
    # other packages cannot take a built-in name, so they are looked through for others alone
    known = _built_in() if name in _built_in() else targets()
    if name not in known:
        raise _unknown(name, known)
    module, _, attribute = known[name].partition(":")
    try:
        found = getattr(importlib.import_module(module), attribute)
        backend: Backend = found() if isinstance(found, type) else found
    # other people's code may raise anything, also SystemExit
    except (Exception, SystemExit) as error:
        raise EngineBroken(
            f"the backend of {name} ({known[name]}) cannot be loaded:"
            f" {type(error).__name__}: {error}"
        ) from error
    lacking = _lacking(backend)
    if lacking:
        raise EngineBroken(
            f"the backend of {name} ({known[name]}) lacks {', '.join(lacking)}; simcompare.kit and"
            " CONTRIBUTING.md show what a backend has"
        )
    return backend


def _lacking(backend: object) -> list[str]:
    """What a backend has not, functions with brackets; all of it where it is nothing at all."""
    values = (*_VALUES, *getattr(backend, "also_needed", ()))
    return [
        *(name for name in values if getattr(backend, name, None) is None),
        *(f"{name}()" for name in _FUNCTIONS if not callable(getattr(backend, name, None))),
    ]


def listed(asked: str | Sequence[str]) -> str:
    """Engines of a list as a text with commas; a text as it is."""
    return asked if isinstance(asked, str) else ",".join(asked)


def select(text: str) -> list[str]:
    """Engine names from a command-line argument: ``all``, alone or in a list with commas.

    A variant of an engine is a name of its own. ``all`` is every engine without its variants; such
    as are named beside it are added.

    Raises:
        UnknownName: one of them does not exist.
        InputError: a variant of all.
        EngineBroken: a variant is asked for, and the backend's own code cannot be imported.
    """
    wanted = [part.strip() for part in text.split(",") if part.strip()]
    known = names()
    if "all" in wanted:
        wanted = [*known, *(name for name in wanted if VARIANT in name)]
    for name in wanted or [text]:
        if split(name)[0] == "all":
            raise InputError("--engine", [f"{name}: a variant is of one engine; name that one"])
        if split(name)[0] not in known:
            raise _unknown(split(name)[0], [*known, "all"])
        if VARIANT in name:
            get(name)
    return list(dict.fromkeys(wanted))


def _unknown(name: str, known: Iterable[str]) -> UnknownName:
    """The error for a name that is no backend's; some are those of engines that run elsewhere."""
    engine = elsewhere.find(name)
    if engine is None:
        return UnknownName("engine", name, known)
    cures = [
        *engine.lines(),
        "simcompare doctor tells how the results come back",
        f"engines of simcompare: {', '.join(names())}",
    ]
    why = f"{engine.why} [{engine.why_reference}]"
    return EngineElsewhere(name, engine.title, why, cures, known)
