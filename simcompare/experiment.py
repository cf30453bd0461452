"""The verb ``run``: a scenario through engines, held against the truth and against measurements."""

from __future__ import annotations

import datetime
import hashlib
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simcompare import catalogue, engines, measures, units
from simcompare.against import Match, matches
from simcompare.backend import CONTACT_MODES, Settings, installed_version
from simcompare.compare import FAIL, Repeat, Score, scores_of
from simcompare.errors import InputError, OutputError, SimcompareError, UnknownName
from simcompare.jobs import FAILED, MISSING, OK, Job, Outcome
from simcompare.runner import TIME_LIMIT_S, Interrupted, Progress, run_jobs
from simcompare.scenario import MOST_SAMPLES, Scenario
from simcompare.simulation import sample_times
from simcompare.trajectory import Trajectory

if TYPE_CHECKING:
    from simcompare.hardware.logs.bounce_table import BounceTable
    from simcompare.scenario_file import ScenarioFile

TRUTH = "closed form"
FORMAT = 1
#: samples below which a run shows nothing
LEAST_SAMPLES = 100


@dataclass(frozen=True)
class Stored:
    """One trajectory of a run with its place in it."""

    source: str
    contact: str
    repeat: int
    trajectory: Trajectory


@dataclass(frozen=True)
class Run:
    """Everything that one ``run`` found.

    Attributes:
        record: what run.json holds; plain values.
        scores: every score.
        trajectories: every trajectory that came out, the truth's included.
        folder: where it is stored, ``None`` where it is not.
        interrupted: whether Ctrl-C ended it early.
    """

    record: Mapping[str, Any]
    scores: tuple[Score, ...]
    trajectories: tuple[Stored, ...]
    folder: Path | None = None
    interrupted: bool = False

    @property
    def exit_code(self) -> int:
        """0 fine, 1 a tolerance failed, 3 an engine is broken or none of those asked for ran.

        With ``all``, an engine that is not installed is a row with its reason and no failure.
        """
        statuses = {source["status"] for source in self.record["sources"]}
        named = self.record["engines_asked"] != "all"
        if FAILED in statuses or OK not in statuses or (named and MISSING in statuses):
            return 3
        return 1 if any(score.verdict == FAIL for score in self.scores) else 0


