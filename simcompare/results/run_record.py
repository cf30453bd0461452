"""What run.json says, gathered: versions, machine, and what every engine was given."""

from __future__ import annotations

import datetime
import hashlib
import math
import platform
import statistics
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from simcompare import measures
from simcompare.comparison.against import Match
from simcompare.comparison.comparison import Score
from simcompare.comparison.repeats import AtStep
from simcompare.engine.library import installed_version
from simcompare.hardware.recordings.bounce_table import BounceTable
from simcompare.model import drawing
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.results.records.run import (
    Machine,
    Measurement,
    Record,
    Software,
    SourceRecord,
    StepRecord,
    Wall,
)
from simcompare.running.jobs import OK, Outcome
from simcompare.scenarios.scenario_file import ScenarioFile

R = TypeVar("R", bound=Record)


def of_source(name: str, mode: str, outcomes: Sequence[Outcome]) -> SourceRecord:
    """What run.json says of one source in one contact level."""
    bad = [outcome for outcome in outcomes if outcome.status != OK]
    done = [outcome.trajectory for outcome in outcomes if outcome.trajectory is not None]
    facts = outcomes[0].facts
    found = SourceRecord(
        name=name,
        contact=mode,
        version=facts.version,
        repeats=len(done),
        wall_s=_wall([trajectory.wall_s for trajectory in done]),
        noise=outcomes[0].noise,
        mapping=facts.mapping,
        known_limits=facts.known_limits,
    )
    if bad:
        longest_s = bad[0].longest_step_s
        found = replace(
            found,
            status=bad[0].status,
            reason=bad[0].reason,
            out_of_reach=longest_s is not None,
            longest_step_s=longest_s if math.isfinite(longest_s or 0.0) else None,
        )
    if not done:
        return found
    nominal = done[len(done) // 2]
    return replace(
        found,
        steps=len(nominal.time_s) - 1,
        helps=tuple(nominal.helps),
        velocity_offset_s=nominal.velocity_offset_s,
        tuning=nominal.tuning,
        lacks=dict(nominal.lacks),
        notes=tuple(nominal.notes),
        audit=tuple(nominal.audit),
    )


def of_scenario_at(at: AtStep) -> StepRecord:
    """What of the scenario depends on the step, where a run has several of them."""
    scene = at.nominal
    return StepRecord(
        at.label, scene.world.engine_step_s, scene.world.step_s, scene.dither, scene.tolerances
    )


def of_run(
    kind: type[R],
    file: ScenarioFile,
    scenarios: Sequence[Scenario],
    truth: str | None,
    sources: Sequence[SourceRecord],
    scores: Sequence[Score],
    **more: Any,  # noqa: ANN401
) -> R:
    """What run.json says of the whole run, its sources and scores included.

    Args:
        kind: of a run, a fit or a validation.
        file: the scenario.
        scenarios: its repeats.
        truth: source of the truth.
        sources: what became of every source.
        scores: every score.
        more: the fields that only this kind has, and how it was asked for.
    """
    nominal = scenarios[len(scenarios) // 2]
    return kind(
        created=now(),
        scenario=nominal.name,
        title=nominal.title,
        question=nominal.question,
        parameters=dict(nominal.parameters),
        parameter_texts={name: p.text for name, p in file.parameters.items()},
        step_s=nominal.world.step_s,
        duration_s=nominal.world.duration_s,
        repeats=len(scenarios),
        dither=nominal.dither,
        seed=Settings().seed,
        truth=truth,
        probes=nominal.probes,
        scene=drawing.drawn(nominal),
        eyes=drawing.eyes(nominal),
        axes=_axes(nominal),
        has_joints=bool(nominal.joints),
        tolerances=nominal.tolerances,
        answer=nominal.answer,
        scenario_sha256=sha256_of(file),
        software=software(),
        machine=Machine(platform.platform(), _processor(), sys.implementation.name),
        sources=tuple(sources),
        scores=tuple(scores),
        **more,
    )


def _axes(scenario: Scenario) -> dict[str, str]:
    """Series that are drawn over another one instead of over the event's number."""
    found = {}
    for measure in scenario.measures:
        for name, axis in measures.load(measure.function).axes.items():
            found[measure.name_of(name)] = measure.name_of(axis)
    return found


def of_measurement(file: ScenarioFile, table: BounceTable, found: Sequence[Match]) -> Measurement:
    """What run.json says of the measurement that the engines were held against."""
    return Measurement(
        table.path.name, table.sha256, dict(table.head), dict(table.parameters),
        _caution(file, table), tuple(found),
    )  # fmt: skip


def _caution(file: ScenarioFile, table: BounceTable) -> str | None:
    """Why agreement says less than it seems, where the preset was taken from the same table."""
    preset = file.presets.get(table.preset or "")
    if preset is None or table.path.stem not in preset.taken_from:
        return None
    return (
        f"The preset {table.preset} takes its value from this same table: agreement shows that the"
        " value was translated rightly, and validates nothing."
    )


def sha256_of(file: ScenarioFile) -> str:
    """Digest of a scenario file, and of those that it extends."""
    paths = (file.path, *file.extends)
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()


def _wall(walls: Sequence[Mapping[str, float]]) -> Wall:
    """Of one simulation, like "steps"."""
    if not walls:
        return Wall()
    build, step = (
        statistics.median(wall.get(stage, 0.0) for wall in walls) for stage in ("build", "step")
    )
    return Wall(walls[0].get("import"), build, step)


def now() -> str:
    """Date and time, ISO 8601."""
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")


def software() -> Software:
    """Versions of what is no engine."""
    return Software(
        installed_version("simcompare"), platform.python_version(), installed_version("numpy")
    )


def _processor() -> str:
    """Model name of the processor, as Linux tells it, else what Python knows."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
