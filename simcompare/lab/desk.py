"""One worker process of the lab: it does one job after the other, and is replaced where it dies."""

from __future__ import annotations

import asyncio
import contextlib
import json
import multiprocessing
import os
import shutil
import signal
import traceback
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from simcompare.errors import SimcompareError
from simcompare.hardware import confined
from simcompare.lab import faults
from simcompare.model import whole
from simcompare.running import guard

#: what a summary holds of a result and of its request
_SUMMED, _ASKED = ("sentence", "files", "exit"), ("scenario", "recording", "engines", "engine")

#: runs that each group keeps, besides everything else that it has made
_KEPT = 50
#: runs that are remembered; memory of a worker and of each of its engines
_RUNS, _MEMORY_BYTES = 20, 4 * 2**30
_runs: dict[str, dict[str, Any]] = {}
#: in place of the number of a worker that shall not begin
_UNWANTED = -1

#: what a job does: its kind and its request become a result
Perform = Callable[[str, dict[str, Any]], dict[str, Any]]


@dataclass(frozen=True)
class Task:
    """What a worker is to do.

    Attributes:
        kind: of the job.
        request: what it needs.
        place: folder of its result; where it is ``None``, the result itself is the answer.
    """

    kind: str
    request: dict[str, Any]
    place: Path | None = None


@dataclass(frozen=True)
class Ending:
    """How a job ended.

    Attributes:
        answer: the result as JSON, where it has no place of its own.
        faults: a sentence each, where it failed.
        fault: key of a sentence of the lab's own, where it failed otherwise.
    """

    answer: bytes = b""
    faults: tuple[str, ...] = ()
    fault: str = ""

    @property
    def is_fine(self) -> bool:
        """Whether there is a result."""
        return not (self.faults or self.fault)


class Desk:
    """A worker process.

    Args:
        perform: what a job does; a function of a module, as it travels by its name.
        warm: kind of the job that is done before all others.
    """

    def __init__(self, perform: Perform, warm: str = "warm") -> None:
        self._perform, self._first = perform, warm
        self._begin()

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pid: Any = context.Value("l", 0)
        self._pool = ProcessPoolExecutor(1, context, initializer=_enter, initargs=(self._pid,))
        self._warm: Future[None] = self._pool.submit(_load, self._perform, self._first)

    async def do(self, task: Task, limit_s: float) -> Ending:
        """Has a job done.

        Args:
            task: the job.
            limit_s: seconds after which the worker is ended; it begins when the worker is ready.
        """
        try:
            await asyncio.wrap_future(self._warm)
            done = self._pool.submit(_do, self._perform, task)
            return await asyncio.wait_for(asyncio.wrap_future(done), limit_s)
        except TimeoutError:
            await asyncio.to_thread(self._replace)
            return Ending(fault="too_long")
        except BrokenProcessPool:
            await asyncio.to_thread(self._replace)
            return Ending(fault="died")
        # what a job asks may not travel, and its function's modules may fail when imported
        except Exception:  # noqa: BLE001
            traceback.print_exc()
            return Ending(fault="broken")

    def _replace(self) -> None:
        self.end()
        self._begin()

    def end(self) -> None:
        """Ends the process and all that it has started; one that only begins ends by itself."""
        with self._pid.get_lock():
            pid, self._pid.value = self._pid.value, _UNWANTED
        if pid > 0:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(pid, signal.SIGKILL)
        self._pool.shutdown(wait=pid > 0, cancel_futures=True)


def _enter(pid: Any) -> None:  # noqa: ANN401
    """First of all in the worker: Ctrl-C reaches the server alone, whose end is ours, too."""
    os.setsid()
    with pid.get_lock():
        if pid.value == _UNWANTED:
            os._exit(0)
        pid.value = os.getpid()
    _limit_memory()
    parent = multiprocessing.parent_process()
    if parent is not None:
        guard.begin(parent.sentinel)


def _limit_memory() -> None:
    """What a job and its engines may take; more ends the job and not the whole machine."""
    import resource

    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY_BYTES, _MEMORY_BYTES))


def _load(perform: Perform, warm: str) -> None:
    """Starts what the first job would wait for; what goes wrong then is told when it is needed."""
    with contextlib.suppress(SimcompareError):
        perform(warm, {})


def _do(perform: Perform, task: Task) -> Ending:
    """Does a job, in the worker."""
    try:
        result = _result(perform, task)
        if task.place is not None:
            _store(task, result)
            return Ending()
        return Ending(_written(result))
    except SimcompareError as error:
        return Ending(faults=faults.told(error, task.request))
    except MemoryError:
        return Ending(fault="died")
    # engines and readers of files may raise anything; it spoils only this job
    except (Exception, SystemExit) as error:  # noqa: BLE001
        if confined.is_full(error):
            return Ending(fault="disk_full")
        traceback.print_exc()
        return Ending(fault="broken")


def _result(perform: Perform, task: Task) -> dict[str, Any]:
    """The result of a job; a whole class that opens its page asks for the same run."""
    if task.kind != "run" or task.request.get("recording") is not None:
        return perform(task.kind, task.request)
    asked = {name: value for name, value in task.request.items() if name not in ("folder", "id")}
    key = json.dumps(asked, sort_keys=True)
    if key in _runs:
        return _runs[key]
    result = perform(task.kind, task.request)
    if not result.get("missing"):  # else another try may do better
        _runs[key] = result
    for oldest in [*_runs][:-_RUNS]:
        del _runs[oldest]
    return result


def _written(value: object) -> bytes:
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.encode("utf-8", "replace")


def _store(task: Task, result: Mapping[str, Any]) -> None:
    """Puts result and summary in their place, both or none."""
    assert task.place is not None
    asked = {name: value for name, value in task.request.items() if name != "folder"}
    when = datetime.now(UTC).isoformat(timespec="seconds")
    head = {"id": task.place.name, "kind": task.kind, "when": when}
    ended = {"state": "done", "place": 0}
    summed = {name: result[name] for name in _SUMMED if name in result}
    summed |= {name: asked[name] for name in _ASKED if name in asked}
    task.place.parent.mkdir(parents=True, exist_ok=True)
    with whole.folder(task.place) as made:
        told = {**head, **ended, "request": asked, "result": result}
        (made / "result.json").write_bytes(_written(told))
        (made / "summary.json").write_bytes(_written({**head, **summed}))
    if task.kind == "run":
        _let_go(task.place.parent)


def _let_go(results: Path) -> None:
    """Deletes a group's oldest runs: every move of a slider makes one."""
    runs = []
    for told in results.glob("*/summary.json"):
        with contextlib.suppress(OSError, ValueError):
            summary = json.loads(told.read_bytes())
            runs += [(told.stat().st_mtime_ns, told.parent)] if summary["kind"] == "run" else []
    for _, oldest in sorted(runs)[:-_KEPT]:
        shutil.rmtree(oldest, ignore_errors=True)
