"""What engines are tuned to: the closed form at the first recorded impact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.deviations import ends_s
from simcompare.fitting.bounces.likelihood import Fit
from simcompare.fitting.bounces.one_number import Law, OneNumber, at_speed
from simcompare.fitting.bounces.roles import Roles
from simcompare.model.trajectory import Array

#: phases of the step at which every drop is run, fewer where there are many drops, and the fewest
PHASES, MAX_RUNS, MIN_PHASES = 25, 150, 5
#: most engine steps of one drop at all phases, some seconds of an engine with drag; and how many
#: impacts are run whatever it takes
MAX_STEPS, MIN_IMPACTS = 90_000, 3
#: simulated time after the last impact [s], and steps for the contact of each impact
_AFTER_S, CONTACT_STEPS = 0.05, 15


@dataclass(frozen=True)
class TuningGoal:
    """What all engines are tuned to: the closed form at the first recorded impact.

    Attributes:
        plain: the closed form with the restitution of that impact for all speeds.
        law: restitution of the ball, which all closed forms tell together.
        restitution: of that impact.
        u: its standard uncertainty.
        speed_m_s: speed of that impact [m/s].
        lead: number of the drop, from 0, whose first impact is the fastest.
        drops: parameters of the closed form of every drop that is run, the held-out ones last.
        counts: how many impacts of each are run.
        lasts_s: how long that takes [s].
        phases: at how many phases of the step each drop is run.
        fitted: how many of the drops were fitted.
    """

    plain: OneNumber
    law: Law
    restitution: float
    u: float
    speed_m_s: float
    lead: int
    drops: tuple[Mapping[str, Array | float], ...]
    counts: tuple[int, ...]
    lasts_s: tuple[float, ...]
    phases: int
    fitted: int


def goal_of(
    roles: Roles, best: Fit, law: Law, held: Sequence[Fit], step_s: float | None = None
) -> TuningGoal:
    """What a closed form asks of engines, and the drops in which that is looked at.

    Args:
        roles: the scenario.
        best: the closed form.
        law: its restitution.
        held: its predictions of held-out drops.
        step_s: time between samples; the scenario's own where ``None``.
    """
    lead, number, speed = _fastest(best)
    restitution, u = law(speed)
    own = [best.problem.values(best.x, drop) for drop in range(len(best.problem.drops))]
    own += [one.problem.values(one.x, 0) for one in held]
    wanted = [impacts.count for fit in (best, *held) for impacts in fit.problem.drops]
    drops = tuple({**values, "restitution": restitution, **_drag(roles, values)} for values in own)
    least = [min(MIN_IMPACTS, count) for count in wanted]
    least[lead] = max(least[lead], number)
    wanted[lead] = max(wanted[lead], number)
    step = roles.file.resolve(roles.values(drops[lead]), step_s=step_s).world.engine_step_s
    steps = [_lasts_s(one, count, step) / step for one, count in zip(drops, wanted, strict=True)]
    phases = min(PHASES, MAX_RUNS // len(drops), int(MAX_STEPS / max(steps)))
    phases = max(MIN_PHASES, phases)
    counts = tuple(
        _within(phases, one, most, few, step)
        for one, most, few in zip(drops, wanted, least, strict=True)
    )
    lasts = tuple(_lasts_s(one, n, step) for one, n in zip(drops, counts, strict=True))
    plain = at_speed(best, law, speed, with_drag=roles.has_drag)
    return TuningGoal(plain, law, restitution, u, speed, lead, drops, counts, lasts, phases,
                      len(best.problem.drops))  # fmt: skip


def _fastest(best: Fit) -> tuple[int, int, float]:
    """Drop (from 0), number (from 1) and speed of the fastest first recorded impact."""
    lead, number, speed = 0, 1, 0.0
    for drop, impacts in enumerate(best.problem.drops):
        first = min(impacts.numbers, default=1)
        shown = best.problem.bounces(best.x, drop, first)
        found = float(np.ravel(shown.speed_m_s)[first - 1])
        if found > speed:
            lead, number, speed = drop, first, found
    return lead, number, speed


def _within(
    phases: int, closed: Mapping[str, Array | float], most: int, fewest: int, step_s: float
) -> int:
    """How many impacts can be run at so many phases."""
    limit_s = MAX_STEPS * step_s / phases
    able = (n for n in range(most, fewest, -1) if _lasts_s(closed, n, step_s) <= limit_s)
    return next(able, fewest)


def _lasts_s(closed: Mapping[str, Array | float], count: int, engine_step_s: float) -> float:
    """Long enough for so many impacts and what their contacts add."""
    return ends_s(closed, count + 1) + _AFTER_S + CONTACT_STEPS * engine_step_s * count


def _drag(roles: Roles, values: Mapping[str, Array | float]) -> dict[str, Array | float]:
    """The drag that the scene can have."""
    return {"drag_k": bounce_models.drag_of(values) if roles.has_drag else 0.0}
