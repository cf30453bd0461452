"""Each engine's own parameters from measured signals, by correcting its defect.

As with bounces: an engine given the parameters x shows signals that are a little off those of the
reference at x, and that defect hardly changes with x. So the reference is fitted to the measured
signals less the defect, the engine is run with what comes out, and this is repeated once: space
mapping (J. W. Bandler et al., IEEE Trans. Microwave Theory Tech. 42 (1994) 2536). Last, it is run
with what was found, and with half the step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from simcompare.errors import SimcompareError
from simcompare.fitting.waveforms.reference import Fitted
from simcompare.fitting.waveforms.setup import Setup
from simcompare.inference.estimate import Block, residuals_of, solve
from simcompare.inference.reference_model import Model
from simcompare.inference.segments import Case
from simcompare.inference.simulated import BEST, HALF, of_probes
from simcompare.model.resampling import interpolated
from simcompare.model.settings import ASSISTED, Settings
from simcompare.model.signals import Step
from simcompare.model.trajectory import Array, Trajectory
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs

#: how often an engine is run and the reference fitted again
ROUNDS = 2
#: Newton's steps at most, and the part of an unknown below which a step no longer counts
MOST_STEPS, ENOUGH = 12, 1e-8
#: (number of the case, variant) -> what its probes saw
Runs = Mapping[tuple[int, str], Trajectory]


@dataclass(frozen=True)
class EngineWaves:
    """What one engine must be given, and what it then shows.

    Attributes:
        engine: its name.
        version: its version.
        status: "ok" or how it failed.
        reason: why it failed.
        x: all unknowns to be given to it (k,).
        u_num: standard uncertainty of them from its step: what half the step changes (k,).
        effective: unknowns that the reference would need to show the same (k,).
        left: change of the unknowns that one more round would bring (k,).
        runs: the last simulations; fitted stretches first, then those that were held out.
        simulations: how many were run.
        wall_s: wall time of them.
        outcomes: how the last ones ended.
    """

    engine: str
    version: str | None
    status: str
    reason: str | None
    x: Array = field(default_factory=lambda: np.zeros(0))
    u_num: Array = field(default_factory=lambda: np.zeros(0))
    effective: Array = field(default_factory=lambda: np.zeros(0))
    left: Array = field(default_factory=lambda: np.zeros(0))
    runs: Runs = field(default_factory=dict, repr=False)
    simulations: int = 0
    wall_s: float = 0.0
    outcomes: tuple[Outcome, ...] = field(default=(), repr=False)


@dataclass
class _State:
    """How far the fit of one engine has come."""

    x: Array
    bad: Outcome | None = None
    last: tuple[Outcome, ...] = ()
    simulations: int = 0
    wall_s: float = 0.0


@dataclass(frozen=True)
class _Work:
    model: Model
    setup: Setup
    fitted: Fitted
    step_s: float | None
    time_limit_s: float
    progress: Progress | None

    @property
    def cases(self) -> tuple[Case, ...]:
        return (*self.setup.fitted, *self.setup.held)

    def values(self, x: Array, number: int) -> dict[str, float]:
        """Unknowns as parameters of a stretch.

        Nuisance parameters, and starts that were fitted, belong to the fitted stretches alone.
        """
        if number >= len(self.setup.fitted):
            return dict(zip(self.setup.names, x[: len(self.setup.names)].tolist(), strict=True))
        own = self.fitted.solution.starts[number]
        return {**own, **dict(zip(self.setup.every, x.tolist(), strict=True))}

    def number(self, block: Block) -> int:
        """Which stretch a block belongs to."""
        return next(i for i, case in enumerate(self.setup.fitted) if case is block.case)


def fit_engines(
    model: Model,
    setup: Setup,
    fitted: Fitted,
    engines: Sequence[str],
    *,
    step_s: float | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> list[EngineWaves]:
    """Fits all engines, each in a process of its own.

    Args:
        model: the scenario with its reference.
        setup: what is fitted and held out.
        fitted: the reference as fitted.
        engines: names.
        step_s: time between samples; the scenario's own where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    work = _Work(model, setup, fitted, step_s, time_limit_s, progress)
    states = {name: _State(fitted.solution.values) for name in engines}
    for _ in range(ROUNDS):
        runs = _simulate(work, states, range(len(setup.fitted)), (BEST,))
        for name, state in states.items():
            if state.bad is None:
                _advance(work, state, runs[name])
    runs = _simulate(work, states, range(len(work.cases)), (BEST, HALF))
    return [_result(work, name, state, runs[name]) for name, state in states.items()]


def _simulate(
    work: _Work, states: Mapping[str, _State], numbers: Sequence[int], variants: Sequence[str]
) -> dict[str, dict[tuple[int, str], Trajectory]]:
    """Runs some stretches on every engine that has not failed yet."""
    jobs: list[Job] = []
    plan: list[tuple[int, str]] = []
    found: dict[str, dict[tuple[int, str], Trajectory]] = {name: {} for name in states}
    for name, state in states.items():
        for i in numbers if state.bad is None else ():
            for variant in variants:
                scene = work.model.scenario(work.cases[i], work.values(state.x, i), work.step_s)
                if variant == HALF:
                    scene = work.model.scenario(
                        work.cases[i], work.values(state.x, i), scene.world.step_s / 2
                    )
                jobs.append(Job(name, scene, Settings(ASSISTED), len(plan)))
                plan.append((i, variant))
    outcomes = run_jobs(jobs, time_limit_s=work.time_limit_s, progress=work.progress)
    for name, state in states.items():
        own = [outcome for outcome in outcomes if outcome.job.engine == name]
        if own:
            _collect(work, state, own, plan, found[name])
    return found


