"""The process in which one engine runs: jobs come in on stdin, outcomes go out on stdout.

Everything that the engine itself prints, also from C, is sent to stderr, which the runner keeps.
"""

from __future__ import annotations

import os
import pickle
import struct
import sys
from typing import IO

from simcompare.jobs import Job, execute

HEADER = struct.Struct("<Q")


def main() -> None:
    """Reads a pickled list of jobs and writes one frame per outcome, as each ends."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    jobs: list[Job] = pickle.load(sys.stdin.buffer)
    for index, job in enumerate(jobs):
        write_frame(results, pickle.dumps((index, execute(job)), protocol=5))


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