def run(
    scenario: str = "ball",
    *,
    engine: str = "all",
    contact: str | Sequence[str] = CONTACT_MODES,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    step: str | float | None = None,
    seeds: int | None = None,
    against: str | Path | None = None,
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Run:
    """Simulates a scenario on engines and compares the results.

    Args:
        scenario: name, folder or file.
        engine: ``"all"`` or names with commas.
        contact: contact modes, a list or a text with commas.
        set: parameters that differ from the file; text may carry a unit ("30cm").
        preset: named set of parameters, applied first.
        step: time between samples, "1ms" or in seconds.
        seeds: number of dithered repeats; the scenario's own where ``None``.
        against: table of measured bounces: a file or the name of a published one.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        The run; a run that Ctrl-C ended is marked so and keeps what had finished.

    Raises:
        SimcompareError: faults of the arguments or of a file, or nowhere to store the run.
    """
    chosen = engines.select(engine)
    modes = _modes(contact)
    file = catalogue.load(scenario)
    table = _table(file, against)
    values = file.read_settings(table.parameters, str(table.path)) if table else {}
    values |= file.read_settings(set or {})
    preset = preset or (table.preset if table else None)
    step_s = None if step is None else units.to_si(step, "s", "--step")
    if step_s is not None:
        _check_step(file.resolve(values, preset=preset), step_s)
    if seeds is not None and seeds < 1:
        raise InputError("--seeds", [f"{seeds} is not a number of repeats; expected 1 or more"])
    scenarios = repeats_of(file, values, preset, step_s, seeds)
    truths = truths_of(file.path, scenarios)
    if out is not None:
        check_writable(Path(out))
    jobs = [
        Job(name, scenarios[i], Settings(mode), i)
        for name in chosen
        for mode in modes
        for i in range(len(scenarios))
    ]
    interrupted = False
    try:
        outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    except Interrupted as stop:
        outcomes, interrupted = stop.outcomes, True
    done = _gather(file, (scenarios, truths), outcomes, table)
    done.record.update(
        engines_asked=engine,
        scenario_asked=scenario,
        against_asked=None if against is None else str(against),
        preset=preset,
        interrupted=interrupted,
    )
    result = Run(done.record, tuple(done.scores), tuple(done.trajectories), None, interrupted)
    if out is None:
        return result
    from simcompare import store

    return store.save(result, Path(out))


def repeats_of(
    file: ScenarioFile,
    values: Mapping[str, float],
    preset: str | None,
    step_s: float | None,
    count: int | None,
) -> list[Scenario]:
    """The scenario once for every dithered repeat, the nominal one in the middle.

    The dithered parameter takes the values p + (i - (n-1)/2)/n · span for i = 0 … n-1.

    Raises:
        InputError: values out of bounds, or a step so long that the spread leaves what makes sense.
    """
    nominal = file.resolve(values, preset=preset, step_s=step_s)
    dither = nominal.dither
    if dither is None:
        return [nominal]
    count = dither.count if count is None else count
    centre = nominal.parameters[dither.parameter]
    if dither.span >= 2 * centre and file.parameters[dither.parameter].min >= 0:
        raise InputError(
            "--step",
            [
                f"{nominal.world.step_s:g} s spreads {dither.parameter} by {dither.span:.3g}"
                f" about {centre:.3g}, below 0; use a shorter step"
            ],
        )
    offsets = [(i - (count - 1) / 2) / count * dither.span for i in range(count)]
    return [
        file.vary(nominal, dither.parameter, centre + offset) if offset else nominal
        for offset in offsets
    ]


def check_writable(folder: Path) -> None:
    """Makes the output folder and proves that it can be written to, before anything is simulated.

    Raises:
        OutputError: it cannot.
    """
    probe = folder / ".simcompare-write-test"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise OutputError(
            f"--out {folder}: cannot be written to ({error.strerror}); choose another folder"
        ) from None


def _check_step(scenario: Scenario, step_s: float) -> None:
    if step_s <= 0:
        raise InputError("--step", [f"{step_s:g} s is not a time above 0"])
    duration = scenario.world.duration_s
    shortest, longest = duration / MOST_SAMPLES, duration / LEAST_SAMPLES
    if not shortest <= step_s <= longest:
        raise InputError(
            "--step",
            [
                f"{step_s:g} s gives {duration / step_s:.3g} samples in {duration:.3g} s;"
                f" use {shortest:.2g} s to {longest:.2g} s"
            ],
        )


def _modes(contact: str | Sequence[str]) -> list[str]:
    modes = [part.strip() for part in contact.split(",")] if isinstance(contact, str) else contact
    for mode in modes:
        if mode not in CONTACT_MODES:
            raise UnknownName("contact mode", mode, CONTACT_MODES)
    return list(dict.fromkeys(modes))


def _table(file: ScenarioFile, against: str | Path | None) -> BounceTable | None:
    if against is None:
        return None
    from simcompare.hardware.logs import bounce_table

    return bounce_table.read(bounce_table.find(str(against)), _measured_units(file.resolve()))


def _measured_units(scenario: Scenario) -> dict[str, str]:
    """Per-event quantities of a scenario's measures and their units."""
    found: dict[str, str] = {}
    for measure in scenario.measures:
        module = measures.load(measure.function)
        found.update({name: module.UNITS[name] for name in module.SERIES})
    return found


@dataclass
class _Gathered:
    record: dict[str, Any]
    scores: list[Score]
    trajectories: list[Stored]


def _gather(
    file: ScenarioFile,
    planned: tuple[Sequence[Scenario], Sequence[Trajectory | None]],
    outcomes: Sequence[Outcome],
    table: BounceTable | None,
) -> _Gathered:
    scenarios, truths = planned
    scores: list[Score] = []
    trajectories: list[Stored] = []
    sources = []
    by_source: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in outcomes:
        by_source.setdefault((outcome.job.engine, outcome.job.settings.contact), []).append(outcome)
    for (engine, mode), own in by_source.items():
        good = [outcome for outcome in own if outcome.status == OK]
        record = _source_record(engine, mode, own)
        if len(good) == len(own):
            repeats = [
                Repeat(scenarios[o.job.repeat], o.trajectory, truths[o.job.repeat])
                for o in own
                if o.trajectory is not None
            ]
            try:
                scores += scores_of(repeats)
            except SimcompareError as error:  # this source lacks a signal; the others have it
                record.update(status=FAILED, reason=str(error))
        trajectories += [
            Stored(engine, mode, o.job.repeat, o.trajectory) for o in good if o.trajectory
        ]
        sources.append(record)
    for i, truth in enumerate(truths):
        if truth is not None:
            trajectories.append(Stored(TRUTH, "", i, truth))
    found: list[Match] = []
    if table is not None:
        found = matches(table, scores, _measured_units(scenarios[0]))
    record = _record(file, scenarios, sources, scores)
    record["against"] = _against_record(table, found) if table is not None else None
    return _Gathered(record, scores, trajectories)


def truths_of(path: Path, scenarios: Sequence[Scenario]) -> list[Trajectory | None]:
    """The truth of every repeat, ``None`` where the scenario has no reference.

    Raises:
        InputError: the reference fails or returns what cannot be a truth.
    """
    reference = catalogue.reference_of(path)
    if reference is None:
        return [None] * len(scenarios)
    try:
        return [_truth(reference, scenario) for scenario in scenarios]
    # a user's own code may raise anything, also SystemExit
    except (Exception, SystemExit) as error:
        where = str(path.with_name("reference.py"))
        message = f"reference() failed: {type(error).__name__}: {error}"
        raise InputError(where, [message]) from error


def _truth(reference: catalogue.Reference, scenario: Scenario) -> Trajectory:
    times = sample_times(scenario)
    truth = Trajectory(TRUTH, times, reference(scenario.parameters, times))
    for measure in scenario.measures:
        measures.observe(truth, scenario.probes[measure.probe])
    return truth


def _source_record(engine: str, mode: str, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """What run.json says of one engine in one contact mode."""
    bad = [outcome for outcome in outcomes if outcome.status != OK]
    done = [outcome.trajectory for outcome in outcomes if outcome.trajectory is not None]
    nominal = done[len(done) // 2] if done else None
    walls = [trajectory.wall_s for trajectory in done]
    facts = outcomes[0].facts
    return {
        "name": engine,
        "version": facts.version,
        "contact": mode,
        "status": bad[0].status if bad else OK,
        "reason": bad[0].reason if bad else None,
        "steps": len(nominal.time_s) - 1 if nominal else None,
        "repeats": len(done),
        "wall_s": {
            "import": walls[0]["import"] if walls and "import" in walls[0] else None,
            "build": sum(wall.get("build", 0.0) for wall in walls),
            "step": sum(wall.get("step", 0.0) for wall in walls),
        },
        "notes": list(nominal.notes) if nominal else [],
        "noise": outcomes[0].noise,
        "audit": [vars(row) for row in nominal.audit] if nominal else [],
        "mapping": facts.mapping,
        "known_limits": facts.limits_as_dicts(),
    }


def _record(
    file: ScenarioFile,
    scenarios: Sequence[Scenario],
    sources: list[dict[str, Any]],
    scores: Sequence[Score],
) -> dict[str, Any]:
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
        "seed": 0,
        "truth": TRUTH if catalogue.reference_of(file.path) else None,
        "probes": dumped["probes"],
        "tolerances": dumped["tolerances"],
        "scenario_sha256": hashlib.sha256(file.path.read_bytes()).hexdigest(),
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


def _against_record(table: BounceTable, found: Sequence[Match]) -> dict[str, Any]:
    return {
        "file": table.path.name,
        "sha256": table.sha256,
        "head": dict(table.head),
        "parameters": dict(table.parameters),
        "matches": [match.to_dict() for match in found],
    }


def _processor() -> str:
    """Model name of the processor, as Linux tells it, else what Python knows."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()
