"""The reference of a scenario from elsewhere: its code runs in a process of its own."""

from __future__ import annotations

import functools
import queue
import sys
import threading
import traceback
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from simcompare import arguments
from simcompare.engine.backend import Backend
from simcompare.errors import InputError, SimcompareError
from simcompare.model.signals import Signal
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.running.jobs import OK, UNSUPPORTED, Inquiry, Reply
from simcompare.running.process import EngineProcess, Inbox
from simcompare.running.runner import TIME_LIMIT_S
from simcompare.scenarios import sealed
from simcompare.scenarios.reference_file import Reference, loaded

#: bytes that a sample of all signals may have
_SAMPLE_BYTES = 4096
#: what is no folder, so that Python reads and writes no compiled code beside the source
_NOWHERE = "/dev/null"


@dataclass(frozen=True)
class Evaluation:
    """A reference with numbers.

    Attributes:
        file: the module.
        digest: of the code that was said yes to.
        parameters: SI.
        time_s: times [s].
        inputs: signals.
    """

    kind: ClassVar[type[Any]] = Trajectory
    file: Path
    digest: str
    parameters: Mapping[str, float]
    time_s: Array
    inputs: Mapping[str, Signal]

    def __call__(self, backend: Backend | None = None) -> Trajectory:
        """What the code calculates; no engine is needed for it."""
        found = _module(self.file, self.digest)(self.parameters, self.time_s, self.inputs)
        signals = {str(name): np.asarray(values) for name, values in dict(found).items()}
        return Trajectory(TRUTH, self.time_s, signals)


@dataclass(frozen=True)
class _Calculation(Inquiry[Trajectory]):
    """An evaluation as a job of its process."""

    def execute(self) -> Reply[Trajectory]:
        try:
            return Reply(self, OK, value=self.ask(None))  # type: ignore[arg-type]
        except InputError as error:  # it refuses these parameters, and says why
            return Reply(self, UNSUPPORTED, str(error))
        except (Exception, SystemExit) as error:  # noqa: BLE001  (others' code may raise anything)
            traceback.print_exc()
            kind = "" if isinstance(error, SimcompareError) else f"{type(error).__name__}: "
            return self.failed(f"reference() failed: {kind}{error}")

    @property
    def most_bytes(self) -> int:
        assert isinstance(self.ask, Evaluation)
        return len(self.ask.time_s) * _SAMPLE_BYTES


@functools.cache
def _module(file: Path, digest: str) -> Reference:
    """The function of a module, in the process in which it is called."""
    sys.pycache_prefix, sys.dont_write_bytecode = _NOWHERE, True
    sealed.seal(file, digest)
    return loaded(file)


class _Outside:
    """A function ``reference`` whose code runs elsewhere.

    Args:
        file: its module.
        digest: of the code that was said yes to.
    """

    def __init__(self, file: Path, digest: str) -> None:
        self._file, self._digest = file, digest
        self._process: EngineProcess | None = None
        #: the process answers one call after another, whichever threads they come from
        self._in_turn = threading.Lock()

    def __call__(
        self, parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
    ) -> dict[str, Array]:
        ask = Evaluation(
            self._file, self._digest, dict(parameters), np.array(time_s, dtype=float), dict(inputs)
        )
        with self._in_turn:
            reply = self._asked(_Calculation(self._file.name, ask))
        if reply.value is None:
            raise InputError(str(self._file), [str(reply.reason)])
        return {**reply.value.signals}

    def _asked(self, job: _Calculation) -> Reply[Trajectory]:
        if self._process is None or not self._process.lives:
            self._process = EngineProcess(job.engine)
            weakref.finalize(self, self._process.stop)
        process, inbox = self._process, Inbox()
        process.begin([job], inbox, is_last=False)
        limit_s = arguments.time_limit_s(TIME_LIMIT_S)
        try:
            arrived = inbox.get(timeout=limit_s)
        except queue.Empty:
            reason = f"no answer within {limit_s:g} s; its process was ended"
            return job.failed(self._ended(process, reason))
        except BaseException:
            self._ended(process, "")
            raise
        message = None if arrived is None else arrived[1]
        if message is None:
            return job.failed(self._ended(process, process.how_it_died()))
        reply = message[1]
        assert isinstance(reply, Reply)
        return reply

    def _ended(self, process: EngineProcess, reason: str) -> str:
        """Ends the process; why, with what it printed last."""
        self._process = None
        process.stop()
        process.leave()
        noise = process.noise()
        process.stderr.close()
        return f"{reason}; it last printed: {noise.splitlines()[-1]}" if noise else reason


@functools.lru_cache(maxsize=4)
def reference(file: Path, digest: str) -> Reference:
    """The function ``reference`` of a module from elsewhere.

    Args:
        file: the module.
        digest: of the code that was said yes to; other code is another function.
    """
    return _Outside(file, digest)
