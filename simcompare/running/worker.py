"""The process in which one engine runs: jobs come in and answers go out on one own connection.

All that the engine itself prints, also from C, goes where the runner keeps it.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import socket
import sys
import threading
from collections.abc import Sequence
from typing import Any

import numpy as np

from simcompare.running.jobs import Inquiry, Job
from simcompare.running.messages import sent
from simcompare.running.wire import Arrays, receive, send

try:
    import fcntl
except ImportError:  # Windows has none
    fcntl = None  # type: ignore[assignment]

#: a descriptor that is not among those that a program opens and closes without a thought
_OUT_OF_THE_WAY = 200
#: what jobs may have: the runner is trusted
_ANY_BYTES = 2**62

Work = Sequence[Job | Inquiry[Any]]


def main(descriptor: int) -> None:
    """Receives lists of jobs, and sends one answer for each as it ends.

    Args:
        descriptor: of the connection to the runner.
    """
    connection = socket.socket(fileno=_moved(descriptor))
    os.register_at_fork(after_in_child=connection.close)
    works: queue.SimpleQueue[Work] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(connection, works), daemon=True).start()
    number = 0
    while work := works.get():
        for job in work:
            _answer(connection, number, job)
            number += 1


def _moved(descriptor: int) -> int:
    """Another descriptor of the same connection, which the engine's own children do not get."""
    if fcntl is None:
        os.set_inheritable(descriptor, False)
        return descriptor
    try:
        moved = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, _OUT_OF_THE_WAY)
    except OSError:  # so many may not be open here
        os.set_inheritable(descriptor, False)
        return descriptor
    os.close(descriptor)
    return moved


def _answer(connection: socket.socket, number: int, job: Job | Inquiry[Any]) -> None:
    ended = job.execute()
    with contextlib.suppress(Exception):  # an engine may have taken it away
        sys.stdout.flush()
    try:
        head, arrays = sent(number, ended)
        send(connection, head, arrays)
    except OSError as error:
        print(f"the connection to simcompare is broken: {error}", file=sys.stderr, flush=True)
        os._exit(1)
    except Exception as error:  # noqa: BLE001  (a backend may have put anything into its result)
        reason = f"{job.engine}: its result cannot be sent: {type(error).__name__}: {error}"
        send(connection, *sent(number, job.failed(reason)))


def packed(work: Work) -> tuple[dict[str, Any], Arrays]:
    """Jobs as the parts of a frame; none of them: there will be no more."""
    return {}, [np.frombuffer(pickle.dumps(list(work), protocol=5), np.uint8)]


def _listen(connection: socket.socket, works: queue.SimpleQueue[Work]) -> None:
    """Takes jobs in; ends this process when the runner is gone."""
    with contextlib.suppress(OSError, ValueError):
        while (frame := receive(connection, lambda: _ANY_BYTES)) is not None:
            works.put(pickle.loads(frame[1][0].data))
    os._exit(1)
