"""Running jobs: one process per engine, so that a crash, a hang or noise stays with its engine."""

from __future__ import annotations

import contextlib
import logging
import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import IO, Any, overload

from simcompare.errors import InputError
from simcompare.running.jobs import Answer, Inquiry, Job, Outcome, Reply
from simcompare.running.worker import read_frame, write_frame

#: longest time that one job may take, the engine's import included [s]
TIME_LIMIT_S = 120.0
#: how long an engine may take to end after its last result [s]
LEAVE_LIMIT_S = 2.0
#: longest wait for a message, whatever the time limit [s]
_MAX_WAIT_S = 3600.0
_NOISE_KEPT = 4000
_LOG = logging.getLogger(__name__)

Progress = Callable[[str, int, int], None]
_Ended = Outcome | Reply[Any]


@dataclass(eq=False)
class _Worker:
    """One engine's process and what is still expected of it."""

    engine: str
    jobs: Sequence[Job | Inquiry[Any]]
    deadline: float = 0.0
    process: subprocess.Popen[bytes] | None = None
    stderr: IO[bytes] = field(default_factory=tempfile.TemporaryFile)
    done: int = 0
    exit_code: int | None = None

    def start(self, inbox: queue.Queue[tuple[_Worker, tuple[int, _Ended] | None]]) -> None:
        """Starts the process, feeds it, and has a thread put its outcomes into ``inbox``."""
        # the child gets this process' import path, wherever simcompare and the engines come from
        path = f"import sys; sys.path[:] = {sys.path!r}"
        code = f"{path}; from simcompare.running.worker import main; main()"
        self.process = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.stderr,
            # Ctrl-C reaches the runner alone, which then ends its workers
            start_new_session=True,
        )
        threading.Thread(target=self._talk, args=(inbox,), daemon=True).start()

    def _talk(self, inbox: queue.Queue[tuple[_Worker, tuple[int, _Ended] | None]]) -> None:
        process = self.process
        assert process is not None
        assert process.stdin is not None
        assert process.stdout is not None
        # if it died at once, the end of its output says so
        with contextlib.suppress(BrokenPipeError):
            # stdin stays open: its end tells the worker that this process is gone
            write_frame(process.stdin, pickle.dumps(list(self.jobs), protocol=5))
        while (payload := read_frame(process.stdout)) is not None:
            inbox.put((self, pickle.loads(payload)))
        inbox.put((self, None))

    def stop(self) -> None:
        """Ends the process and everything that it started; only once, its number may be reused."""
        if self.process is None or self.exit_code is not None:
            return
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError):  # it and its children are gone
                os.killpg(self.process.pid, signal.SIGKILL)
        else:  # pragma: no cover  (Windows)
            self.process.kill()
        self.exit_code = self.process.wait()

    def noise(self) -> str:
        """What the process printed, the end of it where it is long."""
        self.stderr.seek(0)
        text = self.stderr.read().decode("utf-8", errors="replace").strip()
        return text if len(text) <= _NOISE_KEPT else "… " + text[-_NOISE_KEPT:]

    def leave(self) -> int:
        """Waits a moment for the process to end by itself, else ends it; its exit code."""
        assert self.process is not None
        assert self.process.stdin is not None
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(LEAVE_LIMIT_S)
        self.stop()  # also what the process itself left behind
        with contextlib.suppress(BrokenPipeError):
            self.process.stdin.close()
        assert self.exit_code is not None
        return self.exit_code

    def how_it_died(self) -> str:
        """One sentence on the end of a process that owed outcomes."""
        code = self.leave()
        if code < 0:
            return f"{self.engine}: its process was killed by {signal.Signals(-code).name}"
        return f"{self.engine}: its process ended early with exit code {code}"


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; carries what had finished.

    Attributes:
        outcomes: outcomes of all jobs, those that had not finished as failed.
    """

    def __init__(self, outcomes: list[Any]) -> None:
        super().__init__("interrupted")
        self.outcomes = outcomes


@overload
def run_jobs(
    jobs: Iterable[Job],
    *,
    time_limit_s: float = ...,
    processes: int | None = ...,
    progress: Progress | None = ...,
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
) -> Any:
    """Runs jobs, each engine's in a process of its own.

    Args:
        jobs: what to run, or to ask; those of one engine run one after another in the given order.
        time_limit_s: longest time for one job [s].
        processes: engines at the same time; as many as there are processors where ``None``.
        progress: called as ``progress(engine, done, total)`` when a job ends.

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
    waiting = [_Worker(engine, own) for engine, own in by_engine.items()]
    results: dict[tuple[str, int], _Ended] = {}
    crew = _Crew(waiting, processes or os.cpu_count() or 1, time_limit_s)
    try:
        crew.work(results, progress, len(ordered))
    except KeyboardInterrupt:
        raise Interrupted(_collect(by_engine, ordered, results)) from None
    finally:
        crew.stop()
    return _collect(by_engine, ordered, results)


