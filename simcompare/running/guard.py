"""A small process beside each worker: it ends the worker's whole group when the runner is gone.

A worker cannot do so itself while its engine is in a long call of C.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal


def begin(descriptor: int) -> None:
    """Starts it, where the system can; called first of all in a worker.

    Args:
        descriptor: of what comes from the runner, and ends with it.
    """
    if not hasattr(os, "fork") or os.fork():
        return
    for other in {0, 1, 2} - {descriptor}:  # whoever waits for their end waits for the worker's
        with contextlib.suppress(OSError):
            os.close(other)
    waiting = select.poll()
    waiting.register(descriptor, 0)  # nothing is read: only the end is waited for
    waiting.poll()
    os.killpg(os.getpgrp(), signal.SIGKILL)
