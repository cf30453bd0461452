"""Which engines are here: tests speak of these, and skip by its name what needs another."""

import contextlib
import importlib.util

import pytest

from simcompare.engine import engines
from simcompare.engine.backend import EngineBackend
from simcompare.engine.library import SharedLibrary
from simcompare.errors import EngineMissing


def built_in():
    """Library and name of every engine that this repository has a backend for."""
    for name, target in engines.targets().items():
        if target.startswith("simcompare.backends."):
            backend = engines.get(name)
            assert isinstance(backend, EngineBackend)
            yield backend.library, name


def absent():
    """What is not installed, Python module or shared library, and the engine that needs it."""
    for library, name in built_in():
        if library.version() is None:
            yield library.name, name
        elif isinstance(library, SharedLibrary) and importlib.util.find_spec("cffi") is None:
            yield "cffi", name


#: those that are not installed: Python module or shared library -> engine
ABSENT = dict(absent())
#: all others
INSTALLED = [name for name in engines.names() if name not in ABSENT.values()]


def need(*names):
    """Skips the test where one of these engines is absent."""
    for name in names:
        if name in ABSENT.values():
            pytest.skip(f"{name} is not installed")


@contextlib.contextmanager
def skipping_without_its_engine():
    """What an absent engine makes fail is skipped by that engine's name, and nothing else is."""
    try:
        yield
    except (EngineMissing, ModuleNotFoundError) as error:
        module = error.module if isinstance(error, EngineMissing) else error.name
        if module in ABSENT:
            need(ABSENT[module])
        raise
