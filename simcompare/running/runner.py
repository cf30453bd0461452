"""Running jobs: one process per engine, so that a crash, a hang or noise stays with its engine."""

from __future__ import annotations

import contextlib
import logging
import os
import queue
import time
from collections.abc import Callable, Iterable, Iterator
from contextvars import ContextVar
from dataclasses import replace
from typing import Any, overload

from simcompare.errors import InputError
from simcompare.running import interruption
from simcompare.running.jobs import Answer, Inquiry, Job, Outcome, Reply
from simcompare.running.process import EngineProcess, Inbox

#: longest time that one job may take, the engine's import included [s]
TIME_LIMIT_S = 120.0
#: longest wait for a message, whatever the time limit [s]
_MAX_WAIT_S = 3600.0
_LOG = logging.getLogger(__name__)

Progress = Callable[[str, int, int], None]
#: takes a job, and how it ended, when it has
Keep = Callable[[Any, Any], None]
_Ended = Outcome | Reply[Any]
#: processes that wait for further jobs, by engine; ``None`` where each ends with its last job
_waiting: ContextVar[dict[str, EngineProcess] | None] = ContextVar("waiting", default=None)


@contextlib.contextmanager
def kept_processes() -> Iterator[None]:
    """Within it, an engine's process is kept from one ``run_jobs`` to the next.

    To start one and to import what it needs takes longer than many jobs do. Where they are kept
    already, they go on to be.
    """
    if _waiting.get() is not None:
        yield
        return
    kept: dict[str, EngineProcess] = {}
    token = _waiting.set(kept)
    try:
        yield
    finally:
        _waiting.reset(token)
        for process in kept.values():
            process.dismiss()
        for process in kept.values():
            process.leave()
            process.stderr.close()


class Interrupted(KeyboardInterrupt):
    """A run that Ctrl-C ended; carries what had finished.

    Attributes:
        outcomes: outcomes of all jobs, those that had not finished as failed.
    """

    def __init__(self, outcomes: list[Any]) -> None:
        super().__init__()
        self.outcomes = outcomes


@overload
def run_jobs(
    jobs: Iterable[Job],
    *,
    time_limit_s: float = ...,
    processes: int | None = ...,
    progress: Progress | None = ...,
    keep: Keep | None = ...,
) -> list[Outcome]: ...
@overload
def run_jobs(
    jobs: Iterable[Inquiry[Answer]],
    *,
    time_limit_s: float = ...,
    processes: int | None = ...,
    progress: Progress | None = ...,
) -> list[Reply[Answer]]: ...
def run_jobs(
    jobs: Iterable[Job | Inquiry[Any]],
    *,
    time_limit_s: float = TIME_LIMIT_S,
    processes: int | None = None,
    progress: Progress | None = None,
    keep: Keep | None = None,
) -> Any:
    """Runs jobs, each engine's in a process of its own.

    Args:
        jobs: what to run, or to ask; those of one engine run one after another in the given order.
        time_limit_s: longest time for one job [s].
        processes: engines at the same time; as many as there are processors where ``None``.
        progress: called as ``progress(engine, done, total)`` when a job ends.
        keep: called as ``keep(job, outcome)`` with what a process gave, before all else.

    Returns:
        One outcome for every job, in the order of the jobs.

    Raises:
        InputError: a time limit that is none.
        Interrupted: on Ctrl-C, with the outcomes so far; no process is left behind.
    """
    check_time_limit(time_limit_s)
    by_engine: dict[str, list[Job | Inquiry[Any]]] = {}
    for job in (ordered := list(jobs)):
        by_engine.setdefault(job.engine, []).append(job)
    results: dict[tuple[str, int], _Ended] = {}
    crew = _Crew(by_engine, processes or os.cpu_count() or 1, time_limit_s)
    with interruption.held(crew.look_up):
        try:
            is_done = crew.work(results, progress, keep, len(ordered))
        finally:
            crew.stop()
        collected = _collect(by_engine, ordered, results)
        if not is_done:
            raise Interrupted(collected)
    return collected


def check_time_limit(time_limit_s: float) -> None:
    """Raises ``InputError`` for a time limit that is none."""
    if not time_limit_s > 0:
        raise InputError("--time-limit", [f"{time_limit_s:g} s is not a time above 0"])


