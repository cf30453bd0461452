"""The verb ``fit`` for scenarios whose parameters are told by tosses of a cube."""

from __future__ import annotations

from dataclasses import replace

from simcompare import units
from simcompare.comparison.repeats import sample_step_s
from simcompare.engine import engines
from simcompare.engine.assist import ALL
from simcompare.errors import InputError
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
from simcompare.results.run import Stored
from simcompare.running.runner import Progress
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import levels
from simcompare.verbs.fitted import MEASURED, check_options, known, of_bounces, record_of, score
from simcompare.verbs.request import FitRequest
from simcompare.verbs.result import Result

#: what ``--fix`` calls measured lengths over true ones
SCALE = "scale"


def fit_tosses(
    file: ScenarioFile, request: FitRequest, time_limit_s: float, progress: Progress | None
) -> Result:
    """Fits what makes a cube land as it was seen to land, engine by engine.

    Where no recording is held out, a part of the tosses is drawn and fitted, and the others are
    predicted. Without unknowns that are named, those are sought that the scenario calls usual. All
    our helps are taken where the request names none.
    """
    scale = _scale_of(file, request)
    given = known(file, request, apart=(SCALE,))
    chosen = engines.select(request.engine)
    helps = levels.chosen_helps(ALL if request.assist is None else request.assist, request.engine)
    roles = roles_of(file, given)
    step = request.step
    step_s = STEP_S if step is None else sample_step_s(file, roles.given, None, step)
    how = How(helps, step_s, time_limit_s=time_limit_s, progress=progress)
    setup = prepare(
        roles, list(map(str, request.recordings)), list(map(str, request.hold_out)),
        unknowns=request.unknowns, given=given, scale=scale, mapping=request.mapping,
    )  # fmt: skip
    found = fit_engines(roles, setup, chosen, how)
    scene = Replay(roles, setup.fitted[0], {}, step_s=step_s).scenario()
    fit = records.of_fit(roles, setup, found, given, how, scene)
    fit = replace(fit, sentences=tuple(words.sentences(fit)))
    sources = [run_record.of_source(one.engine, FITTED, [one.outcome]) for one in found]
    scores = [score(one.name, *row) for one in fit.sources for row in one.parameters.items()]
    record = record_of(file, scene, request, fit, sources, scores)
    runs = [(one.engine, one.outcome.trajectory) for one in found]
    stored = [Stored(name, FITTED, 0, run) for name, run in runs if run]
    return Result(record, (_measured(setup.fitted[0], roles.body), *stored))


def _measured(toss: Toss, body: str) -> Stored:
    """The first toss that was fitted, as it was seen."""
    signals = {f"{body}.position_m": toss.position_m,
               f"{body}.orientation_wxyz": toss.orientation_wxyz}  # fmt: skip
    return Stored(MEASURED, "", 0, Trajectory(MEASURED, toss.time_s, signals))


def _scale_of(file: ScenarioFile, request: FitRequest) -> float:
    """Measured lengths over true ones, as they are fixed."""
    check_options(file, of_bounces(request), "tosses", "")
    scale = units.to_si((request.fixed or {}).get(SCALE, 1.0), "1", f"--fix {SCALE}")
    if not scale > 0:
        raise InputError("--fix", [f"{scale:g} is no {SCALE}; expected a number above 0"])
    return scale
