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
from simcompare.errors import InputError, OutputError, UnknownName
from simcompare.jobs import FAILED, MISSING, OK, Job, Outcome
from simcompare.runner import TIME_LIMIT_S, Interrupted, Progress, run_jobs
from simcompare.scenario import Scenario
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
    given = {**(dict(table.parameters) if table else {}), **(set or {})}
    values = file.read_settings(given)
    preset = preset or (table.preset if table else None)
    step_s = None if step is None else units.to_si(step, "s", "--step")
    if step_s is not None:
        _check_step(file.resolve(values, preset=preset), step_s)
    if seeds is not None and seeds < 1:
        raise InputError("--seeds", [f"{seeds} is not a number of repeats; expected 1 or more"])
    scenarios = repeats_of(file, values, preset, step_s, seeds)
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
    done = _gather(file, scenarios, outcomes, table)
    done.record.update(engines_asked=engine, preset=preset, interrupted=interrupted)
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
    """
    nominal = file.resolve(values, preset=preset, step_s=step_s)
    dither = nominal.dither
    if dither is None:
        return [nominal]
    count = dither.count if count is None else count
    centre = nominal.parameters[dither.parameter]
    # all repeats last as long as the nominal one, so that their samples line up
    found = []
    for i in range(count):
        shifted = centre + (i - (count - 1) / 2) / count * dither.span
        if i == (count - 1) / 2:
            found.append(nominal)
            continue
        scenario = file.resolve({**values, dither.parameter: shifted}, preset=preset, step_s=step_s)
        world = scenario.world.model_copy(update={"duration_s": nominal.world.duration_s})
        found.append(scenario.model_copy(update={"world": world}))
    return found


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
    longest = scenario.world.duration_s / LEAST_SAMPLES
    if step_s > longest:
        raise InputError(
            "--step",
            [
                f"{step_s:g} s leaves {scenario.world.duration_s / step_s:.0f} samples in"
                f" {scenario.world.duration_s:.3g} s; use at most {longest:.2g} s"
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
    scenarios: Sequence[Scenario],
    outcomes: Sequence[Outcome],
    table: BounceTable | None,
) -> _Gathered:
    truths = _truths(file.path, scenarios)
    scores: list[Score] = []
    trajectories: list[Stored] = []
    sources = []
    by_source: dict[tuple[str, str], list[Outcome]] = {}
    for outcome in outcomes:
        by_source.setdefault((outcome.job.engine, outcome.job.settings.contact), []).append(outcome)
    for (engine, mode), own in by_source.items():
        good = [outcome for outcome in own if outcome.status == OK]
        if len(good) == len(own):
            repeats = [
                Repeat(scenarios[o.job.repeat], o.trajectory, truths[o.job.repeat])
                for o in own
                if o.trajectory is not None
            ]
            scores += scores_of(repeats)
        trajectories += [
            Stored(engine, mode, o.job.repeat, o.trajectory) for o in good if o.trajectory
        ]
        sources.append(_source_record(engine, mode, own))
    for i, truth in enumerate(truths):
        if truth is not None:
            trajectories.append(Stored(TRUTH, "", i, truth))
    found: list[Match] = []
    if table is not None:
        found = matches(table, scores, _measured_units(scenarios[0]))
    record = _record(file, scenarios, sources, scores)
    record["against"] = _against_record(table, found) if table is not None else None
    return _Gathered(record, scores, trajectories)


def _truths(path: Path, scenarios: Sequence[Scenario]) -> list[Trajectory | None]:
    from simcompare.simulation import sample_times

    reference = catalogue.reference_of(path)
    found: list[Trajectory | None] = []
    for scenario in scenarios:
        if reference is None:
            found.append(None)
            continue
        times = sample_times(scenario)
        found.append(Trajectory(TRUTH, times, reference(scenario.parameters, times)))
    return found


def _source_record(engine: str, mode: str, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """What run.json says of one engine in one contact mode."""
    bad = [outcome for outcome in outcomes if outcome.status != OK]
    done = [outcome.trajectory for outcome in outcomes if outcome.trajectory is not None]
    nominal = done[len(done) // 2] if done else None
    walls = [trajectory.wall_s for trajectory in done]
    facts = _backend_facts(engine)
    return {
        "name": engine,
        "version": nominal.version if nominal else facts["version"],
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
        "mapping": facts["mapping"],
        "known_limits": facts["known_limits"],
    }


def _backend_facts(engine: str) -> dict[str, Any]:
    """Version, mapping and limits that a backend states; empty where it cannot be loaded."""
    from simcompare.errors import SimcompareError

    try:
        backend = engines.get(engine)
    except SimcompareError:
        return {"version": None, "mapping": "", "known_limits": []}
    try:
        version: str | None = backend.version()
    except SimcompareError:
        version = None
    limits = [{"text": limit.text, "reference": limit.reference} for limit in backend.known_limits]
    return {"version": version, "mapping": backend.mapping, "known_limits": limits}


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
