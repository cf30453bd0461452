"""The command that makes a run again."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence

from simcompare.engine import engines
from simcompare.errors import SimcompareError
from simcompare.model.scenario import Scenario
from simcompare.model.settings import COEFFICIENTS, DEFAULT, TUNED
from simcompare.reports.run import runs
from simcompare.results.records.run import RunRecord
from simcompare.results.run import Run
from simcompare.results.run_record import sha256_of
from simcompare.running.jobs import OK
from simcompare.scenarios import catalogue


def command(run: Run) -> str:
    """The words that were typed; all values where the scenario's file is not that of the run."""
    record, scenario = run.record, scenario_of(run)
    if record.command and (not isinstance(record, RunRecord) or scenario is not None):
        return shlex.join(record.command)
    words = ["simcompare", "run", str(record.scenario_asked)]
    words += ["--engine", str(record.engines_asked)]
    words += ["--contact", ",".join(runs.modes(run))]
    if record.assist:
        words += ["--assist", str(record.assist)]
    if TUNED in (record.judge or ()):  # assisted, and a fit, are judged in any case
        words += ["--judge", TUNED]
    words += _values(run, scenario, [step.engine_step_s for step in runs.steps(run)])
    count = scenario.dither.count if scenario is not None and scenario.dither is not None else 1
    if count != record.repeats:
        words += ["--seeds", str(record.repeats)]
    if isinstance(record, RunRecord) and record.against is not None:
        words += ["--against", str(record.against_asked)]
    return shlex.join(words)


def scripts(run: Run) -> list[str]:
    """Commands that write each row of a plain loop as a script that needs no simcompare."""
    record = run.record
    if not record.scenario_asked or not record.engines_asked:
        return []
    commands = []
    for source in record.sources:
        if source.status != OK or source.contact not in (DEFAULT, COEFFICIENTS, TUNED):
            continue
        name, level = str(source.engine or source.name), str(source.contact)
        base = engines.split(name)[0]
        if base in engines.names() and not getattr(engines.get(base), "script_module", ""):
            continue  # it has no writer of scripts
        words = ["simcompare", "export", str(record.scenario_asked), "--format", "script"]
        steps_s = [] if source.engine_step_s is None else [source.engine_step_s]
        words += ["--engine", name, "--contact", level]
        words += _values(run, scenario_of(run), steps_s)
        stem = f"{record.scenario}_{source.name}_{level}"
        words += ["-o", f"{re.sub('[:@]', '_', stem)}.py"]
        commands.append(shlex.join(words))
    return commands


def _values(run: Run, scenario: Scenario | None, steps_s: Sequence[float]) -> list[str]:
    """Options for all values that differ from the scenario's own.

    Args:
        run: the run.
        scenario: as its file has it, ``None`` where that is not known.
        steps_s: steps of the engines, where the run has several.
    """
    record, words = run.record, []
    if record.preset:
        words += ["--preset", str(record.preset)]
    for name, value in record.parameters.items():
        if scenario is None or scenario.parameters.get(name) != value:
            words += ["--set", f"{name}={value!r}"]
    if steps_s:
        words += ["--step", ",".join(f"{step_s!r}s" for step_s in steps_s)]
    elif scenario is None or scenario.world.step_s != record.step_s:
        parts = 1 if scenario is None else scenario.world.substeps
        words += ["--step", f"{record.step_s / parts!r}s"]
    return words


def scenario_of(run: Run, *, unchanged: bool = True) -> Scenario | None:
    """The scenario as its file has it, ``None`` where that file is gone or must be unchanged."""
    try:
        file = catalogue.load(str(run.record.scenario_asked))
        if unchanged and sha256_of(file) != run.record.scenario_sha256:
            return None
        return file.resolve(preset=run.record.preset)
    except (SimcompareError, OSError):
        return None
