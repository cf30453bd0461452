"""Work that a lab can be tried with: it needs no engine."""

import os
import signal
import time

from simcompare.errors import InputError, UnknownName
from simcompare.lab import progress


def perform(kind, request):
    """What a job does, by what its request says."""
    how = request.get("how", "")
    if kind == "scenarios":
        return {"scenarios": [{"name": "ball", "title": "A <b>ball</b>", "question": "?"}]}
    if how == "fault":
        raise InputError(f"{request['folder']}/recordings/x", ["holds no bounce", "is silent"])
    if how == "unknown":
        raise UnknownName("engine", "mujoko", ["mujoco"])
    if how == "broken":
        raise ZeroDivisionError
    if how == "nan":
        return {"sentence": float("nan")}
    if how == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if how == "sleep":
        progress.tell(0.25)
        time.sleep(request["seconds"])
    return {"sentence": f"{kind} of {request.get('scenario')}", "pid": os.getpid(), "files": []}


def slow_to_read(kind, request):
    """Finds nothing in recordings, in words."""
    raise InputError("sound", ["holds no bounce"])
