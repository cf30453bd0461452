"""The process of one engine, as the runner sees it."""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Sequence
from typing import IO, Any

from simcompare.running.jobs import Inquiry, Job, Outcome, Reply
from simcompare.running.worker import FAREWELL, read_frame, write_frame

#: how long an engine may take to end after its last result [s]
LEAVE_LIMIT_S = 2.0
_NOISE_KEPT = 4000

Message = tuple[int, Outcome | Reply[Any]] | None
Inbox = queue.Queue[tuple["EngineProcess", Message]]


class EngineProcess:
    """One engine's process and what is still expected of it.

    Args:
        engine: its name.

    Attributes:
        engine: its name.
        jobs: those that it was given last.
        done: how many of them have ended.
        deadline: until when the next one has to.
        stderr: what it prints.
    """

    def __init__(self, engine: str) -> None:
        self.engine = engine
        self.jobs: Sequence[Job | Inquiry[Any]] = ()
        self.deadline, self.done = 0.0, 0
        # whoever reads it does not move the place where the process writes
        self.stderr: IO[bytes] = tempfile.TemporaryFile("a+b")  # noqa: SIM115  (closed by the runner)
        self._heard = 0
        self._exit_code: int | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._has_ended = False

    @property
    def lives(self) -> bool:
        """Whether it can be given jobs."""
        return not self._has_ended

    def begin(self, jobs: Sequence[Job | Inquiry[Any]], inbox: Inbox, *, is_last: bool) -> None:
        """Gives it jobs, whose outcomes come into the inbox.

        Args:
            jobs: what it has to do.
            inbox: takes (process, (index, outcome)), and (process, ``None``) when it has ended.
            is_last: whether it ends after them.
        """
        self.jobs, self.done, self._inbox = jobs, 0, inbox
        if self._process is None:
            self._process = self._started()
            threading.Thread(target=self._listen, args=(self._process,), daemon=True).start()
        more = (self._process, jobs, is_last)
        threading.Thread(target=self._tell, args=more, daemon=True).start()

    def _started(self) -> subprocess.Popen[bytes]:
        # the child gets this process' import path, wherever simcompare and the engines come from
        path = f"import sys; sys.path[:] = {sys.path!r}"
        code = f"{path}; from simcompare.running.worker import main; main()"
        return subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.stderr,
            # Ctrl-C reaches the runner alone, which then ends its processes
            start_new_session=True,
        )

    def _tell(
        self, process: subprocess.Popen[bytes], jobs: Sequence[Job | Inquiry[Any]], is_last: bool
    ) -> None:
        assert process.stdin is not None
        # if it died at once, the end of its output says so
        with contextlib.suppress(BrokenPipeError):
            # stdin stays open: its end tells the worker that this process is gone
            write_frame(process.stdin, pickle.dumps(list(jobs), protocol=5))
            if is_last:
                write_frame(process.stdin, FAREWELL)

    def _listen(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None
        while (payload := read_frame(process.stdout)) is not None:
            self._inbox.put((self, pickle.loads(payload)))
        self._has_ended = True
        self._inbox.put((self, None))

    def stop(self) -> None:
        """Ends the process and everything that it started; only once, its number may be reused."""
        if self._process is None or self._exit_code is not None:
            return
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError):  # it and its children are gone
                os.killpg(self._process.pid, signal.SIGKILL)
        else:  # pragma: no cover  (Windows)
            self._process.kill()
        self._exit_code = self._process.wait()

    def noise(self) -> str:
        """What the process printed during its last jobs, the end of it where it is long."""
        self.stderr.seek(self._heard)
        raw = self.stderr.read()
        self._heard += len(raw)
        text = raw.decode("utf-8", errors="replace").strip()
        return text if len(text) <= _NOISE_KEPT else "… " + text[-_NOISE_KEPT:]

    def leave(self) -> int:
        """Waits a moment for the process to end by itself, else ends it; its exit code."""
        assert self._process is not None
        assert self._process.stdin is not None
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(LEAVE_LIMIT_S)
        self.stop()  # also what the process itself left behind
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        assert self._exit_code is not None
        return self._exit_code

    def dismiss(self) -> None:
        """Tells a process that was kept to end."""
        assert self._process is not None
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):
            write_frame(self._process.stdin, FAREWELL)

    def how_it_died(self) -> str:
        """One sentence on the end of a process that owed outcomes."""
        code = self.leave()
        if code < 0:
            return f"{self.engine}: its process was killed by {signal.Signals(-code).name}"
        return f"{self.engine}: its process ended early with exit code {code}"
