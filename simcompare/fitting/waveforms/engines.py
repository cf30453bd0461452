"""Each engine's own parameters from measured signals, with the reference as the exact model.

Last, every engine is run with what was found, and with half the step.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from simcompare.errors import SimcompareError
from simcompare.fitting.waveforms.reference import Fitted
from simcompare.fitting.waveforms.setup import Setup
from simcompare.inference.defect_correction import Corrected, correct, simulate
from simcompare.inference.reference_model import Model
from simcompare.inference.residuals import Block, residuals_of, solve
from simcompare.inference.segments import Segment
from simcompare.inference.simulated import BEST, HALF, of_probes
from simcompare.model.resampling import interpolated
from simcompare.model.settings import ASSISTED, Settings
from simcompare.model.signals import Step
from simcompare.model.trajectory import Array, Trajectory
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Progress

#: Newton's steps at most, and the part of an unknown below which a step no longer counts
MAX_STEPS, ENOUGH = 12, 1e-8
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
        change: of the unknowns that one more round would bring (k,).
        runs: the last simulations; fitted segments first, then those that were held out.
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
    change: Array = field(default_factory=lambda: np.zeros(0))
    runs: Runs = field(default_factory=dict, repr=False)
    simulations: int = 0
    wall_s: float = 0.0
    outcomes: tuple[Outcome, ...] = field(default=(), repr=False)


@dataclass(frozen=True)
class _Work:
    model: Model
    setup: Setup
    fitted: Fitted
    step_s: float | None

    @property
    def cases(self) -> tuple[Segment, ...]:
        return (*self.setup.fitted, *self.setup.held)

    def values(self, x: Array, number: int) -> dict[str, float]:
        """Unknowns as parameters of a segment.

        Nuisance parameters, and starts that were fitted, belong to the fitted segments alone.
        """
        if number >= len(self.setup.fitted):
            return dict(zip(self.setup.names, x[: len(self.setup.names)].tolist(), strict=True))
        own = self.fitted.solution.starts[number]
        return {**own, **dict(zip(self.setup.every, x.tolist(), strict=True))}

    def number(self, block: Block) -> int:
        """Which segment a block belongs to."""
        return next(i for i, case in enumerate(self.setup.fitted) if case is block.segment)


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
    work = _Work(model, setup, fitted, step_s)
    states = {name: Corrected(fitted.solution.values) for name in engines}
    limits: dict[str, Any] = {"time_limit_s": time_limit_s, "progress": progress}
    count = len(setup.fitted)

    def corrected(name: str, one: Corrected) -> Array:
        return _corrected(work, one.x, _defects(work, one.x, _runs(work, one.last), BEST))

    correct(
        states, lambda name, x: _jobs(work, name, x, range(count), (BEST,)), corrected, **limits
    )
    every = range(len(work.cases))
    simulate(
        states, lambda name, x: _jobs(work, name, x, every, (BEST, HALF)),
        essential=lambda job: job.label == BEST and job.repeat < count, **limits,
    )  # fmt: skip
    return [_result(work, name, one) for name, one in states.items()]


def _jobs(
    work: _Work, name: str, x: Array, numbers: Sequence[int], variants: Sequence[str]
) -> list[Job]:
    """One engine on some segments, each with its own step or with half of it."""
    jobs = []
    for i in numbers:
        case, values = work.cases[i], work.values(x, i)
        scene = work.model.scenario(case, values, work.step_s)
        for variant in variants:
            if variant == HALF:
                scene = work.model.scenario(case, values, scene.world.step_s / 2)
            jobs.append(Job(name, scene, Settings(ASSISTED), i, label=variant))
    return jobs


def _runs(work: _Work, outcomes: Sequence[Outcome]) -> dict[tuple[int, str], Trajectory]:
    """What the probes saw in the simulations that ended well."""
    return {
        (o.job.repeat, o.job.label): of_probes(
            o.job.scenario, o.trajectory, work.cases[o.job.repeat].watched
        )
        for o in outcomes if o.status == OK and o.trajectory is not None
    }  # fmt: skip


def _defects(work: _Work, x: Array, runs: Runs, variant: str) -> list[Array]:
    """Engine less reference, of each block."""
    found = []
    for block in work.fitted.blocks:
        number = work.number(block)
        run = runs[number, variant]
        ours = interpolated(
            run.time_s, run.signals[block.probe], block.time_s, events_s=_jumps(block.segment, work)
        )
        truth = work.model.at(block.segment, block.probe, work.values(x, number), block.time_s)
        found.append(_filled(ours - truth))
    return found


def _jumps(case: Segment, work: _Work) -> list[float]:
    """When an input jumps: there a simulation has one sample only, and no defect can be told."""
    inputs = {**work.model.scenario(case).inputs, **case.inputs}
    return [one.time_s for one in inputs.values() if isinstance(one, Step) and one.time_s > 0]


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
    for _ in range(MAX_STEPS if not work.fitted.estimate.at_bound else 0):
        residuals = np.concatenate(
            [
                part
                for block in blocks
                for part in residuals_of(
                    work.model, [block], work.values(found, work.number(block))
                )
            ]
        )
        moved = found - work.fitted.gain @ residuals
        if not all(bounds[n].min < v < bounds[n].max for n, v in zip(names, moved, strict=True)):
            break
        if np.all(np.abs(moved - found) <= ENOUGH * np.abs(moved)):
            return np.asarray(moved, dtype=float)
        found = moved
    return solve(work.model, blocks, names, x, starts=work.setup.starts).values


def _result(work: _Work, name: str, one: Corrected) -> EngineWaves:
    if one.failure is None:
        try:
            return _with_runs(work, name, one, _runs(work, one.last))
        except SimcompareError as error:
            one.failure = replace(one.last[0], status=FAILED, reason=str(error))
    bad = one.failure
    return EngineWaves(
        name, bad.facts.version, bad.status, bad.reason, simulations=one.simulations,
        wall_s=one.wall_s, outcomes=(bad,),
    )  # fmt: skip


def _with_runs(work: _Work, name: str, one: Corrected, runs: Runs) -> EngineWaves:
    defects = _defects(work, one.x, runs, BEST)
    again = _corrected(work, one.x, defects)
    u_num = np.full(len(one.x), np.nan)
    if all((i, HALF) in runs for i in range(len(work.setup.fitted))):
        finer = _corrected(work, one.x, _defects(work, one.x, runs, HALF))
        # an error of first order is twice this difference, which is then covered with k = 2
        u_num = np.abs(again - finer)
    weighted = np.concatenate(
        [d * block.weight for d, block in zip(defects, work.fitted.blocks, strict=True)]
    )
    return EngineWaves(
        name, one.last[0].facts.version, OK, None, one.x, u_num,
        one.x + work.fitted.gain @ weighted, again - one.x, dict(runs), one.simulations,
        one.wall_s, tuple(o for o in one.last if o.job.label == BEST),
    )  # fmt: skip
