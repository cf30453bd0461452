"""What the jobs of the lab do, each in a worker's process: a request becomes a result."""

from __future__ import annotations

import atexit
import contextlib
import functools
import multiprocessing
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.logs import importers
from simcompare.lab import contents, facts, fits, recordings, runs, takeaways, video
from simcompare.lab.asked import Asked, number
from simcompare.lab.queue import READING
from simcompare.lab.translation import each
from simcompare.model.plain import Plain
from simcompare.running import doctor
from simcompare.running.runner import kept_processes

_KEPT = contextlib.ExitStack()
#: libraries with which recordings are read
_READ_WITH = ("scipy.signal", "soundfile", "duckdb")


def perform(kind: str, request: Mapping[str, Any]) -> Plain:
    """Does a job.

    Args:
        kind: "scenarios", "scenario", "run", "fit", "script", "report", "recording", "film"
            or "scale"; before the first of them "warm", or "warm_reader" where all of them read.
        request: what the page asks, with what the server adds to it.

    Returns:
        What JSON can hold.

    Raises:
        SimcompareError: what is wrong, in sentences.
    """
    if kind not in _KINDS:
        raise UnknownName("kind of job", kind, _KINDS)
    asked = Asked(request)
    asked.check()
    if kind not in _WITHOUT_ENGINES:
        _keep_engines()
    return _KINDS[kind](asked)


@functools.cache
def _keep_engines() -> None:
    """Lets engines' processes live as long as a worker: to start them takes a second each."""
    if multiprocessing.parent_process() is None:  # nobody's worker
        return
    _KEPT.enter_context(kept_processes())
    atexit.register(_KEPT.close)  # later, threads that wait for these processes stand still


def _warm(asked: Asked) -> Plain:
    """Starts the engines' processes, before the first job waits for them."""
    del asked
    doctor.doctor()
    return {}


def _warm_reader(asked: Asked) -> Plain:
    """Loads what reads recordings; each reading is a copy of this process."""
    del asked
    for load, names in ((importers.get, importers.targets()), (import_module, _READ_WITH)):
        for name in names:
            with contextlib.suppress(Exception):  # it is told where it is needed
                load(name)
    return {}


def _scenarios(asked: Asked) -> Plain:
    return facts.scenarios(asked.language)


def _scenario(asked: Asked) -> Plain:
    return facts.scenario(asked.scenario(key="name"), asked.language)


def _recording(asked: Asked) -> Plain:
    kind = asked.one_of("kind", (contents.SOUND, contents.TABLE))
    return _told(recordings.received(Path(asked.text("path")), kind), asked)


def _film(asked: Asked) -> Plain:
    return _told(video.received(Path(asked.text("path"))), asked)


def _scale(asked: Asked) -> Plain:
    place = asked.recording()
    if place is None:
        raise InputError("recording", ["none is named; send a film first"])
    metres = number(asked.request.get("metres"), "metres")
    return _told(video.scaled(place, asked.request.get("points"), metres), asked)


def _told(found: Plain, asked: Asked) -> Plain:
    """A recording with its notes in the language of the page."""
    return {**found, "notes": each(found["notes"], asked.language)}


#: kinds for which engines' processes are not begun: a process with them cannot be copied safely
_WITHOUT_ENGINES = ("warm_reader", *READING)
_KINDS: Mapping[str, Callable[[Asked], Plain]] = {
    "warm": _warm,
    "warm_reader": _warm_reader,
    "scenarios": _scenarios,
    "scenario": _scenario,
    "run": runs.run,
    "fit": fits.fit,
    "script": takeaways.script,
    "report": takeaways.report,
    "recording": _recording,
    "film": _film,
    "scale": _scale,
}
