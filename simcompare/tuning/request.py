"""What is asked of a contact: which restitution, at which speeds and step, within which limits."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from simcompare.engine.calibration.engine_drops import PAIR
from simcompare.model.settings import TUNED, DropPlan

#: speeds at which a statement is measured, both ends of the range among them
SPEEDS = 9


@dataclass(frozen=True)
class Request:
    """What a contact is to do, or what is known of it.

    Attributes:
        restitution: Newton's coefficient that is wanted; ``None`` where numbers are given.
        lowest_m_s: slowest impact that counts.
        highest_m_s: fastest one.
        step_s: the engine's step.
        mass_kg: of the body.
        size_m: its smallest size, a sphere's diameter.
        gravity_m_s2: towards the floor.
        within: part of the restitution by which its mean may be off where the numbers hold.
        scatter_part: largest standard deviation over the phases of the step, as part of the
            restitution; ``None``: what the numbers are usually sought with.
        depth_m: largest penetration; ``None``: half the body.
        numbers: an engine's numbers, whose restitution is wanted; empty where they are sought.
        level: contact level of all else in the engine.
    """

    restitution: float | None
    lowest_m_s: float
    highest_m_s: float
    step_s: float
    mass_kg: float = 0.1
    size_m: float = 0.1
    gravity_m_s2: float = 9.80665
    within: float = 0.01
    scatter_part: float | None = None
    depth_m: float | None = None
    numbers: tuple[float, ...] = ()
    level: str = TUNED

    @property
    def speeds_m_s(self) -> tuple[float, ...]:
        """Speeds of the range, evenly spaced by their ratio; a single one where it is no range."""
        if self.lowest_m_s == self.highest_m_s:
            return (self.lowest_m_s,)
        return tuple(np.geomspace(self.lowest_m_s, self.highest_m_s, SPEEDS).tolist())

    @property
    def middle_m_s(self) -> float:
        """The middle speed of the range, by its ratio to both ends."""
        return math.sqrt(self.lowest_m_s * self.highest_m_s)

    def plan(self, step_s: float | None = None) -> DropPlan:
        """The drops that answer it, also with another step."""
        return DropPlan(
            (PAIR,),
            # the scene only has to bounce: its numbers stand for the restitution
            0.5 if self.restitution is None else self.restitution,
            self.highest_m_s,
            self.mass_kg,
            self.size_m,
            self.gravity_m_s2,
            self.step_s if step_s is None else step_s,
        )

    def with_step(self, step_s: float) -> Request:
        """The same with another step."""
        return replace(self, step_s=step_s)
