"""An engine's own numbers for a restitution, and what bounces do with them."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.model.plain import Finite


@dataclass(frozen=True)
class AtSpeed:
    """What bounces at one speed do, over phases that the search did not use.

    Attributes:
        speed_m_s: speed of the impact [m/s].
        restitution: mean over the phases [1]; NaN if some drops are not followed by a flight.
        scatter: standard deviation over the phases [1].
        penetration_m: largest depth in any phase [m].
        contact_s: mean time in which a force acts [s].
        delay_s: mean delay of the next impact against an instantaneous bounce [s].
    """

    speed_m_s: float
    restitution: Finite
    scatter: Finite
    penetration_m: Finite
    contact_s: Finite
    delay_s: Finite


@dataclass(frozen=True)
class TuningRow:
    """How the numbers for one restitution of a scene were found.

    Attributes:
        pairs: names of the bodies of each pair that has them.
        restitution: what was wanted [1].
        numbers: the engine's own.
        speed_m_s: of the impact for which they were sought.
        step_s: the engine's step.
        size_m: of the sphere that was dropped.
        gravity_m_s2: along the normal of the contact.
        notes: in what the drop stands for something else than the scene.
        stall_speed_m_s: impacts of this speed lose no more; 0 where the body comes to rest [m/s].
        drops: how many drops it took.
        at: what bounces do at the speeds of the first impacts.
        checks: the same from half and from double the height of the first impact.
    """

    pairs: tuple[tuple[str, str], ...]
    restitution: float
    numbers: tuple[float, ...]
    speed_m_s: float
    step_s: float
    size_m: float = 0.0
    gravity_m_s2: float = 0.0
    notes: tuple[str, ...] = ()
    stall_speed_m_s: float = 0.0
    drops: int = 0
    at: tuple[AtSpeed, ...] = ()
    checks: tuple[AtSpeed, ...] = ()