def check_time_limit(time_limit_s: float) -> None:
    """Raises ``InputError`` for a time limit that is none."""
    if not time_limit_s > 0:
        raise InputError("--time-limit", [f"{time_limit_s:g} s is not a time above 0"])


class _Crew:
    """The workers of one run."""

    def __init__(self, waiting: list[_Worker], processes: int, time_limit_s: float) -> None:
        self._waiting, self._processes, self._limit_s = waiting, processes, time_limit_s
        self._running: list[_Worker] = []
        self._all = list(waiting)
        self._inbox: queue.Queue[tuple[_Worker, tuple[int, _Ended] | None]] = queue.Queue()

    def work(
        self, results: dict[tuple[str, int], _Ended], progress: Progress | None, total: int
    ) -> None:
        """Starts workers as places become free and gathers outcomes until all are in."""
        while self._waiting or self._running:
            while self._waiting and len(self._running) < self._processes:
                worker = self._waiting.pop(0)
                worker.start(self._inbox)
                worker.deadline = time.monotonic() + self._limit_s
                self._running.append(worker)
            wait = min(worker.deadline for worker in self._running) - time.monotonic()
            try:
                timeout = min(max(wait, 0.01), _MAX_WAIT_S)
                worker, message = self._inbox.get(timeout=timeout)
            except queue.Empty:
                self._end_late_ones(results)
                continue
            if worker not in self._running:
                continue  # ended for being late; this is the end of its output
            if message is None:
                self._close(worker, results, worker.how_it_died())
                continue
            index, outcome = message
            results[worker.engine, index] = outcome
            worker.done += 1
            worker.deadline = time.monotonic() + self._limit_s
            if progress is not None:
                progress(worker.engine, len(results), total)
            if worker.done == len(worker.jobs):
                self._close(worker, results, "")

    def _end_late_ones(self, results: dict[tuple[str, int], _Ended]) -> None:
        now = time.monotonic()
        for worker in [worker for worker in self._running if worker.deadline <= now]:
            worker.stop()
            reason = f"{worker.engine}: no answer within {self._limit_s:g} s; its process was ended"
            self._close(worker, results, reason)

    def _close(self, worker: _Worker, results: dict[tuple[str, int], _Ended], reason: str) -> None:
        """Takes a worker off the list; the jobs that it still owes have failed for ``reason``."""
        self._running.remove(worker)
        worker.leave()
        noise = worker.noise()
        if noise:
            _LOG.debug("%s printed:\n%s", worker.engine, noise)
        if reason and noise:
            reason += f"; it last printed: {noise.splitlines()[-1]}"
        for index, job in enumerate(worker.jobs):
            found = results.get((worker.engine, index))
            results[worker.engine, index] = (
                job.failed(reason, noise) if found is None else replace(found, noise=noise)
            )
        worker.stderr.close()

    def stop(self) -> None:
        """Ends every process that still runs."""
        for worker in self._all:
            worker.stop()


def _collect(
    by_engine: dict[str, list[Job | Inquiry[Any]]],
    ordered: list[Job | Inquiry[Any]],
    results: dict[tuple[str, int], _Ended],
) -> list[_Ended]:
    places = {id(job): (job.engine, i) for own in by_engine.values() for i, job in enumerate(own)}
    return [
        results.get(places[id(job)], job.failed("interrupted before it ran")) for job in ordered
    ]
