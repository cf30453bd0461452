"""The uncertainty of a result by runs of an engine.

Each input is moved to both sides, and the change of the result is its sensitivity. Where repeats of
the scenario are dithered, the scatter between them is a part of the uncertainty: the numerical one.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simcompare.comparison.repeats import truths_of
from simcompare.engine.calibration.plan import drop_plans
from simcompare.errors import InputError
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Array, Trajectory
from simcompare.propagation import results
from simcompare.propagation.propagated import Asked, Propagated, linear, with_trials
from simcompare.propagation.steps import Ends, Steps
from simcompare.running.jobs import OK, Job, Outcome
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.statistics.budget import u_of
from simcompare.statistics.distributions import Distribution, student_t
from simcompare.statistics.joint import joint

#: what the budget calls the scatter between an engine's dithered repeats
NUMERICAL = "numerical scatter"
#: part of u that the middle of both ends of an input may be off a straight line
_BENT = 0.25
#: scatter below this part of the result is rounding
_ROUNDING = 1e-12


@dataclass(frozen=True)
class Runs:
    """All runs of one engine at one contact level.

    Attributes:
        file: the scenario.
        of: the result.
        repeats: the scenario once for each dithered repeat, the nominal one in the middle.
        steps: input -> the two values to which it is moved.
        drawn: input -> values of the trials of Monte Carlo, empty for none.
    """

    file: ScenarioFile
    of: str
    repeats: Sequence[Scenario]
    steps: Steps
    drawn: Mapping[str, Array]

    def scenes(self) -> Iterator[Scenario]:
        """What is run: the repeats, then each input at both ends, then the trials."""
        yield from self.repeats
        for name, ends in self.steps.items():
            for scene in self._moved:
                for end in ends:
                    # beside the repeat's own value: the dithered parameter may be an input too
                    offset = end - self.nominal.parameters[name]
                    yield self.file.moved(scene, {name: scene.parameters[name] + offset})
        for row in zip(*self.drawn.values(), strict=True):
            values = dict(zip(self.drawn, map(float, row), strict=True))
            yield self.file.moved(self.nominal, values)

    def jobs(self, engine: str, contact: str, helps: frozenset[str] | None) -> list[Job]:
        """A job for each scene."""
        return [
            Job(engine, scene, Settings(contact, helps=helps, drops=drop_plans(scene)), number)
            for number, scene in enumerate(self.scenes())
        ]

    @property
    def nominal(self) -> Scenario:
        """The repeat in the middle."""
        return self.repeats[len(self.repeats) // 2]

    @property
    def _places(self) -> list[int]:
        """Places of the repeats with which inputs are moved: both ends and the middle."""
        count = len(self.repeats)
        return sorted({0, count // 2, count - 1})

    @property
    def _moved(self) -> Sequence[Scenario]:
        return [self.repeats[i] for i in self._places]


def draws(asked: Asked, trials: int) -> dict[str, Array]:
    """Values of the inputs for so many runs."""
    return next(joint(asked.inputs, asked.correlation).blocks(asked.seed, trials))


def propagated(runs: Runs, asked: Asked, outcomes: Sequence[Outcome]) -> Propagated:
    """What an engine's runs tell, in the order of their jobs.

    Raises:
        InputError: some run has no result.
    """
    values = iter([_value(outcome, runs.of) for outcome in outcomes])
    known = list(itertools.islice(values, len(runs.repeats)))
    estimate, scatter = _mean(runs, known)
    moved = len(runs._moved)
    middles = np.array([known[i] for i in runs._places])
    slopes, bends = {}, {}
    for name, ends in runs.steps.items():
        pairs = np.array(list(itertools.islice(values, 2 * moved))).reshape(moved, 2)
        slopes[name] = float((pairs[:, 1] - pairs[:, 0]).mean() / (ends.high - ends.low))
        bends[name] = _bend(pairs, middles, ends, asked.inputs[name])
    first = linear(asked, estimate, slopes, scatter)
    bent = tuple(name for name, size in bends.items() if size > _BENT * first.u)
    rest = np.array(list(values))
    if not len(rest):
        return Propagated(first, bent=bent)
    # the runs are done already: the draws only ask for them
    return replace(with_trials(asked, first, lambda **_: rest, len(rest)), bent=bent)


def _bend(pairs: Array, middles: Array, ends: Ends, known: Distribution) -> float:
    """How far a result is off a straight line at ± u, from both ends and its middle.

    It is 0 where one of the ends is a bound of the parameter.
    """
    if abs((ends.low + ends.high) / 2 - known.center) > _ROUNDING * abs(known.center):
        return 0.0
    step = (ends.high - ends.low) / 2
    return abs(float((pairs.mean(axis=1) - middles).mean())) * (u_of(known) / step) ** 2


def _mean(runs: Runs, values: Sequence[float]) -> tuple[float, dict[str, Distribution]]:
    """The result at the estimates, without the dither, and what the repeats' scatter leaves open.

    Each repeat is held against the closed form of its own parameters.
    """
    truths: Sequence[Trajectory | None] = [None] * len(values)
    if len(values) > 1 and not runs.nominal.beyond:
        truths = truths_of(runs.file.path, runs.repeats)
    dithered = [
        0.0 if truth is None else results.value_of(scene, truth, runs.of)
        for scene, truth in zip(runs.repeats, truths, strict=True)
    ]
    middle = dithered[len(values) // 2]
    off = np.array(values) - np.array(dithered)
    estimate = middle + float(off.mean())
    if len(values) < 2 or not (sd := float(off.std(ddof=1))) > _ROUNDING * abs(estimate):
        return estimate, {}
    return estimate, {NUMERICAL: student_t(0.0, sd / len(values) ** 0.5, len(values) - 1)}


def _value(outcome: Outcome, of: str) -> float:
    if outcome.status != OK or outcome.trajectory is None:
        raise InputError(outcome.job.engine, [outcome.reason or outcome.status])
    return results.value_of(outcome.job.scenario, outcome.trajectory, of)
