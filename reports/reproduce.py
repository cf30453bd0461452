"""The command that makes a run again."""

from __future__ import annotations

import hashlib
import shlex

from simcompare import catalogue
from simcompare.errors import SimcompareError
from simcompare.reports import runs
from simcompare.results import Run
from simcompare.scenario import Scenario


def command(run: Run) -> str:
    """``simcompare run …`` with everything that differs from the scenario's own values.

    All values are named where the scenario's file is no longer the one of the run.
    """
    record = run.record
    if record.get("command"):
        return shlex.join(record["command"])
    words = ["simcompare", "run", str(record["scenario_asked"])]
    words += ["--engine", str(record["engines_asked"])]
    words += ["--contact", ",".join(runs.modes(run))]
    if record["preset"]:
        words += ["--preset", str(record["preset"])]
    own = _own_values(run)
    for name, value in record["parameters"].items():
        if own is None or own.parameters.get(name) != value:
            words += ["--set", f"{name}={value!r}"]
    if own is None or own.world.step_s != record["step_s"]:
        parts = 1 if own is None else own.world.substeps
        words += ["--step", f"{record['step_s'] / parts!r}s"]
    count = own.dither.count if own is not None and own.dither is not None else 1
    if count != record["repeats"]:
        words += ["--seeds", str(record["repeats"])]
    if record.get("against"):
        words += ["--against", str(record["against_asked"])]
    return shlex.join(words)


def _own_values(run: Run) -> Scenario | None:
    """The scenario as its file has it, ``None`` where that file is gone or has changed."""
    try:
        file = catalogue.load(str(run.record["scenario_asked"]))
        digest = hashlib.sha256(file.path.read_bytes()).hexdigest()
        if digest != run.record["scenario_sha256"]:
            return None
        return file.resolve(preset=run.record["preset"])
    except (SimcompareError, OSError):
        return None
