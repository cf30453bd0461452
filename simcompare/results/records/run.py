"""What run.json says of a run, and of what every run, fit and validation has in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Annotated, Any, Literal

from pydantic import Field

from simcompare.comparison.ablation import Ablation
from simcompare.comparison.against import Match
from simcompare.comparison.comparison import Score
from simcompare.engine.backend import KnownLimit
from simcompare.model.answer import Answer
from simcompare.model.audit import AuditRow
from simcompare.model.drawing import DrawnBody, DrawnEye
from simcompare.model.parquet import Table
from simcompare.model.scenario import Dither, Probe, Tolerance
from simcompare.model.tuning import TuningRow
from simcompare.results.records.sensing import Sensing
from simcompare.running.jobs import OK

#: version of what is stored
FORMAT = 3


@dataclass(frozen=True)
class Wall:
    """Wall times of one simulation, ``None`` where they are not known [s].

    Engines run beside each other: this is no benchmark.
    """

    import_: Annotated[float | None, Field(alias="import")] = None
    build: float | None = None
    step: float | None = None


@dataclass(frozen=True, kw_only=True)
class SourceRecord:
    """One source at one contact level.

    Attributes:
        name: of the source: an engine, a variant, or either at one of several steps.
        contact: its contact level.
        status: "ok", "unsupported", "missing" or "failed".
        version: of the engine, ``None`` where it is not installed.
        reason: one sentence where the status is not "ok".
        out_of_reach: whether another step or value would make it possible.
        longest_step_s: longest step with which it could be done, where the step is at fault [s].
        steps: of one simulation.
        repeats: that ended well.
        wall_s: wall times of one simulation.
        helps: our helps that acted.
        velocity_offset_s: how much later than positions velocities are stored [s].
        tuning: how the numbers for restitution were found, one for each restitution.
        lacks: signals that the source does not give, and why.
        notes: in what the engine departs from what was asked.
        noise: what its process printed.
        audit: every physical value that was set, and read back.
        mapping: how the scenario's contact is translated.
        known_limits: of the engine.
        engine: the engine, where a run has several steps.
        engine_step_s: its step, where a run has several [s].
    """

    name: str
    contact: str
    status: str = OK
    version: str | None = None
    reason: str | None = None
    out_of_reach: bool = False
    longest_step_s: float | None = None
    steps: int | None = None
    repeats: int = 0
    wall_s: Wall = Wall()
    helps: tuple[str, ...] = ()
    velocity_offset_s: float | None = None
    tuning: tuple[TuningRow, ...] = ()
    lacks: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    noise: str = ""
    audit: tuple[AuditRow, ...] = ()
    mapping: str = ""
    known_limits: tuple[KnownLimit, ...] = ()
    engine: str | None = None
    engine_step_s: float | None = None

    @property
    def ran(self) -> bool:
        """Whether every simulation ended well."""
        return self.status == OK


@dataclass(frozen=True)
class StepRecord:
    """What of the scenario depends on the step, where a run has several of them.

    Attributes:
        at: what the step adds to the name of a source, "@2ms".
        engine_step_s: of the engine [s].
        step_s: between samples [s].
        dither: how repeats differ.
        tolerances: of what is measured.
    """

    at: str
    engine_step_s: float
    step_s: float
    dither: Dither | None
    tolerances: Mapping[str, Tolerance]


@dataclass(frozen=True)
class Measurement:
    """Measured bounces that engines were held against.

    Attributes:
        file: name of the table.
        sha256: its digest.
        head: what it says of itself.
        parameters: under which it was measured.
        caution: why agreement says less than it seems.
        matches: every measured value beside every source's.
    """

    file: str
    sha256: str
    head: Mapping[str, str]
    parameters: Mapping[str, Any]
    caution: str | None
    matches: tuple[Match, ...]


@dataclass(frozen=True)
class Software:
    """Versions of what is no engine."""

    simcompare: str | None
    python: str
    numpy: str | None


@dataclass(frozen=True)
class Machine:
    """Where it was computed."""

    system: str
    processor: str
    python_implementation: str


@dataclass(frozen=True, kw_only=True)
class Record:
    """What every run, fit and validation says.

    Attributes:
        kind: "run", "fit" or "validation".
        format: version of what is stored.
        run: the folder in which it is stored.
        created: date and time, ISO 8601.
        scenario: name of the scenario.
        title: of the scenario.
        question: that it asks.
        parameters: values of the nominal repeat.
        parameter_texts: what each parameter is.
        step_s: between samples [s].
        duration_s: simulated time [s].
        repeats: of each source.
        dither: how repeats differ.
        seed: of every random number.
        truth: source of the truth, ``None`` where there is none.
        probes: what is observed, the leading one first.
        scene: the bodies that can be seen, and how they are drawn.
        eyes: the sensors whose rays are drawn.
        axes: series that are drawn over another one: measure -> the measure of its x values.
        has_joints: whether the scenario has joints.
        tolerances: of what is measured.
        answer: the measure that leads the report.
        scenario_sha256: digest of the scenario file, and of those that it extends.
        software: versions.
        machine: where it was computed.
        sources: what became of every source.
        scores: every score.
        scenario_asked: the scenario as the user named it.
        engines_asked: the engines as the user named them.
        preset: named set of parameters.
        steps: what depends on the step, where there are several.
        assist: our helps, where not all of them were asked for.
        judge: levels whose failures count; ``None``: all of them.
        command: the command that repeats it, where it is no ``run``.
        interrupted: whether Ctrl-C ended it early.
        tables: what was written beside the record: name of the file -> its digest and rows.
    """

    kind: str = ""
    format: int = FORMAT
    run: str | None = None
    created: str
    scenario: str
    title: str
    question: str
    parameters: Mapping[str, float]
    parameter_texts: Mapping[str, str] = field(default_factory=dict)
    step_s: float
    duration_s: float
    repeats: int
    dither: Dither | None = None
    seed: int = 0
    truth: str | None = None
    probes: Mapping[str, Probe] = field(default_factory=dict)
    scene: Mapping[str, DrawnBody] = field(default_factory=dict)
    eyes: Mapping[str, DrawnEye] = field(default_factory=dict)
    axes: Mapping[str, str] = field(default_factory=dict)
    has_joints: bool = False
    tolerances: Mapping[str, Tolerance] = field(default_factory=dict)
    answer: Answer | None = None
    scenario_sha256: str = ""
    software: Software
    machine: Machine
    sources: tuple[SourceRecord, ...]
    scores: tuple[Score, ...]
    scenario_asked: str | None = None
    engines_asked: str = ""
    preset: str | None = None
    steps: tuple[StepRecord, ...] = ()
    assist: str | None = None
    judge: tuple[str, ...] | None = None
    command: tuple[str, ...] | None = None
    interrupted: bool = False
    tables: Mapping[str, Table] = field(default_factory=dict)

    @cached_property
    def whole(self) -> Mapping[tuple[str, str, str], Score]:
        """Scores of whole runs: (source, contact level, measure) -> score."""
        found = (score for score in self.scores if score.index is None)
        return {(score.source, score.contact, score.measure): score for score in found}

    @cached_property
    def in_events(self) -> frozenset[str]:
        """What is measured at each event, or at several instants."""
        return frozenset(score.measure for score in self.scores if score.index is not None)


@dataclass(frozen=True, kw_only=True)
class RunRecord(Record):
    """What run.json says of a run.

    Attributes:
        without: what each of our helps changes.
        against: the measurement that engines were held against.
        against_asked: the measurement as the user named it.
        fit_asked: the fit with which engines ran.
        cautions: what of a robot is left out, and where a fit is used outside of its
            range; each without a full stop.
        beyond: why the truth does not hold for these parameters, so that nothing is judged.
        sensing: sensors that are not ideal; no score is made of what they read.
    """

    kind: Literal["run"] = "run"
    without: tuple[Ablation, ...] = ()
    against: Measurement | None = None
    against_asked: str | None = None
    fit_asked: str | None = None
    cautions: tuple[str, ...] = ()
    beyond: tuple[str, ...] = ()
    sensing: Sensing | None = None
