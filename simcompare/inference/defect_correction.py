"""Each engine's own parameters, by correcting its defect.

An engine given the parameters x shows what is a little off what the exact model shows at x: its
step, its contact, its drag. That defect hardly changes with x. So the exact model is fitted to what
was measured less the defect, the engine is run with what comes out, and this is repeated: space
mapping (J. W. Bandler et al., IEEE Trans. Microwave Theory Tech. 42 (1994) 2536). Two rounds are
enough, and no difference quotient of an engine is ever taken, which would only show its scatter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from simcompare.errors import SimcompareError
from simcompare.model.trajectory import Array
from simcompare.running.jobs import FAILED, OK, Job, Outcome
from simcompare.running.runner import TIME_LIMIT_S, Progress, run_jobs

ROUNDS = 2


@dataclass
class Corrected:
    """How far the correction of one engine has come.

    Attributes:
        x: what the engine is to be given (k,).
        failure: the simulation that ended it.
        last: how the latest simulations ended.
        simulations: how many were run.
        wall_s: wall time of them [s].
    """

    x: Array
    failure: Outcome | None = None
    last: tuple[Outcome, ...] = ()
    simulations: int = 0
    wall_s: float = 0.0

    def attempt(self, step: Callable[[], Array]) -> None:
        """Takes a step; what the engine's motion does not allow ends its correction."""
        try:
            self.x = step()
        except SimcompareError as error:
            self.failure = replace(self.last[0], status=FAILED, reason=str(error))


def simulate(
    engines: Mapping[str, Corrected],
    jobs_of: Callable[[str, Array], Sequence[Job]],
    *,
    essential: Callable[[Job], bool] = lambda job: True,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> dict[str, Corrected]:
    """Runs every engine that has not failed yet; returns those that still have not.

    Args:
        engines: by name; their latest outcomes and costs are put down in them.
        jobs_of: what one engine is to be run with for its x.
        essential: whether an engine has failed where that job fails.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    running = {name: one for name, one in engines.items() if one.failure is None}
    jobs = [job for name, one in running.items() for job in jobs_of(name, one.x)]
    outcomes = run_jobs(jobs, time_limit_s=time_limit_s, progress=progress)
    for name, one in running.items():
        one.last = tuple(outcome for outcome in outcomes if outcome.job.engine == name)
        one.simulations += len(one.last)
        one.wall_s += wall_s(one.last)
        bad = (o for o in one.last if o.status != OK and essential(o.job))
        one.failure = next(bad, None)
    return {name: one for name, one in running.items() if one.failure is None}


def correct(
    engines: Mapping[str, Corrected],
    jobs_of: Callable[[str, Array], Sequence[Job]],
    corrected: Callable[[str, Corrected], Array],
    *,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> None:
    """Corrects the defects of all engines, each in a process of its own.

    Args:
        engines: by name, with what each is given first.
        jobs_of: what one engine is to be run with for its x.
        corrected: the fit of the exact model to what was measured less the defect that the latest
            outcomes of one engine show.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    for _ in range(ROUNDS):
        ran = simulate(engines, jobs_of, time_limit_s=time_limit_s, progress=progress)
        for name, one in ran.items():
            one.attempt(lambda name=name, one=one: corrected(name, one))  # type: ignore[misc]


def wall_s(outcomes: Iterable[Outcome]) -> float:
    """Wall time that simulations took to be built and stepped [s]."""
    walls = [o.trajectory.wall_s for o in outcomes if o.trajectory is not None]
    return sum(wall.get("build", 0.0) + wall.get("step", 0.0) for wall in walls)
