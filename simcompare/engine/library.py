"""Kinds of engine, as declarations: how it is found, loaded, and told what version it is.

``PipPackage`` is imported; ``SharedLibrary`` is opened through its C functions, without a
compiler; ``OtherPython`` runs in a Python of its own, for packages that this one cannot import;
``Program`` is started as a process.
"""

from __future__ import annotations

import contextlib
import ctypes.util
import functools
import importlib
import importlib.metadata
import importlib.util
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from simcompare.errors import EngineBroken, EngineMissing, to_paste


class Library(Protocol):
    """What an engine comes as.

    Attributes:
        name: module, library or program that is looked for.
        install: the command that installs it.
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def install(self) -> str: ...  # noqa: D102

    def version(self) -> str | None:
        """Version of what is installed, ``None`` where it is absent; no package is imported."""

    def load(self, engine: str) -> Any:  # noqa: ANN401
        """What a scene is built with.

        Args:
            engine: the engine's name, for messages.

        Raises:
            EngineMissing: it is not installed.
            EngineBroken: it is installed and cannot be loaded; the message quotes why.
        """


@functools.cache
def installed_version(distribution: str) -> str | None:
    """Version of an installed package, ``None`` where it is not installed."""
    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return None


@dataclass(frozen=True)
class PipPackage:
    """An engine that is a Python package.

    Attributes:
        name: the module that is imported.
        install: the command that installs it.
        distributions: packages that bring the module, the usual one first.
        needs: system libraries that its wheel needs and may lack, and the command that cures it.
    """

    name: str
    install: str
    distributions: Sequence[str]
    needs: Sequence[tuple[str, str]] = ()

    def version(self) -> str | None:
        """Version of the installed package."""
        found = (installed_version(distribution) for distribution in self.distributions)
        return next(filter(None, found), None)

    def load(self, engine: str) -> Any:  # noqa: ANN401
        """The imported module."""
        try:
            return importlib.import_module(self.name)
        except ModuleNotFoundError as error:
            if error.name == self.name:
                raise EngineMissing(engine, self.name, self.install) from None
            raise EngineBroken(f"{engine} cannot be imported: {error}") from error
        except Exception as error:
            cures = [to_paste(cure) for library, cure in self.needs if library in str(error)]
            raise EngineBroken(
                f"{engine} cannot be imported: {type(error).__name__}: {error}"
                + "".join(f"; cure: {cure}" for cure in cures)
            ) from error


@dataclass(frozen=True)
class SharedLibrary:
    """An engine that is a library of the system, opened by ``cffi`` without a compiler.

    Attributes:
        name: the library's name without "lib" and ending, as a linker takes it.
        install: the command that installs it.
        files: names under which it may be found, the usual one first.
        declarations: its functions and structures in C.
        binding: the command that installs ``cffi``.
    """

    name: str
    install: str
    files: Sequence[str]
    declarations: str
    binding: str = "pip install cffi"
    kind: str = "library"

    def version(self) -> str | None:
        """What the file's name tells of its version, such as 8.0.2 of ``libtoy.so.8.0.2``."""
        for file in self._found():
            name = _file_behind(file)
            return name.partition(".so.")[2] or name
        return None

    def load(self, engine: str) -> Any:  # noqa: ANN401
        """``(ffi, lib)`` of the opened library, the same ones in every scene."""
        file = next(self._found(), None)
        if file is None:
            raise EngineMissing(engine, self.name, self.install, "library")
        try:
            return _opened(file, self.declarations)
        except ModuleNotFoundError:
            raise EngineMissing(engine, "cffi", self.binding) from None
        except OSError as error:
            raise EngineBroken(f"{engine} cannot be opened: {error}") from error

    def _found(self) -> Iterator[str]:
        """Names under which the library can be opened; it is searched for where none fits."""
        for file in self.files:
            if _opens(file):
                yield file
        other = ctypes.util.find_library(self.name)
        if other is not None and _opens(other):
            yield other


def _opens(file: str) -> bool:
    try:
        ctypes.CDLL(file)
    except OSError:
        return False
    return True


def _file_behind(name: str) -> str:
    """Name of the file that an opened library is in; the name itself where no system tells."""
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/maps").read_text(encoding="utf-8").splitlines():
            file = line.rpartition("/")[2]
            if file.startswith(name):
                return file
    return name


@functools.cache
def _opened(file: str, declarations: str) -> tuple[Any, Any]:
    import cffi

    ffi = cffi.FFI()
    ffi.cdef(declarations)
    return ffi, ffi.dlopen(file)


@dataclass(frozen=True)
class OtherPython:
    """An engine that only another Python can import; ``load`` gives the command that runs it.

    Attributes:
        name: the module that it imports.
        install: the command that installs it.
        interpreter: that Python.
    """

    name: str
    install: str
    interpreter: str = "/usr/bin/python3"

    def version(self) -> str | None:
        """Version that the module states, or "unknown"; one process asks for it."""
        code = f"import {self.name} as m; print(getattr(m, '__version__', 'unknown'))"
        return _asked([self.interpreter, "-c", code])

    def load(self, engine: str) -> list[str]:
        """The command that a script is added to."""
        if self.version() is None:
            raise EngineMissing(engine, self.name, self.install)
        return [self.interpreter]


@dataclass(frozen=True)
class Program:
    """An engine that is a program of its own; ``load`` gives the command that starts it.

    Attributes:
        name: the program.
        install: the command that installs it.
        arguments: with which it tells its version.
    """

    name: str
    install: str
    arguments: Sequence[str] = ("--version",)

    def version(self) -> str | None:
        """First line of what it says of its version."""
        found = shutil.which(self.name)
        return None if found is None else _asked([found, *self.arguments])

    def load(self, engine: str) -> list[str]:
        """The command that arguments are added to."""
        found = shutil.which(self.name)
        if found is None:
            raise EngineMissing(engine, self.name, self.install, "program")
        return [found]


@functools.cache
def _answer(command: tuple[str, ...]) -> str | None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=30)
    except (OSError, subprocess.TimeoutExpired):
        return None
    lines = done.stdout.split("\n")
    return None if done.returncode else lines[0].strip() or "unknown"


def _asked(command: Sequence[str]) -> str | None:
    return _answer(tuple(command))
