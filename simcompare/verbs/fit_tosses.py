"""The verb ``fit`` for scenarios whose parameters are told by tosses of a cube."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from simcompare import units
from simcompare.comparison.comparison import INFO, Score
from simcompare.comparison.repeats import sample_step_s
from simcompare.engine import engines
from simcompare.engine.assist import ALL
from simcompare.errors import InputError, UnknownName
from simcompare.fitting.tosses import records
from simcompare.fitting.tosses.engines import How, fit_engines
from simcompare.fitting.tosses.replay import STEP_S, Replay
from simcompare.fitting.tosses.roles import roles_of
from simcompare.fitting.tosses.setup import prepare
from simcompare.fitting.tosses.tosses import Toss
from simcompare.model.trajectory import Trajectory
from simcompare.reports.fit import tosses as words
from simcompare.results import run_record
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_tosses import TossSource
from simcompare.results.run import Stored
from simcompare.running.runner import TIME_LIMIT_S, Progress
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import levels
from simcompare.verbs.request import FitRequest
from simcompare.verbs.result import Result

#: what the measured toss is stored under
MEASURED = "measured"
#: what ``--fix`` calls measured lengths over true ones
SCALE = "scale"


@dataclass(frozen=True)
class Given:
    """What the user takes as known.

    Attributes:
        values: parameters of the scenario.
        scale: measured lengths over true ones.
    """

    values: Mapping[str, float]
    scale: float


def fit_tosses(
    file: ScenarioFile,
    request: FitRequest,
    *,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Result:
    """Fits what makes a cube land as it was seen to land, engine by engine.

    Args:
        file: a scenario that is fitted by tosses.
        request: what the user asked for; where no recording is held out, a part of the tosses is
            drawn and fitted, and the others are predicted; without unknowns that are named, those
            that the scenario calls usual; all our helps where nothing is said.
        time_limit_s: longest time for one simulation [s].
        progress: called as simulations end.

    Returns:
        The run; ``record.fit`` holds what was found.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    given = given_of(file, request)
    chosen = engines.select(request.engine)
    helps = levels.chosen_helps(ALL if request.assist is None else request.assist, request.engine)
    roles = roles_of(file, given.values)
    step = request.step
    step_s = STEP_S if step is None else sample_step_s(file, roles.given, None, step)
    how = How(helps, step_s, time_limit_s=time_limit_s, progress=progress)
    setup = prepare(
        roles, list(map(str, request.recordings)), list(map(str, request.hold_out)),
        unknowns=request.unknowns, given=given.values, scale=given.scale, mapping=request.mapping,
    )  # fmt: skip
    found = fit_engines(roles, setup, chosen, how)
    scene = Replay(roles, setup.fitted[0], {}, step_s=step_s).scenario()
    fit = records.of_fit(roles, setup, found, given.values, how, scene)
    fit = replace(fit, sentences=tuple(words.sentences(fit)))
    record = run_record.of_run(
        FitRecord, file, [scene], None,
        [run_record.of_source(one.engine, FITTED, [one.outcome]) for one in found],
        [score for source in fit.sources for score in _scores(source)],
        fit=fit, engines_asked=request.engine, scenario_asked=request.scenario,
        recording_asked=tuple(map(str, request.recordings)), command=request.command(),
    )  # fmt: skip
    runs = [(one.engine, one.outcome.trajectory) for one in found]
    stored = [Stored(name, FITTED, 0, run) for name, run in runs if run]
    return Result(record, (_measured(setup.fitted[0], roles.body), *stored))


def _measured(toss: Toss, body: str) -> Stored:
    """The first toss that was fitted, as it was seen."""
    signals = {f"{body}.position_m": toss.position_m,
               f"{body}.orientation_wxyz": toss.orientation_wxyz}  # fmt: skip
    return Stored(MEASURED, "", 0, Trajectory(MEASURED, toss.time_s, signals))


def given_of(file: ScenarioFile, request: FitRequest) -> Given:
    """What the user takes as known: --preset, --set, and --fix, also of the scale.

    Raises:
        InputError: an option that tosses do not have, or a scale that is none.
        UnknownName: a preset or parameter that does not exist.
    """
    options = {"--prior": request.priors, "--model": request.model != "auto",
               "--u-time": request.u_time_s is not None}  # fmt: skip
    wrong = [option for option, value in options.items() if value]
    if wrong:
        raise InputError(
            ", ".join(wrong),
            [
                f"{file.name} is fitted by tosses, which this is not for; use --set for what is"
                " known"
            ],
        )
    preset, fixed = request.preset, request.fixed or {}
    if preset is not None and preset not in file.presets:
        raise UnknownName(f"preset of {file.name}", preset, file.presets)
    chosen = {} if preset is None else dict(file.presets[preset].set)
    others = {name: value for name, value in fixed.items() if name != SCALE}
    scale = units.to_si(fixed.get(SCALE, 1.0), "1", f"--fix {SCALE}")
    if not scale > 0:
        raise InputError("--fix", [f"{scale:g} is no {SCALE}; expected a number above 0"])
    values = {**file.read_settings(others, "--fix"), **file.read_settings(request.set or {})}
    return Given({**chosen, **values}, scale)


def _scores(source: TossSource) -> list[Score]:
    """What was found for one engine, as scores that are shown and not judged."""
    return [
        Score(source.name, FITTED, name, "", None, own.value, None, own.u, own.unit, 1, None, None,
              INFO)
        for name, own in source.parameters.items()
    ]  # fmt: skip
