"""What engines do in the experiments. A number is NaN where it could not be read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from simcompare.model.plain import Finite


@dataclass(frozen=True, kw_only=True)
class AtStep:
    """What is found at one of several steps.

    Attributes:
        step_s: the step.
        reason: why there is nothing at it; empty where there is something.
    """

    step_s: float
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class Spread:
    """What the drops at one speed and step do, over the phases of the step.

    Attributes:
        mean: mean restitution [1]; a drop without a bounce counts as 0, one that runs away as
            infinite.
        scatter: standard deviation [1].
        least: smallest.
        most: largest.
        bounced: part of the drops that are followed by a flight.
    """

    mean: Finite = math.nan
    scatter: Finite = math.nan
    least: Finite = math.nan
    most: Finite = math.nan
    bounced: Finite = math.nan


@dataclass(frozen=True, kw_only=True)
class SpreadAtSpeed(Spread):
    """The same at one of several speeds of the impact."""

    speed_m_s: float


@dataclass(frozen=True, kw_only=True)
class SpreadAtStep(AtStep, Spread):
    """The same at one of several steps."""


@dataclass(frozen=True)
class StepLimits:
    """Steps below and above the one that was asked for at which something is no longer right.

    Attributes:
        below_s: it is right down to this step; ``None``: at all that were tried.
        above_s: it is right up to this step; ``None``: at all that were tried.
    """

    below_s: float | None
    above_s: float | None


@dataclass(frozen=True, kw_only=True)
class BounceBehaviour:
    """How a sphere bounces on a plane.

    Attributes:
        numbers: the engine's own for the restitution, or the restitution where it is typed in.
        phases: by which parts of a step the drops are later.
        over_phase: restitution at each phase.
        over_speed: bounces at each speed of the impact, the slowest first.
        over_step: bounces at each step, with the numbers held.
        retuned: bounces at each step, with numbers that are found anew; only at "tuned".
        slowest_m_s: the slowest impact whose hop can be read at the step.
        dies_below_m_s: slower impacts give back less than half of what is wanted; ``None``: none.
        hops_at_m_s: slower impacts gain in the mean, faster ones lose; ``None``: it comes to rest.
        too_large: steps up to which the mean is not too large.
        too_small: steps up to which it is not too small.
        gains_above_s: longest step up to which no phase gains energy; ``None``: none does.
    """

    numbers: tuple[float, ...] = ()
    phases: tuple[float, ...]
    over_phase: tuple[float, ...]
    over_speed: tuple[SpreadAtSpeed, ...]
    over_step: tuple[SpreadAtStep, ...]
    retuned: tuple[SpreadAtStep, ...]
    slowest_m_s: float
    dies_below_m_s: float | None
    hops_at_m_s: float | None
    too_large: StepLimits
    too_small: StepLimits
    gains_above_s: float | None

    def at(self, speed_m_s: float) -> SpreadAtSpeed:
        """Spread at the speed that is nearest."""
        return min(self.over_speed, key=lambda row: abs(row.speed_m_s / speed_m_s - 1))


@dataclass(frozen=True, kw_only=True)
class Creep:
    """What a block does under a load that should not move it.

    Attributes:
        creep_m_s: mean speed along the plane.
        sinks_m: how far it sinks; by more than its height, it has fallen through the floor.
    """

    creep_m_s: Finite = math.nan
    sinks_m: Finite = math.nan


@dataclass(frozen=True, kw_only=True)
class CreepAtLoad(Creep):
    """The same under one of several loads, in parts of µ·N."""

    load: float


@dataclass(frozen=True, kw_only=True)
class Braking:
    """How a block that slides is braked.

    Attributes:
        braking: mean deceleration over µ·g, over several masses; infinite where it stops at once.
        braking_scatter: standard deviation over these.
        stops_at_once: whether it does.
    """

    braking: Finite = math.nan
    braking_scatter: Finite = math.nan
    stops_at_once: bool = False


@dataclass(frozen=True, kw_only=True)
class BrakingAtSpeed(Braking):
    """The same from one of several speeds."""

    speed_m_s: float


@dataclass(frozen=True, kw_only=True)
class Friction(Creep, Braking):
    """How a block is held and braked.

    Attributes:
        lets_go_at: load up to which it sticks [µ·N]; ``None``: the largest does not move it.
    """

    lets_go_at: float | None = None


@dataclass(frozen=True, kw_only=True)
class FrictionAtStep(AtStep, Friction):
    """The same at one of several steps."""


@dataclass(frozen=True, kw_only=True)
class FrictionBehaviour:
    """How dry friction holds and brakes a block on a plane.

    Attributes:
        lets_go_at: load up to which it sticks [µ·N]; ``None``: the largest does not move it.
        creep: under several loads.
        braking: from several speeds.
        over_step: all of it at each step.
    """

    lets_go_at: float | None
    creep: tuple[CreepAtLoad, ...]
    braking: tuple[BrakingAtSpeed, ...]
    over_step: tuple[FrictionAtStep, ...]

    def under(self, load: float) -> CreepAtLoad:
        """Creep under one of the loads."""
        return next(row for row in self.creep if row.load == load)


@dataclass(frozen=True, kw_only=True)
class Hinge:
    """How a hinge moves, each quantity over its closed form; infinite where the hinge is held.

    Attributes:
        damping: rate at which a spin dies away.
        damping_with_armature: the same with an armature.
        inertia: that a motor feels.
        frequency: of a sprung hinge.
        damping_ratio: of a sprung hinge.
        lacks: what the engine has not ("spring" for the last two), and why.
    """

    damping: Finite = math.nan
    damping_with_armature: Finite = math.nan
    inertia: Finite = math.nan
    frequency: Finite = math.nan
    damping_ratio: Finite = math.nan
    lacks: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class HingeAtStep(AtStep, Hinge):
    """The same at one of several steps."""


@dataclass(frozen=True, kw_only=True)
class JointBehaviour(Hinge):
    """How a hinge with damper, armature and spring moves, also over steps."""

    over_step: tuple[HingeAtStep, ...]


@dataclass(frozen=True)
class ForceReading:
    """A force that an engine gives, over its truth by Newton's second law.

    Attributes:
        ratio: mean, or amplitude.
        jitter: standard deviation about it.
        u: standard uncertainty of the mean.
    """

    ratio: Finite
    jitter: Finite
    u: Finite


@dataclass(frozen=True, kw_only=True)
class Forces:
    """Forces in several cases.

    Attributes:
        cases: what is read in each.
        lacks: cases in which the engine gives none, and why.
    """

    cases: Mapping[str, ForceReading] = field(default_factory=dict)
    lacks: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class ForcesAtStep(AtStep, Forces):
    """The same at one of several steps."""


@dataclass(frozen=True, kw_only=True)
class ForceBehaviour(Forces):
    """Which forces an engine gives, also over steps."""

    over_step: tuple[ForcesAtStep, ...]


#: what an engine does in any of the experiments
Behaviour = BounceBehaviour | FrictionBehaviour | JointBehaviour | ForceBehaviour
