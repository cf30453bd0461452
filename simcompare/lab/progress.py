"""How far a job is: told in the worker, read by the server."""

from __future__ import annotations

import ctypes

_told: list[ctypes.c_double] = []


def tell_to(place: ctypes.c_double) -> None:
    """Takes the number that server and worker share; called once in each worker.

    Args:
        place: holds the share that is done.
    """
    _told[:] = [place]


def tell(share: float) -> None:
    """Tells how far the job of this process is; where nobody asks, nothing happens.

    Args:
        share: from 0 to 1.
    """
    for place in _told:
        place.value = min(max(share, 0.0), 1.0)
