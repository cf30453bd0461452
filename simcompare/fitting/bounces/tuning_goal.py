"""What engines are tuned to: the closed form at the first recorded impact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.roles import Roles
from simcompare.model.trajectory import Array

#: phases of the step at which every drop is run, fewer where there are many drops, and the fewest
PHASES, MAX_RUNS, MIN_PHASES = 25, 150, 5


@dataclass(frozen=True)
class TuningGoal:
    """What all engines are tuned to: the closed form at the first recorded impact.

    Attributes:
        restitution: of that impact.
        u: its standard uncertainty.
        speed_m_s: speed of that impact [m/s].
        lead: number of the drop, from 0, whose first impact is the fastest.
        drops: parameters of the closed form of every drop that is run, the held-out ones last.
        counts: impacts that were measured in each.
        fitted: how many of them were fitted.
    """

    restitution: float
    u: float
    speed_m_s: float
    lead: int
    drops: tuple[Mapping[str, Array | float], ...]
    counts: tuple[int, ...]
    fitted: int

    @property
    def phases(self) -> int:
        """At how many phases of the step each drop is run."""
        return max(MIN_PHASES, min(PHASES, MAX_RUNS // len(self.drops)))


def goal_of(roles: Roles, best: Fit, held: Sequence[Fit]) -> TuningGoal:
    """What a closed form asks of engines, and the drops in which that is looked at.

    Args:
        roles: the scenario.
        best: the closed form.
        held: its predictions of held-out drops.
    """
    lead, number, speed = 0, 1, 0.0
    for drop, impacts in enumerate(best.problem.drops):
        first = min(impacts.numbers, default=1)
        values = best.problem.values(best.x, drop)
        shown = bounce_models.bounces(best.problem.model, values, first)
        found = float(np.ravel(shown.speed_m_s)[first - 1])
        if found > speed:
            lead, number, speed = drop, first, found
    restitution, u = best.restitution_at(speed)
    own = [best.problem.values(best.x, drop) for drop in range(len(best.problem.drops))]
    own += [one.problem.values(one.x, 0) for one in held]
    counts = [impacts.count for fit in (best, *held) for impacts in fit.problem.drops]
    drops = tuple({**values, "restitution": restitution, **_drag(roles, values)} for values in own)
    if number > 1:
        counts[lead] = max(counts[lead], number)
    return TuningGoal(restitution, u, speed, lead, drops, tuple(counts), len(best.problem.drops))


def _drag(roles: Roles, values: Mapping[str, Array | float]) -> dict[str, Array | float]:
    """The drag that the scene can have."""
    return {"drag_k": bounce_models.drag_of(values) if roles.has_drag else 0.0}