def _collect(
    work: _Work,
    state: _State,
    own: Sequence[Outcome],
    plan: Sequence[tuple[int, str]],
    found: dict[tuple[int, str], Trajectory],
) -> None:
    """What the probes saw; an engine that fails for a fitted stretch has failed."""
    state.simulations += len(own)
    state.last = tuple(o for o in own if plan[o.job.repeat][1] == BEST)
    for outcome in own:
        number, variant = plan[outcome.job.repeat]
        run = outcome.trajectory
        if outcome.status != OK or run is None:
            if variant == BEST and number < len(work.setup.fitted):
                state.bad = state.bad or outcome
            continue
        state.wall_s += run.wall_s.get("build", 0.0) + run.wall_s.get("step", 0.0)
        case = work.cases[number]
        try:
            found[number, variant] = of_probes(outcome.job.scenario, run, case.watched)
        except SimcompareError as error:
            state.bad = state.bad or replace(outcome, status=FAILED, reason=str(error))


def _advance(work: _Work, state: _State, runs: Runs) -> None:
    """One round: the defect of the engine at x, and the reference fitted to what it leaves."""
    assert state.last
    state.x = _corrected(work, state.x, _defects(work, state.x, runs, BEST))


def _defects(work: _Work, x: Array, runs: Runs, variant: str) -> list[Array]:
    """Engine less reference, of each block."""
    found = []
    for block in work.fitted.blocks:
        number = work.number(block)
        run = runs[number, variant]
        ours = interpolated(
            run.time_s, run.signals[block.probe], block.time_s, events_s=_jumps(block.case, work)
        )
        truth = work.model.at(block.case, block.probe, work.values(x, number), block.time_s)
        found.append(_filled(ours - truth))
    return found


def _jumps(case: Case, work: _Work) -> list[float]:
    """When an input jumps: there a simulation has one sample only, and no defect can be told."""
    given = {**work.model.scenario(case).inputs, **case.inputs}
    return [one.time_s for one in given.values() if isinstance(one, Step) and one.time_s > 0]


def _filled(values: Array) -> Array:
    """The defect where it was not told, beside a jump and in the last step, from its neighbours."""
    known = np.isfinite(values)
    if known.all() or not known.any():
        return values
    places = np.arange(len(values))
    return np.asarray(np.interp(places, places[known], values[known]), dtype=float)


def _corrected(work: _Work, x: Array, defects: Sequence[Array]) -> Array:
    """The unknowns that fit what the defect leaves, by Newton's steps with the reference's slopes.

    What is looked for is near, so the slopes are as good as those there, and each step costs one
    evaluation. Where a bound is in the way, or nothing converges, it is fitted from scratch.
    """
    blocks: list[Block] = [
        replace(block, values=block.values - defect)
        for block, defect in zip(work.fitted.blocks, defects, strict=True)
    ]
    names, bounds = work.setup.every, work.model.file.parameters
    found = x
    for _ in range(MOST_STEPS if not work.fitted.estimate.at_bound else 0):
        left = np.concatenate(
            [
                part
                for block in blocks
                for part in residuals_of(
                    work.model, [block], work.values(found, work.number(block))
                )
            ]
        )
        moved = found - work.fitted.gain @ left
        if not all(bounds[n].min < v < bounds[n].max for n, v in zip(names, moved, strict=True)):
            break
        if np.all(np.abs(moved - found) <= ENOUGH * np.abs(moved)):
            return np.asarray(moved, dtype=float)
        found = moved
    return solve(work.model, blocks, names, x, starts=work.setup.starts).values


def _result(work: _Work, name: str, state: _State, runs: Runs) -> EngineWaves:
    bad = state.bad
    if bad is not None:
        return EngineWaves(
            name, bad.facts.version, bad.status, bad.reason, simulations=state.simulations,
            wall_s=state.wall_s, outcomes=(bad,),
        )  # fmt: skip
    defects = _defects(work, state.x, runs, BEST)
    again = _corrected(work, state.x, defects)
    u_num = np.full(len(state.x), np.nan)
    if all((i, HALF) in runs for i in range(len(work.setup.fitted))):
        finer = _corrected(work, state.x, _defects(work, state.x, runs, HALF))
        # an error of first order is twice this difference, which is then covered with k = 2
        u_num = np.abs(again - finer)
    weighted = np.concatenate(
        [d * block.weight for d, block in zip(defects, work.fitted.blocks, strict=True)]
    )
    return EngineWaves(
        name, state.last[0].facts.version, OK, None, state.x, u_num,
        state.x + work.fitted.gain @ weighted, again - state.x, dict(runs), state.simulations,
        state.wall_s, state.last,
    )  # fmt: skip
