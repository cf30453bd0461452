"""The process of one engine, as the runner sees it."""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections import deque
from typing import IO, Any

from simcompare.running.jobs import Inquiry, Job, Outcome, Reply
from simcompare.running.messages import most_bytes, received
from simcompare.running.wire import BadFrame, receive, send
from simcompare.running.worker import Work, packed

#: how long an engine may take to end after its last result [s]
LEAVE_LIMIT_S = 2.0
#: letters of what a process printed that are told; bytes above which the rest is thrown away, and
#: how often it is looked [s]
_NOISE_KEPT, _MOST_NOISE_BYTES, _LOOK_S = 4000, 64 * 2**20, 1.0

Message = tuple[int, Outcome | Reply[Any]] | None
#: ``None`` where there is only something else to look at
Inbox = queue.SimpleQueue[tuple["EngineProcess", Message] | None]


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
        self.jobs: Work = ()
        self.deadline, self.done = 0.0, 0
        # whoever reads it does not move the place where the process writes
        self.stderr: IO[bytes] = tempfile.TemporaryFile("a+b")  # noqa: SIM115  (closed by the runner)
        self._heard, self._before, self._reading = 0, b"", threading.Lock()
        self._exit_code: int | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._has_ended, self._owner = threading.Event(), os.getpid()
        self._fault = ""
        #: jobs without an answer, each with its number in this process and its index
        self._owed: deque[tuple[int, int, Job | Inquiry[Any]]] = deque()
        self._given = 0

    @property
    def lives(self) -> bool:
        """Whether it can be given jobs; a copy of this process cannot, they would be mixed."""
        return not self._has_ended.is_set() and self._owner == os.getpid()

    def begin(self, jobs: Work, inbox: Inbox, *, is_last: bool) -> None:
        """Gives it jobs, whose outcomes come into the inbox.

        Args:
            jobs: what it has to do.
            inbox: takes (process, (index, outcome)), and (process, ``None``) when it has ended.
            is_last: whether it ends after them.
        """
        self.jobs, self.done, self._inbox = jobs, 0, inbox
        self._owed.extend((self._given + i, i, job) for i, job in enumerate(jobs))
        self._given += len(jobs)
        if self._process is None:
            self._start()
        threading.Thread(target=self._tell, args=(jobs, is_last), daemon=True).start()

    def _start(self) -> None:
        # the child gets this process' import path, wherever simcompare and the engines come from
        path = f"import sys; sys.path[:] = {sys.path!r}"
        # a connection of its own: an engine may print, read and write what it likes elsewhere
        self._connection, theirs = socket.socketpair()
        guarded = f"from simcompare.running import guard; guard.begin({theirs.fileno()})"
        main = f"from simcompare.running.worker import main; main({theirs.fileno()})"
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-c", f"{path}; {guarded}; {main}"],
                stdin=subprocess.DEVNULL,
                stdout=self.stderr,
                stderr=self.stderr,
                pass_fds=[theirs.fileno()],
                # Ctrl-C reaches the runner alone, which then ends its processes
                start_new_session=True,
            )
        threading.Thread(target=self._listen, daemon=True).start()
        threading.Thread(target=self._watch, args=(self._process,), daemon=True).start()
        threading.Thread(target=self._bound_noise, daemon=True).start()

    def _tell(self, jobs: Work, is_last: bool) -> None:
        # if it died at once, the end of its answers says so
        with contextlib.suppress(OSError):
            send(self._connection, *packed(jobs))
            if is_last:
                send(self._connection, *packed(()))

    def _listen(self) -> None:
        try:
            while (ended := self._next()) is not None:
                self._inbox.put((self, ended))
        except OSError:  # the runner has ended it
            pass
        except Exception as error:  # noqa: BLE001  (an engine may have sent anything)
            self._fault = f"it sent {error}" if isinstance(error, BadFrame) else _unread(error)
        self._has_ended.set()
        self._inbox.put((self, None))

    def _next(self) -> Message:
        """The next answer; ``None`` where the process has ended."""
        frame = receive(self._connection, self._most_bytes)
        if frame is None:
            return None
        if not self._owed:
            raise BadFrame("an answer that nobody asked for")
        number, index, job = self._owed.popleft()
        return index, received(number, job, *frame)

    def _most_bytes(self) -> int:
        return most_bytes(self._owed[0][2]) if self._owed else 0

    def _watch(self, process: subprocess.Popen[bytes]) -> None:
        """Ends with the process all that it has started, and the connection that this may hold."""
        process.wait()
        self.stop()
        with contextlib.suppress(OSError):
            self._connection.shutdown(socket.SHUT_RD)  # what was sent before can still be read

    def stop(self) -> None:
        """Ends the process and everything that it started; only once, its number may be reused."""
        if self._process is None or self._exit_code is not None or self._owner != os.getpid():
            return
        with contextlib.suppress(ProcessLookupError, PermissionError):  # all of them are gone
            os.killpg(self._process.pid, signal.SIGKILL)
        self._exit_code = self._process.wait()

    def noise(self) -> str:
        """What the process printed during its last jobs, the end of it where it is long."""
        with self._reading:
            said, self._before = self._before + self._new_noise(), b""
        text = said.decode("utf-8", errors="replace").strip()
        return text if len(text) <= _NOISE_KEPT else "… " + text[-_NOISE_KEPT:]

    def _new_noise(self) -> bytes:
        size = self.stderr.seek(0, os.SEEK_END)
        # a letter takes four bytes at most
        self.stderr.seek(max(self._heard, size - 4 * _NOISE_KEPT - 4))
        self._heard = size
        return self.stderr.read()

    def _bound_noise(self) -> None:
        """Looks now and then that what the process prints does not fill the disk."""
        while not self._has_ended.wait(_LOOK_S):
            with contextlib.suppress(OSError, ValueError):  # it has just been closed
                self.throw_noise_away()

    def throw_noise_away(self) -> None:
        """Makes room on the disk where much was printed; the end is still told."""
        with self._reading:
            if self.stderr.seek(0, os.SEEK_END) > _MOST_NOISE_BYTES:
                self._before = self._new_noise()
                self.stderr.truncate(0)
                self._heard = 0

    def leave(self) -> int:
        """Waits a moment for the process to end by itself, else ends it; its exit code."""
        assert self._process is not None
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(LEAVE_LIMIT_S)
        self.stop()  # also what the process itself left behind
        with contextlib.suppress(OSError):  # the other end is gone
            self._connection.shutdown(socket.SHUT_RDWR)
        self._connection.close()
        assert self._exit_code is not None
        return self._exit_code

    def dismiss(self) -> None:
        """Tells a process that was kept to end."""
        with contextlib.suppress(OSError):
            send(self._connection, *packed(()))

    def how_it_died(self) -> str:
        """One sentence on the end of a process that owed outcomes."""
        assert self._process is not None
        if self._fault:
            self.stop()
            self.leave()
            return f"{self.engine}: {self._fault}; its process was ended"
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(LEAVE_LIMIT_S)
        was_there = self._process.poll() is None
        code = self.leave()
        if was_there:
            return f"{self.engine}: it closed its connection to simcompare; its process was ended"
        if code < 0:
            return f"{self.engine}: its process was killed by {_signal(-code)}"
        return f"{self.engine}: its process ended early with exit code {code}"


def _unread(error: Exception) -> str:
    return f"its answer cannot be read ({type(error).__name__}: {error})".replace("\n", "; ")


def _signal(number: int) -> str:
    with contextlib.suppress(ValueError):  # it has no name
        return signal.Signals(number).name
    return f"signal {number}"
