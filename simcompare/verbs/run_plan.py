"""What a run is to do, worked out from what it was asked before anything is simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from simcompare import measures
from simcompare.comparison import ablation
from simcompare.comparison.repeats import AtStep, at_steps, sample_steps_s
from simcompare.engine import by_hand, engines
from simcompare.engine.by_hand import ByHand
from simcompare.errors import InputError
from simcompare.hardware.recordings import bounce_table
from simcompare.hardware.recordings.bounce_table import BounceTable
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, BY_HAND, CONTACT_LEVELS, Settings
from simcompare.results.asked_sensors import Drawn, asked_devices
from simcompare.running.jobs import Job, Outcome
from simcompare.scenarios import catalogue, robot_values
from simcompare.scenarios.robot_values import Taken
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import levels
from simcompare.verbs.request import RunRequest

if TYPE_CHECKING:
    from simcompare.results.fit_file import FitFile


@dataclass(frozen=True, eq=False)
class RunPlan:
    """All that a run does, and with what.

    Attributes:
        request: what it was asked.
        taken: the scenario, and what it takes of a robot.
        table: of measured bounces, ``None`` without one.
        fit: whose parameters engines run with, ``None`` without one.
        helps: our helps in "assisted"; ``None``: all that an engine takes.
        judged: levels whose failures count.
        preset: named set of parameters, also where the table names it.
        steps: the scenario at each step.
        devices: sensors that are not ideal.
        jobs: the simulations.
        refused: those that the fit knows nothing for.
    """

    request: RunRequest
    taken: Taken
    table: BounceTable | None
    fit: FitFile | None
    helps: frozenset[str] | None
    judged: list[str]
    preset: str | None
    steps: Sequence[AtStep]
    devices: Sequence[Drawn]
    jobs: Sequence[Job]
    refused: Sequence[Outcome]

    @property
    def file(self) -> ScenarioFile:
        """The scenario."""
        return self.taken.file

    @property
    def cautions(self) -> tuple[str, ...]:
        """What of the robot is left out, and where a fit is used outside of its range."""
        found = list(self.taken.left_out)
        if self.fit is not None:
            found += [one for at in self.steps for one in self.fit.cautions(at.nominal, self.file)]
        return tuple(dict.fromkeys(found))


def planned(request: RunRequest, *, trust: bool = False) -> RunPlan:
    """What is to be done.

    Args:
        request: what was asked.
        trust: run the Python files beside the scenario, where it comes from elsewhere.

    Raises:
        SimcompareError: faults of what was asked, or of a file.
    """
    engine = request.engine
    chosen = engines.select(engine)
    modes, fit = levels.chosen_levels(request.contact, by_hand=bool(request.own))
    helps = levels.chosen_helps(request.assist, engine)
    levels.check_used(modes, helps, request.judge)
    judged = levels.judged_levels(request.judge, fit)
    file = catalogue.load(request.scenario, trust=trust)
    table = _table(file, request.against)
    taken = robot_values.taken(file, request.robot)
    file = taken.file
    values = {
        **({} if fit is None else fit.base(file)),
        **taken.values,
        **file.read_settings(request.set or {}),
    }
    preset = request.preset
    if table is not None:
        values, preset = with_conditions(file, table, values, preset)
    steps_s = sample_steps_s(file, values, preset, request.step)
    _check_repeats(file, values, preset, request.seeds)
    usual_s = None if fit is None else fit.usual_step_s
    sources = len(chosen) * len(modes)
    steps = at_steps(file, values, preset, steps_s or [usual_s], request.seeds, sources)
    own = by_hand.read(request.own or {}, chosen, steps[0].nominal)
    devices = asked_devices(steps[0].nominal, request.sensor or {}, request.seed)
    jobs = [
        job
        for name in chosen
        for mode in modes
        for at in steps
        for job in _jobs(file, name, mode, at, fit, helps, own)
    ]
    refused = [] if fit is None else levels.not_in_fit(jobs, fit, file)
    unfitted = {id(outcome.job) for outcome in refused}
    jobs = [job for job in jobs if id(job) not in unfitted]
    return RunPlan(
        request, taken, table, fit, helps, judged, preset, steps, devices, jobs, refused
    )  # fmt: skip


def _check_repeats(
    file: ScenarioFile, values: Mapping[str, float], preset: str | None, seeds: int | None
) -> None:
    if seeds is not None and seeds < 1:
        raise InputError("--seeds", [f"{seeds} is not a number of repeats; expected 1 or more"])
    if seeds is not None and file.resolve(values, preset=preset).dither is None:
        raise InputError("--seeds", [f"{file.name} has nothing that is dithered between repeats"])


def with_conditions(
    file: ScenarioFile, table: BounceTable, values: Mapping[str, float], preset: str | None
) -> tuple[dict[str, float], str | None]:
    """Parameters and preset under which a table was measured, with what the user adds.

    Raises:
        InputError: the user, or the table, asks for another scenario, preset or condition.
    """
    measured = file.read_settings(table.parameters, str(table.path))
    faults = [
        f"{name} = {values[name]:g} is asked for, but the table was measured at {value:g}"
        for name, value in measured.items()
        if name in values and values[name] != value
    ]
    if preset is not None and table.preset is not None and preset != table.preset:
        faults.append(f"preset {preset} is asked for, but the table is of {table.preset}")
    scenario = table.head.get("scenario", file.name)
    if scenario != file.name:
        faults.append(f"the table is of the scenario {scenario}, not of {file.name}")
    if faults:
        raise InputError(f"--against {table.path.name}", faults)
    return {**measured, **values}, preset or table.preset


def _jobs(
    file: ScenarioFile,
    engine: str,
    mode: str,
    at: AtStep,
    fit: FitFile | None,
    helps: frozenset[str] | None,
    own: ByHand,
) -> list[Job]:
    """One job for each repeat; a fitted engine is given its own parameters.

    By hand, engines run that were given values.

    Assisted, the nominal repeat is run once more without each of the helps that act in it.
    """
    if mode == BY_HAND:
        typed = [(i, s, own.settings(engine, s)) for i, s in enumerate(at.scenarios)]
        return [Job(engine, s, how, i, mode, at=at.label) for i, s, how in typed if how]
    if fit is None or mode in CONTACT_LEVELS:
        settings = Settings(mode, helps=helps, drops=at.drops)
        jobs = [
            Job(engine, scene, settings, i, at=at.label) for i, scene in enumerate(at.scenarios)
        ]
        if mode == ASSISTED:
            jobs += ablation.jobs_of(engine, at, settings)
        return jobs
    fitted_jobs = []
    fitted = fit.settings(engine, at.nominal)
    for i, scene in enumerate(at.scenarios):
        for name, value in (fit.of_engine(engine, file) or {}).items():
            scene = file.vary(scene, name, value)
        fitted_jobs.append(Job(engine, scene, fitted, i, mode, at=at.label))
    return fitted_jobs


def _table(file: ScenarioFile, against: str | Path | None) -> BounceTable | None:
    if against is None:
        return None
    return bounce_table.read(bounce_table.find(str(against)), measured_units(file.resolve()))


def measured_units(scenario: Scenario) -> dict[str, str]:
    """Per-event quantities of a scenario's measures and their units."""
    by_name: dict[str, str] = {}
    for measure in scenario.measures:
        units = measures.units_of(measure, scenario)
        for name in measures.load(measure.function).series:
            by_name[measure.name_of(name)] = units[name]
    return by_name
