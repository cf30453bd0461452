"""The process in which one engine runs: jobs come in on stdin, outcomes go out on stdout.

Everything that the engine itself prints, also from C, is sent to stderr, which the runner keeps.
"""

from __future__ import annotations

import os
import pickle
import queue
import struct
import sys
import threading
from typing import IO, Any

from simcompare.running.jobs import Inquiry, Job

HEADER = struct.Struct("<Q")
#: a frame after which no jobs follow
FAREWELL = b""


def main() -> None:
    """Reads frames with lists of jobs and writes one frame per outcome, as each ends."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    frames: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(frames,), daemon=True).start()
    while (payload := frames.get()) != FAREWELL:
        jobs: list[Job | Inquiry[Any]] = pickle.loads(payload)
        for index, job in enumerate(jobs):
            write_frame(results, _pickled(index, job))


def _pickled(index: int, job: Job | Inquiry[Any]) -> bytes:
    outcome = job.execute()
    try:
        return pickle.dumps((index, outcome), protocol=5)
    except Exception as error:  # noqa: BLE001  (a backend may have put anything into its result)
        reason = f"{job.engine}: its result cannot be sent: {type(error).__name__}: {error}"
        return pickle.dumps((index, job.failed(reason)), protocol=5)


def _listen(frames: queue.SimpleQueue[bytes]) -> None:
    """Takes frames in; ends this process when the runner is gone: then stdin is at its end."""
    while (payload := read_frame(sys.stdin.buffer)) is not None:
        frames.put(payload)
        if payload == FAREWELL:
            os.read(0, 1)
    os._exit(1)


def write_frame(stream: IO[bytes], payload: bytes) -> None:
    """Writes one length-prefixed frame."""
    stream.write(HEADER.pack(len(payload)))
    stream.write(payload)
    stream.flush()


def read_frame(stream: IO[bytes]) -> bytes | None:
    """Reads one frame; ``None`` at the end of the stream, also in the middle of a frame."""
    header = stream.read(HEADER.size)
    if len(header) < HEADER.size:
        return None
    (size,) = HEADER.unpack(header)
    payload = stream.read(size)
    return payload if len(payload) == size else None
