"""A small process beside each worker: it ends the worker's whole group when the runner is gone.

A worker cannot do so itself while its engine is in a long call of C.
"""

from __future__ import annotations

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
    # whoever waits for the end of any other waits for the worker's
    os.closerange(0, descriptor)
    os.closerange(descriptor + 1, os.sysconf("SC_OPEN_MAX"))
    waiting = select.poll()
    waiting.register(descriptor, 0)  # nothing is read: only the end is waited for
    waiting.poll()
    os.killpg(os.getpgrp(), signal.SIGKILL)
