"""How well something does that acts: many episodes that it has not learnt from, and intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from simcompare.learning.environment import Environment, Numbers

#: seeds from here on are for trials; who learns takes smaller ones
HELD_OUT = 1_000_000
#: two-sided 95 % of a normal distribution
_Z95 = 1.959963984540054


@dataclass(frozen=True)
class Trials:
    """What came of some episodes.

    Attributes:
        episodes: how many there were.
        successes: how many reached the goal and touched nothing.
        collisions: how many touched something.
        spl: success weighted by path length, the mean of success times straight way over way
            (Anderson et al. 2018, arXiv:1807.06757).
    """

    episodes: int
    successes: int
    collisions: int
    spl: float

    @property
    def success(self) -> tuple[float, float]:
        """95 % interval of the probability of success."""
        return wilson(self.successes, self.episodes)

    @property
    def collision(self) -> tuple[float, float]:
        """95 % interval of the probability of a collision."""
        return wilson(self.collisions, self.episodes)


def wilson(count: int, of: int) -> tuple[float, float]:
    """95 % interval of a probability from how often something was seen (E. B. Wilson 1927)."""
    if of < 1:
        return 0.0, 1.0
    share, z2 = count / of, _Z95**2
    middle = (share + z2 / (2 * of)) / (1 + z2 / of)
    half = _Z95 * math.sqrt(share * (1 - share) / of + z2 / (4 * of**2)) / (1 + z2 / of)
    return max(0.0, middle - half), min(1.0, middle + half)


def run_trials(
    environment: Environment, act: Callable[[Any], Numbers], seeds: Iterable[int]
) -> Trials:
    """Runs one episode for each seed.

    Args:
        environment: where.
        act: gives an action at an observation.
        seeds: of the episodes; the same seed is the same arena on every engine.
    """
    ends = [_end_of(environment, act, seed) for seed in seeds]
    ways = [
        end["straight_m"] / max(end["straight_m"], end["way_m"])
        for end in ends
        if end["is_success"]
    ]
    return Trials(
        episodes=len(ends),
        successes=len(ways),
        collisions=sum(bool(end["collided"]) for end in ends),
        spl=sum(ways) / max(len(ends), 1),
    )


def _end_of(
    environment: Environment, act: Callable[[Any], Numbers], seed: int
) -> Mapping[str, Any]:
    """What is told at the end of one episode."""
    seen, _ = environment.reset(seed=seed)
    is_over = is_cut = False
    told: Mapping[str, Any] = {}
    while not (is_over or is_cut):
        seen, _, is_over, is_cut, told = environment.step(act(seen))
    return told
