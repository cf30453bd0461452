"""What run.json says: plain values with versions, machine, and what every engine was given."""

from __future__ import annotations

import datetime
import hashlib
import platform
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simcompare import measures, notation
from simcompare.compare.against import Match
from simcompare.compare.comparison import Score
from simcompare.compare.repeats import AtStep
from simcompare.engine.library import installed_version
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.results.run import FORMAT
from simcompare.running.jobs import OK, Outcome

if TYPE_CHECKING:
    from simcompare.hardware.recordings.bounce_table import BounceTable
    from simcompare.scenarios.scenario_file import ScenarioFile


def of_source(name: str, mode: str, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """What run.json says of one source in one contact level."""
    bad = [outcome for outcome in outcomes if outcome.status != OK]
    done = [outcome.trajectory for outcome in outcomes if outcome.trajectory is not None]
    nominal = done[len(done) // 2] if done else None
    walls = [trajectory.wall_s for trajectory in done]
    facts = outcomes[0].facts
    return {
        "name": name,
        "version": facts.version,
        "contact": mode,
        "status": bad[0].status if bad else OK,
        "reason": bad[0].reason if bad else None,
        "out_of_reach": bool(bad) and bad[0].longest_step_s is not None,
        "longest_step_s": notation.finite(bad[0].longest_step_s) if bad else None,
        "steps": len(nominal.time_s) - 1 if nominal else None,
        "repeats": len(done),
        "wall_s": {
            "import": walls[0]["import"] if walls and "import" in walls[0] else None,
            # of one simulation, like "steps"; engines run beside each other: this is no benchmark
            "build": _median([wall.get("build", 0.0) for wall in walls]),
            "step": _median([wall.get("step", 0.0) for wall in walls]),
        },
        "helps": list(nominal.helps) if nominal else [],
        "velocity_offset_s": nominal.velocity_offset_s if nominal else None,
        "tuning": [dict(record) for record in nominal.tuning] if nominal else [],
        "lacks": dict(nominal.lacks) if nominal else {},
        "notes": list(nominal.notes) if nominal else [],
        "noise": outcomes[0].noise,
        "audit": [vars(row) for row in nominal.audit] if nominal else [],
        "mapping": facts.mapping,
        "known_limits": facts.limits_as_dicts(),
    }


def of_step(engine: str, at: AtStep) -> dict[str, Any]:
    """What run.json says more of a source where a run has several steps."""
    return {"engine": engine, "engine_step_s": at.nominal.world.engine_step_s}


def of_scenario_at(at: AtStep) -> dict[str, Any]:
    """What of the scenario depends on the step, where a run has several of them."""
    dumped = at.nominal.model_dump(mode="json")
    return {
        "at": at.label,
        "engine_step_s": at.nominal.world.engine_step_s,
        "step_s": at.nominal.world.step_s,
        "dither": dumped["dither"],
        "tolerances": dumped["tolerances"],
    }


def of_run(
    file: ScenarioFile,
    scenarios: Sequence[Scenario],
    truth: str | None,
    sources: list[dict[str, Any]],
    scores: Sequence[Score],
) -> dict[str, Any]:
    """What run.json says of the whole run, its sources and scores included."""
    nominal = scenarios[len(scenarios) // 2]
    dumped = nominal.model_dump(mode="json")
    return {
        "format": FORMAT,
        "run": None,
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "scenario": nominal.name,
        "title": nominal.title,
        "question": nominal.question,
        "parameters": dict(nominal.parameters),
        "parameter_texts": {name: p.text for name, p in file.parameters.items()},
        "step_s": nominal.world.step_s,
        "duration_s": nominal.world.duration_s,
        "repeats": len(scenarios),
        "dither": dumped["dither"],
        "seed": Settings().seed,
        "truth": truth,
        "probes": dumped["probes"],
        "axes": _axes(nominal),
        "has_joints": bool(nominal.joints),
        "tolerances": dumped["tolerances"],
        "answer": dumped["answer"],
        "scenario_sha256": _sha256_of((file.path, *file.extends)),
        "software": {
            "simcompare": installed_version("simcompare"),
            "python": platform.python_version(),
            "numpy": installed_version("numpy"),
        },
        "machine": {
            "system": platform.platform(),
            "processor": _processor(),
            "python_implementation": sys.implementation.name,
        },
        "sources": sources,
        "scores": [score.to_dict() for score in scores],
    }


def _axes(scenario: Scenario) -> dict[str, str]:
    """Series that are drawn over another one instead of over the event's number."""
    found = {}
    for measure in scenario.measures:
        for name, axis in measures.load(measure.function).AXES.items():
            found[measure.names.get(name, name)] = measure.names.get(axis, axis)
    return found


def of_measurement(
    file: ScenarioFile, table: BounceTable, found: Sequence[Match]
) -> dict[str, Any]:
    """What run.json says of the measurement that the engines were held against."""
    return {
        "file": table.path.name,
        "sha256": table.sha256,
        "head": dict(table.head),
        "parameters": dict(table.parameters),
        "caution": _caution(file, table),
        "matches": [match.to_dict() for match in found],
    }


def _caution(file: ScenarioFile, table: BounceTable) -> str | None:
    """Why agreement says less than it seems, where the preset was taken from the same table."""
    preset = file.presets.get(table.preset or "")
    if preset is None or table.path.stem not in preset.taken_from:
        return None
    return (
        f"The preset {table.preset} takes its value from this same table: agreement shows that the"
        " value was translated rightly, and validates nothing."
    )


def _sha256_of(paths: Sequence[Path]) -> str:
    """Digest of the scenario file, and of those that it extends."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()


def _median(values: Sequence[float]) -> float | None:
    return statistics.median(values) if values else None


def _processor() -> str:
    """Model name of the processor, as Linux tells it, else what Python knows."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
