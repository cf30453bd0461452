"""The verb ``estimate``: what sensors tell of a motion, with its uncertainty, beside the truth."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from simcompare.arguments import checked
from simcompare.comparison.repeats import one_step_s
from simcompare.engine import engines
from simcompare.errors import InputError, UnknownName
from simcompare.estimation import estimators, measuring
from simcompare.estimation.estimate import Estimate, Given
from simcompare.estimation.estimators import Estimator
from simcompare.estimation.joint_angle_study import Feasibility
from simcompare.hardware.sensors.device import Device
from simcompare.model.estimate_plan import EstimatePlan
from simcompare.model.scenario import Scenario
from simcompare.model.settings import ASSISTED, CONTACT_LEVELS, Settings
from simcompare.results import result_file, store
from simcompare.results.records.estimation import SourceEstimate
from simcompare.running.jobs import Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs
from simcompare.scenarios import catalogue, robot_values
from simcompare.verbs import estimate_recorded, estimating
from simcompare.verbs import estimate_request as requests
from simcompare.verbs.estimate_request import EstimateRequest
from simcompare.verbs.estimated import Estimated
from simcompare.verbs.notebook_line import with_line

FILE = "estimate.json"
#: draws of the sensors beyond which nothing new is seen
MAX_DRAWS = 10_000


@dataclass(frozen=True)
class _Asked:
    """All that is estimated, by whom and how often; the same devices measure every engine."""

    scenario: Scenario
    estimator: Estimator
    plan: EstimatePlan
    devices: tuple[Mapping[str, Device], ...]
    draws: int
    seed: int
    chips: tuple[str, ...] = ()


@checked
@with_line
def estimate(
    scenario: str | Path,
    *,
    recording: str | Path | None = None,
    mapping: str | Path | None = None,
    estimator: str | None = None,
    engine: str | Sequence[str] = "all",
    contact: str = ASSISTED,
    sensors: str | Mapping[str, str] | None = None,
    options: Mapping[str, str | float] | None = None,
    set: Mapping[str, str | float] | None = None,
    robot: str | Path | None = None,
    preset: str | None = None,
    step: str | float | None = None,
    draws: int = 40,
    seed: int = 0,
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Estimated:
    """Filters what sensors tell of a motion: of each engine's, or of a recorded one.

    ::

        found = simcompare.estimate("robot_motor", engine="mujoco", sensors="imu=mpu6050")
        found.table()
        found.plot()
        simcompare.estimate("odometry", recording="robot_labyrinth_exchanged")

    Args:
        scenario: name, folder or file; its ``estimate:`` says what is measured.
        recording: a public data set, the folder of an imported recording, or a log; then nothing is
            simulated.
        mapping: mapping file, whose ``estimate:`` says which channel is what.
        estimator: one of those that the scenario names there; the first where ``None``.
        engine: "all", names with commas or a list of names.
        contact: contact level.
        sensors: data sheets, such as "imu=mpu6050"; the scenario's own where left out. For the
            joint's angle also chips to compare, such as "adxl345,mpu6050".
        options: numbers of the estimator that differ, such as ``{"bias": 0}``.
        set: parameters that differ from the file; text may carry a unit.
        robot: file of a robot (``simcompare robot --template``), applied before ``set``.
        preset: named set of parameters, applied first.
        step: the engine's step, "1ms" or in seconds.
        draws: how often each motion is measured, each time with other devices and other noise.
        seed: of the draws.
        out: folder for the folder of the results; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as ``progress(engine, done, total)``.

    Returns:
        What was estimated, and how far it is from the truth.

    Raises:
        SimcompareError: faults of the arguments or of a file, or nowhere to store the results.
    """
    scenario, engine = str(scenario), engines.listed(engine)
    if recording is not None:
        if sensors:
            raise InputError("--sensors", ["a recording has sensors of its own; leave this out"])
        of_runs = {"--set": set, "--robot": robot, "--preset": preset, "--step": step}
        faults = [
            f"{name} is of a simulation, and a recording has none; leave it out"
            for name, value in of_runs.items()
            if value
        ]
        if faults:
            raise InputError("estimate", faults)
        request = EstimateRequest(
            scenario=scenario, recording=str(recording), mapping=mapping, estimator=estimator,
            options=options,
        )  # fmt: skip
        return _stored(estimate_recorded.estimated(request), out)
    if mapping is not None:
        raise InputError("--map", ["says what a recording cannot; give one with --recording"])
    if contact not in CONTACT_LEVELS:
        raise UnknownName("contact level", contact, CONTACT_LEVELS)
    chosen = engines.select(engine)
    taken = robot_values.taken(catalogue.load(scenario), robot)
    file = taken.file
    step_s = None if step is None else one_step_s(step)
    values = {**taken.values, **file.read_settings(set or {})}
    scene = file.resolve(values, preset=preset, step_s=step_s)
    chips, sensors = requests.chips_of(sensors)
    asked = _asked(scene, estimator, requests.sheets_of(sensors), options or {}, draws, seed)
    asked = replace(asked, chips=_chips(asked.estimator, chips))
    if out is not None:
        store.check_writable(Path(out))
    jobs = [Job(name, scene, Settings(contact)) for name in chosen]
    outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    request = EstimateRequest(
        scenario=scenario, engine=engine, contact=contact, estimator=estimator, set=set,
        robot=robot, preset=preset, step=step, options=options, draws=draws, seed=seed,
        sensors=(*chips, *(f"{k}={v}" for k, v in requests.sheets_of(sensors).items())),
    )  # fmt: skip
    sources = tuple(_of_engine(asked, outcome) for outcome in outcomes)
    found = estimating.estimated(
        request, asked.estimator, asked.plan, sources, title=scene.title, scenario=scene.name,
        draws=draws, seed=seed, sensors=asked.plan.sensors, engines_asked=request.engine,
    )  # fmt: skip
    cautions = (f"Caution: {caution}." for caution in taken.left_out)
    return _stored(replace(found, sentences=(*found.sentences, *cautions)), out)


def _asked(
    scene: Scenario,
    estimator: str | None,
    sheets: Mapping[str, str],
    options: Mapping[str, str | float],
    draws: int,
    seed: int,
) -> _Asked:
    if not 1 <= draws <= MAX_DRAWS:
        raise InputError("--draws", [f"{draws} is no number of draws; expected 1 to {MAX_DRAWS}"])
    if seed < 0:
        raise InputError("--seed", [f"{seed} is below 0; expected 0 or more"])
    found, plan = requests.plan_of(scene, estimator)
    plan = requests.with_sheets(plan, sheets, scene)
    numbers = requests.options_of(found, plan.options, options)
    plan = plan.model_copy(update={"options": numbers})
    devices = tuple(measuring.devices_of(scene, plan, one) for one in _seeds(draws, seed))
    return _Asked(scene, found, plan, devices, draws, seed)


def _seeds(draws: int, seed: int) -> list[int]:
    """One for each draw; other seeds of the user give others."""
    return [seed * MAX_DRAWS + number for number in range(draws)]


def _of_engine(asked: _Asked, outcome: Outcome) -> SourceEstimate:
    """What was estimated of the motion of one engine, over all draws."""
    name, version = outcome.job.engine, outcome.facts.version
    if outcome.trajectory is None:
        return SourceEstimate(name, version, outcome.status, outcome.reason)
    draws: list[Estimate] = []
    seeds = _seeds(asked.draws, asked.seed)
    for seed, devices in zip(seeds, asked.devices, strict=True):
        given = measuring.given_of(asked.scenario, asked.plan, outcome.trajectory, devices, seed)
        given = replace(given, options=asked.estimator.as_told(given.options, seed))
        draws.append(estimators.apply(asked.estimator, given))
    found = estimating.of_source(name, version, draws)
    ideal = measuring.given_of(asked.scenario, asked.plan, outcome.trajectory, {}, asked.seed)
    return replace(
        found,
        notes=(*outcome.trajectory.notes, *found.notes),
        chips=_study(asked.estimator, ideal, asked.chips, asked.draws, asked.seed),
    )


def _stored(found: Estimated, out: str | Path | None) -> Estimated:
    name = f"{found.scenario}-{found.estimator}"
    return found if out is None else result_file.save(found, Path(out), name, FILE)


def _chips(estimator: Estimator, asked: tuple[str, ...]) -> tuple[str, ...]:
    """The chips that are asked for; all that can serve where none is.

    Raises:
        InputError: this estimator has no study of chips.
    """
    if estimator.study:
        return asked or tuple(_module(estimator).with_accelerometer())
    if asked:
        fault = f"{asked[0]!r} is not of the form sensor=sheet, such as imu={asked[0]}"
        raise InputError("--sensors", [fault])
    return ()


def _study(
    estimator: Estimator, ideal: Given, chips: tuple[str, ...], pairs: int, seed: int
) -> tuple[Feasibility, ...]:
    """What that many drawn pairs of devices of each chip would tell of one motion."""
    if not estimator.study:
        return ()
    found: tuple[Feasibility, ...] = _module(estimator).of_given(
        ideal, chips, pairs=pairs, seed=seed
    )
    return found


def _module(estimator: Estimator) -> Any:  # noqa: ANN401
    return importlib.import_module(f"simcompare.estimation.{estimator.study}")
