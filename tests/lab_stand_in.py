"""Work that a lab can be tried with: it needs no engine."""

import errno
import os
import signal
import time
from collections import Counter

from simcompare.errors import InputError, UnknownName

SCENARIOS = {"scenarios": [{"name": "ball", "title": "A <b>ball</b>", "question": "?"}]}


def perform(kind, request):
    """What a job does, by what its request says."""
    if kind == "warm":
        _warm.append("warm")
    if kind == "scenarios":
        return SCENARIOS
    if kind == "recording" and request["name"] == "silence.wav":
        raise InputError("silence.wav", ["no impact is heard in it"])
    if "how" in request:
        return HOW[request["how"]](request)
    return {"sentence": f"{kind} of {request.get('scenario')}", "pid": os.getpid(), "files": []}


def _fault(request):
    raise InputError(f"{request['folder']}/recordings/x", ["holds no bounce", "is too short"])


def _unknown(_):
    raise UnknownName("engine", "mujoko", ["mujoco"])


def _broken(_):
    raise ZeroDivisionError


def _full(_):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def _die(_):
    os.kill(os.getpid(), signal.SIGKILL)


def _long(_):
    time.sleep(1000)


def _count(request):
    """How often a worker was asked for this."""
    _counts[request["of"]] += 1
    return {"sentence": f"{request['of']} was counted {_counts[request['of']]} times"}


_counts: Counter[str] = Counter()
_warm: list[str] = []
HOW = {
    "warmed": lambda _: {"sentence": " ".join(_warm)},
    "count": _count,
    "fault": _fault,
    "unknown": _unknown,
    "broken": _broken,
    "no number": lambda _: {"sentence": float("nan")},
    "full": _full,
    "die": _die,
    "long": _long,
}