class _Crew:
    """The processes of one run."""

    def __init__(
        self, by_engine: dict[str, list[Job | Inquiry[Any]]], processes: int, limit_s: float
    ) -> None:
        self._jobs, self._processes, self._limit_s = by_engine, processes, limit_s
        self._to_start = list(by_engine)
        self._running: list[EngineProcess] = []
        # what a signal puts into it must not wait for whoever takes out: other queues have locks
        self._inbox: Inbox = queue.SimpleQueue()

    def look_up(self) -> None:
        """Ends a wait for messages: there is something else to look at."""
        self._inbox.put(None)

    def work(
        self,
        results: dict[tuple[str, int], _Ended],
        progress: Progress | None,
        keep: Keep | None,
        total: int,
    ) -> bool:
        """Starts processes as places become free and gathers outcomes until all are in.

        Returns:
            Whether they are; they are not where Ctrl-C came before.
        """
        while self._to_start or self._running:
            if interruption.came():
                self._take_last(results, keep)
                return False
            while self._to_start and len(self._running) < self._processes:
                self._running.append(self._started(self._to_start.pop(0)))
            wait = min(process.deadline for process in self._running) - time.monotonic()
            try:
                timeout = min(max(wait, 0.01), _MAX_WAIT_S)
                received = self._inbox.get(timeout=timeout)
            except queue.Empty:
                self._end_late_ones(results)
                continue
            if received is None:
                continue
            process, message = received
            if process not in self._running:
                continue  # ended for being late; this is the end of its output
            if message is None:
                self._close(process, results, process.how_it_died())
                continue
            _take(process, message, results, keep)
            process.done += 1
            process.deadline = time.monotonic() + self._limit_s
            if progress is not None:
                progress(process.engine, len(results), total)
            if process.done == len(process.jobs):
                self._close(process, results, "")
        return True

    def _take_last(self, results: dict[tuple[str, int], _Ended], keep: Keep | None) -> None:
        """Gathers what has come already, when nothing more is waited for."""
        with contextlib.suppress(queue.Empty):
            while True:
                process, message = self._inbox.get_nowait() or (None, None)
                if process in self._running and message is not None:
                    _take(process, message, results, keep)

    def _started(self, engine: str) -> EngineProcess:
        """A process at work on the jobs of an engine: one that was kept, or a new one."""
        kept = (_waiting.get() or {}).pop(engine, None)
        if kept is None or not kept.lives:
            kept = EngineProcess(engine)
        kept.begin(self._jobs[engine], self._inbox, is_last=_waiting.get() is None)
        kept.deadline = time.monotonic() + self._limit_s
        return kept

    def _end_late_ones(self, results: dict[tuple[str, int], _Ended]) -> None:
        now = time.monotonic()
        for process in [process for process in self._running if process.deadline <= now]:
            process.stop()
            limit = f"{self._limit_s:g} s"
            reason = f"{process.engine}: no answer within {limit}; its process was ended"
            self._close(process, results, reason)

    def _close(
        self, process: EngineProcess, results: dict[tuple[str, int], _Ended], reason: str
    ) -> None:
        """Takes a process off the list; the jobs that it still owes have failed for ``reason``."""
        self._running.remove(process)
        kept = _waiting.get()
        is_kept = kept is not None and not reason
        if not is_kept:
            process.leave()
        noise = process.noise()
        if noise:
            _LOG.debug("%s printed:\n%s", process.engine, noise)
        if reason and noise:
            reason += f"; it last printed: {noise.splitlines()[-1]}"
        for index, job in enumerate(process.jobs):
            found = results.get((process.engine, index))
            results[process.engine, index] = (
                job.failed(reason, noise) if found is None else replace(found, noise=noise)
            )
        if kept is not None and is_kept:
            kept[process.engine] = process
        else:
            process.stderr.close()

    def stop(self) -> None:
        """Ends every process that is still at work."""
        for process in self._running:
            process.stop()


def _take(
    process: EngineProcess,
    message: tuple[int, _Ended],
    results: dict[tuple[str, int], _Ended],
    keep: Keep | None,
) -> None:
    index, outcome = message
    if keep is not None:
        keep(process.jobs[index], outcome)
    results[process.engine, index] = outcome


def _collect(
    by_engine: dict[str, list[Job | Inquiry[Any]]],
    ordered: list[Job | Inquiry[Any]],
    results: dict[tuple[str, int], _Ended],
) -> list[_Ended]:
    places = {id(job): (job.engine, i) for own in by_engine.values() for i, job in enumerate(own)}
    return [
        results.get(places[id(job)], job.failed("interrupted before it ran")) for job in ordered
    ]
