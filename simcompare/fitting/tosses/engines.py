"""Every engine's own parameters from tosses, each engine in a process of its own.

The engines are asked side by side: in each round, every one replays all tosses at the points that
its search wants next. What breaks an engine's process ends the search of that engine alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from simcompare.engine.calibration.plan import drop_plans
from simcompare.fitting.tosses.replay import STEP_S, Replay, Replayed
from simcompare.fitting.tosses.roles import TossRoles
from simcompare.fitting.tosses.search import HALVINGS, Point, Search
from simcompare.fitting.tosses.setup import Setup
from simcompare.fitting.tosses.tosses import Errors, Toss
from simcompare.model.settings import ASSISTED, TUNED, Settings
from simcompare.running.jobs import OK, UNSUPPORTED, Inquiry, Job, Outcome, Reply
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs


@dataclass(frozen=True)
class How:
    """How engines are run.

    Attributes:
        helps: our helps that are taken; ``None``: all; none of them: a plain loop.
        step_s: longest step of a replay [s].
        halvings: how often the grid is halved.
        time_limit_s: longest time for one simulation [s].
        progress: called as simulations end.
    """

    helps: frozenset[str] | None = None
    step_s: float = STEP_S
    halvings: int = HALVINGS
    time_limit_s: float = TIME_LIMIT_S
    progress: Progress | None = None

    @property
    def contact(self) -> str:
        """Contact level."""
        return TUNED if self.helps == frozenset() else ASSISTED


@dataclass
class EngineTosses:
    """What was found for one engine.

    Attributes:
        engine: its name.
        search: every point that was tried.
        outcome: how its last whole simulation ended; not "ok" where the engine cannot be fitted.
        held: errors in the tosses that were predicted.
        simulations: how many were run.
        wall_s: wall time of them.
    """

    engine: str
    search: Search
    outcome: Outcome
    held: tuple[Errors, ...] = ()
    simulations: int = 0
    wall_s: float = 0.0

    @property
    def is_ok(self) -> bool:
        """Whether the engine could be fitted so far."""
        return self.outcome.status == OK

    def fail(self, reply: Reply[Replayed], point: Point) -> None:
        """The engine cannot be fitted: ends its search."""
        where = ", ".join(f"{name} = {v:.4g}" for name, v in self.search.values(point).items())
        reason = f"{reply.reason} (with {where})"
        self.outcome = replace(self.outcome, status=reply.status, reason=reason, trajectory=None)


def fit_engines(
    roles: TossRoles, setup: Setup, engines: Sequence[str], how: How
) -> list[EngineTosses]:
    """Fits all engines, and lets them predict the tosses that were held out.

    Args:
        roles: the scenario.
        setup: what is fitted and predicted.
        engines: names.
        how: how engines are run.
    """
    work = _Work(roles, setup, how)
    found = work.opened(engines)
    while batch := [(one, point) for one in found if one.is_ok for point in one.search.wanted()]:
        for (one, point), replies in zip(batch, work.replies(batch, setup.fitted), strict=True):
            _take(one, point, replies)
    batch = [(one, one.search.best) for one in found if one.is_ok]
    for (one, point), replies in zip(batch, work.replies(batch, setup.held), strict=True):
        held = _errors(one, replies)
        if held is None:
            one.fail(next(reply for reply in replies if reply.status != OK), point)
        else:
            one.held = held
    work.close([one for one in found if one.is_ok])
    return found


@dataclass(frozen=True)
class _Work:
    roles: TossRoles
    setup: Setup
    how: How

    def opened(self, engines: Sequence[str]) -> list[EngineTosses]:
        """One whole simulation each, which tells whether an engine can do such scenes."""
        grids, given = self.setup.grids, self.roles.given
        first = tuple(min(max(given[n], grid.min), grid.max) for n, grid in grids.items())
        searches = [Search(grids, first, self.how.halvings) for _ in engines]
        outcomes = self._simulated(
            [(name, search.values(first)) for name, search in zip(engines, searches, strict=True)]
        )
        return [
            EngineTosses(outcome.job.engine, search, outcome, simulations=1)
            for search, outcome in zip(searches, outcomes, strict=True)
        ]

    def close(self, found: Sequence[EngineTosses]) -> None:
        """One whole simulation each with the best values."""
        wanted = [(one.engine, one.search.values(one.search.best)) for one in found]
        for one, outcome in zip(found, self._simulated(wanted), strict=True):
            one.outcome = outcome
            one.simulations += 1

    def _simulated(self, wanted: Sequence[tuple[str, Mapping[str, float]]]) -> list[Outcome]:
        jobs = []
        for engine, values in wanted:
            replay = self._replay(self.setup.fitted[0], values)
            jobs.append(Job(engine, replay.scenario(), replay.settings))
        return run_jobs(jobs, time_limit_s=self.how.time_limit_s, progress=self.how.progress)

    def replies(
        self, batch: Sequence[tuple[EngineTosses, Point]], tosses: Sequence[Toss]
    ) -> list[list[Reply[Replayed]]]:
        """What engines answer at points, toss by toss."""
        asked = [
            Inquiry(one.engine, self._replay(toss, one.search.values(point)))
            for one, point in batch for toss in tosses
        ]  # fmt: skip
        answers = iter(
            run_jobs(asked, time_limit_s=self.how.time_limit_s, progress=self.how.progress)
        )
        return [[next(answers) for _ in tosses] for _ in batch]

    def _replay(self, toss: Toss, values: Mapping[str, float]) -> Replay:
        settings = Settings(ASSISTED, helps=self.how.helps)
        if self.how.contact == TUNED:
            # numbers for the restitution are found once, for the first toss
            first = Replay(self.roles, self.setup.fitted[0], values, step_s=self.how.step_s)
            settings = Settings(TUNED, drops=drop_plans(first.scenario()))
        return Replay(self.roles, toss, values, settings, self.how.step_s)


def _take(one: EngineTosses, point: Point, replies: Sequence[Reply[Replayed]]) -> None:
    """Tells a search what was found; what an engine cannot may be better elsewhere."""
    errors = _errors(one, replies)
    bad = next((reply for reply in replies if reply.status != OK), None)
    if bad is not None and (bad.status != UNSUPPORTED or not one.search.tried) and one.is_ok:
        one.fail(bad, point)
    one.search.tried[point] = errors


def _errors(one: EngineTosses, replies: Sequence[Reply[Replayed]]) -> tuple[Errors, ...] | None:
    """Errors of all tosses; ``None`` where one of them could not be replayed."""
    done = [reply.value for reply in replies if reply.value is not None]
    one.simulations += len(replies)
    one.wall_s += sum(replayed.wall_s for replayed in done)
    return tuple(replayed.errors for replayed in done) if len(done) == len(replies) else None
