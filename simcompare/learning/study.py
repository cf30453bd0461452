"""Which policy does how well where: every policy on every engine with every size of errors."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import stats

from simcompare.learning import policy
from simcompare.learning.environment import Asked, Environment
from simcompare.learning.trials import HELD_OUT, Trials, run_trials, wilson

#: what tells policies apart that differ in their seed alone
Learnt = tuple[str, float]


@dataclass(frozen=True)
class Row:
    """One policy, tried on one engine with one size of errors.

    Attributes:
        learnt_on: the engine, and how large the errors were, where it was learnt.
        seed: with which.
        engine: where it was tried.
        sensors: how large the errors were there.
        trials: what came of it.
    """

    learnt_on: Learnt
    seed: int
    engine: str
    sensors: float
    trials: Trials


@dataclass(frozen=True)
class Share:
    """How often something came, over policies that differ in their seed alone.

    Attributes:
        mean: over the seeds.
        low: end of its 95 % interval.
        high: the other end.
        seeds: how many there were.
    """

    mean: float
    low: float
    high: float
    seeds: int


def try_all(
    scenario: str,
    files: Iterable[Path],
    engines: Sequence[str],
    sensors: Sequence[float],
    episodes: int,
    step_s: float | None = None,
) -> Iterator[Row]:
    """Tries policies, one row after another, the first file first.

    Args:
        scenario: name of the scenario.
        files: policies.
        engines: where they are tried.
        sensors: how large the errors are.
        episodes: of each row; they are the same ones in all rows.
        step_s: engine step [s]; ``None``: that of the scenario.

    Raises:
        InputError: a file is no policy for the scenario.
    """
    for file, engine, errors in itertools.product(files, engines, sensors):
        environment = Environment(Asked(scenario, engine, sensors=errors, step_s=step_s))
        seen, done = environment.observation_space.shape[0], environment.action_space.shape[0]
        act = policy.load(file, seen, done)
        trials = run_trials(environment, act, range(HELD_OUT, HELD_OUT + episodes))
        environment.close()
        recipe = act.recipe
        learnt_on = str(recipe.get("engine", "?")), float(recipe.get("sensors", math.nan))
        yield Row(learnt_on, int(recipe.get("seed", 0)), engine, errors, trials)


def over_seeds(rows: Iterable[Row], what: str) -> Mapping[tuple[Learnt, str, float], Share]:
    """Shares of "successes" or "collisions" by where it was learnt, and where it was tried.

    Seeds differ by more than episodes do, so the interval is that of the mean over seeds, by
    Student's t; of a single seed it is Wilson's, over its episodes.
    """
    counts: dict[tuple[Learnt, str, float], list[tuple[int, int]]] = {}
    for row in rows:
        place = row.learnt_on, row.engine, row.sensors
        counts.setdefault(place, []).append((getattr(row.trials, what), row.trials.episodes))
    return {place: _share(found) for place, found in counts.items()}


def _share(counts: Sequence[tuple[int, int]]) -> Share:
    if len(counts) == 1:
        ((count, of),) = counts
        return Share(count / of, *wilson(count, of), 1)
    each = np.array([count / of for count, of in counts])
    n, mean = len(each), float(each.mean())
    half = float(stats.t.ppf(0.975, n - 1) * each.std(ddof=1) / math.sqrt(n))
    return Share(mean, max(0.0, mean - half), min(1.0, mean + half), n)
