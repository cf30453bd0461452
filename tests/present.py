"""Which engines are here: tests speak of these, and skip by its name what needs another."""

import contextlib
import importlib.util

import pytest

from simcompare import engines
from simcompare.backend import EngineBackend
from simcompare.errors import EngineMissing


def built_in():
    """Module and name of every engine that this repository has a backend for."""
    for name, target in engines.targets().items():
        if target.startswith("simcompare.backends."):
            backend = engines.get(name)
            assert isinstance(backend, EngineBackend)
            yield backend.module, name


#: those that are not installed: Python module -> engine
ABSENT = {m: name for m, name in built_in() if importlib.util.find_spec(m) is None}
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
