"""One-bounce drops: what they tell of a contact, read from positions only."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from simcompare.model.trajectory import Array

#: a step is free flight where its acceleration is gravity's within this part of it; in an engine
#: as it comes the air may brake, which is still far from a contact
FREE_PART, BRAKED_PART = 0.02, 0.5
#: rounding of a height that an engine holds in single precision, as part of it
ROUNDING = 4e-7
#: free steps in a row that make a flight
MIN_FREE = 3
#: part of v/g that a drop may take, which from one impact to the next is 2
_THROWN = 1.9


@dataclass(frozen=True)
class Bounces:
    """What some drops with one speed did, each array (n,) over the phases of the time step.

    Attributes:
        restitution: √(apex after/apex before) [1]; NaN where no bounce was seen.
        penetration_m: largest depth of a sample below the contact [m].
        contact_s: time of the steps in which a force acted [s]; NaN where no bounce was seen.
        delay_s: how much later the next impact is than if the body had left the floor, as fast as
            it did, at the instant at which it arrived [s]; NaN where no bounce was seen.
    """

    restitution: Array
    penetration_m: Array
    contact_s: Array
    delay_s: Array

    @property
    def bounced(self) -> bool:
        """Whether every drop was followed by a flight."""
        return bool(np.isfinite(self.restitution).all())

    @property
    def mean(self) -> float:
        """Mean restitution over the phases; NaN if a drop did not bounce."""
        return float(self.restitution.mean())

    @property
    def scatter(self) -> float:
        """Standard deviation of the restitution over the phases; NaN if a drop did not bounce."""
        return float(self.restitution.std())


class Drops(Protocol):
    """An engine that lets a body drop on a contact; the scene is the same in every drop."""

    def __call__(self, numbers: tuple[float, ...], speed_m_s: float, phases: Array) -> Bounces:
        """Lets the body drop once for every phase.

        Args:
            numbers: the engine's parameters that stand for the restitution of the pair.
            speed_m_s: speed at which the body arrives at the floor [m/s].
            phases: by what part of the way of one step the start is higher (n,), 0 … 1.
        """
        ...


def even_phases(count: int, offset: float = 0.5) -> Array:
    """Phases (count,) spread evenly over a step, the first at ``offset`` parts of their spacing."""
    return (np.arange(count) + offset) / count


def slowest_m_s(step_s: float, gravity_m_s2: float) -> float:
    """Slowest impact that can follow a flight of enough steps, at any phase of a step [m/s]."""
    return (MIN_FREE + 1) * gravity_m_s2 * step_s / _THROWN


def start_above(
    speed_m_s: float, phase: float, step_s: float, gravity_m_s2: float, steps: int = 6
) -> tuple[float, float]:
    """Height [m] and downward speed [m/s] from which a body meets the floor with a speed.

    Args:
        speed_m_s: speed at the floor [m/s].
        phase: part of a step by which the drop takes longer.
        step_s: time step [s].
        gravity_m_s2: acceleration towards the floor [m/s²].
        steps: whole steps before the impact, fewer where gravity needs fewer to give that speed; a
            slow body is first on its way up.
    """
    # thrown up from the floor it would take twice as long as from its apex
    whole = min(steps, math.floor(_THROWN * speed_m_s / (gravity_m_s2 * step_s)) - 1)
    time_s = (whole + phase) * step_s
    if whole < MIN_FREE:  # too slow for a flight before it
        time_s = speed_m_s / gravity_m_s2
    return (speed_m_s - gravity_m_s2 * time_s / 2) * time_s, speed_m_s - gravity_m_s2 * time_s


def read_drop(
    height_m: Array,
    step_s: float,
    gravity_m_s2: float,
    radius_m: float = 0.0,
    free_part: float = FREE_PART,
) -> tuple[float, float, float, float]:
    """Restitution, penetration [m], contact time [s] and delay [s] of the first bounce.

    A step is free where the second difference of the heights is that of gravity. The free samples
    before and after the contact lie on parabolas; their apexes give the restitution, and where they
    cross height 0 gives the delay. All but the penetration are NaN if no flight follows.

    Args:
        height_m: height above that of the contact after every step, from the flight before (n,).
        step_s: time between the samples [s].
        gravity_m_s2: acceleration towards the floor [m/s²].
        radius_m: by which the position that an engine rounds is higher.
        free_part: part of gravity by which the acceleration of a free step may be another.
    """
    depth_m = max(0.0, -float(height_m.min()))
    fall_m = gravity_m_s2 * step_s**2
    surplus = np.abs(np.diff(height_m, 2) + fall_m)
    forced = surplus > free_part * fall_m + ROUNDING * (float(np.abs(height_m).max()) + radius_m)
    acted = np.flatnonzero(forced)
    nothing = (math.nan, depth_m, math.nan, math.nan)
    if len(acted) == 0:
        return nothing
    ends = [*acted[1:].tolist(), len(forced)]
    for last, following in zip(acted.tolist(), ends, strict=True):
        if following - last > MIN_FREE:
            break
    else:
        return nothing
    first = int(acted[0])
    before = _flight(height_m[: first + 2], 0, step_s, gravity_m_s2)
    after = _flight(height_m[last + 1 : following + 2], last + 1, step_s, gravity_m_s2)
    if after[0] <= 0 or before[0] <= 0:
        return nothing
    contact_s = (last - first + 1) * step_s
    down_s = before[1] + math.sqrt(2 * before[0] / gravity_m_s2)
    up_s = after[1] - math.sqrt(2 * after[0] / gravity_m_s2)
    return math.sqrt(after[0] / before[0]), depth_m, contact_s, up_s - down_s


def read_drops(
    heights_m: Sequence[Array],
    step_s: float,
    gravity_m_s2: float,
    radius_m: float = 0.0,
    free_part: float = FREE_PART,
) -> Bounces:
    """The same for several drops; the records may differ in length."""
    rows = [read_drop(h, step_s, gravity_m_s2, radius_m, free_part) for h in heights_m]
    return Bounces(*np.array(rows).T)


def _flight(height_m: Array, index: int, step_s: float, gravity_m_s2: float) -> tuple[float, float]:
    """Height and time of the apex of the parabola through free samples that begin at ``index``."""
    time_s = (np.arange(len(height_m)) - (len(height_m) - 1) / 2) * step_s
    straight = height_m + gravity_m_s2 * time_s**2 / 2
    speed = float(time_s @ straight) / float(time_s @ time_s)
    middle_s = (index + (len(height_m) - 1) / 2) * step_s
    apex_s = speed / gravity_m_s2
    return float(straight.mean()) + speed * apex_s / 2, middle_s + apex_s
