"""The jobs "script" and "report": what a group takes home."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from simcompare.errors import InputError, SimcompareError
from simcompare.exporters.export import export
from simcompare.lab import facts, fits, kept
from simcompare.lab.asked import Asked
from simcompare.lab.refusals import say
from simcompare.model.plain import Plain
from simcompare.model.settings import BY_HAND, DEFAULT, TUNED
from simcompare.results import fit_file
from simcompare.results.run import Run
from simcompare.scenarios import catalogue
from simcompare.verbs.load_run import load_run
from simcompare.verbs.report import report as write_report
from simcompare.verbs.run import run as simulate

#: longest simulation [s]
_LIMIT_S = 60.0


def script(asked: Asked) -> Plain:
    """A program for each engine that needs only that engine and NumPy.

    With a fit as ``result`` it has what was fitted, and falls as high as the ball did. Else it has
    what was typed in as ``contact``; an engine without that is tuned.

    Raises:
        InputError: no engine can have one; says why for each.
    """
    fit = fits.file_of(asked)
    names, faults = [], []
    for engine in _engines(asked):
        if not facts.has_script(engine):
            faults.append(say(asked.language, "no_script", engine=engine))
            continue
        name = kept.name_of(asked, engine, "py")
        try:
            kept.file(asked.folder(), name, _script_of(asked, engine, fit))
        except SimcompareError as error:
            faults.append(f"{engine}: {error}")
            continue
        names.append(name)
    if not names:
        raise InputError("script", faults)
    return {"files": names, "missing": faults}


def _engines(asked: Asked) -> list[str]:
    """The engines of which scripts are wanted: one, or a list."""
    return [asked.engine()] if "engine" in asked.request else asked.engines()


def _script_of(asked: Asked, engine: str, fit: Path | None) -> str:
    scenario = asked.scenario()
    if fit is not None:
        height = fit_file.read(fit).drop(catalogue.load(scenario))
        return export(scenario, format="script", engine=engine, fit=str(fit), set=height)
    own = {key: v for key, v in asked.own().items() if key.partition(".")[0] == engine}
    return export(
        scenario, format="script", engine=engine, set=asked.parameters(), own=own or None,
        contact=None if own else TUNED,
    )  # fmt: skip


def report(asked: Asked) -> Plain:
    """The report of a stored result, as one page.

    A fit is told as it was stored. A run is made again with all its repeats: on the page it was
    only looked at.

    Raises:
        InputError: no result is named, or there is nothing to tell of it.
    """
    place = asked.result()
    if place is None:
        raise InputError("result", ["none is named; run or fit first"])
    name = kept.name_of(asked, "report", "html")
    write_report(_run_of(asked, place), out=kept.files(asked.folder()) / name)
    return {"files": [name]}


def _run_of(asked: Asked, place: Path) -> Run:
    stored = asked.folder() / fits.FITS / place.name
    if stored.is_dir():
        return load_run(stored)
    then = Asked({**_request_of(place), "folder": str(asked.folder())})
    levels, own = then.levels(), then.own()
    return simulate(
        then.scenario(), engine=then.engines(), contact=levels or (BY_HAND if own else DEFAULT),
        set=then.parameters(), own=own or None, against=then.published(), time_limit_s=_LIMIT_S,
    )  # fmt: skip


def _request_of(place: Path) -> dict[str, Any]:
    """What a run was asked, as the server stored it."""
    try:
        found = json.loads((place / "result.json").read_text(encoding="utf-8"))
        request = found["request"]
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError("result", ["cannot be read; run or fit again"]) from None
    if not isinstance(request, dict) or found.get("kind") != "run":
        raise InputError("result", ["is no run and no fit, so there is no report of it"])
    return request
