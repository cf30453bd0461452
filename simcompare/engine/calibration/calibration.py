"""Numbers of an engine's own contact solver that give a pair its restitution at one fixed step.

They are found from one-bounce drops on the contact, never from the run that is judged. An engine
with a coefficient gets the one whose mean over the phases of the step is right at the speed of the
first impact. One with a spring and damper gets the stiffest that bounces alike in every phase.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.engine.calibration.drops import Bounces, Drops, even_phases
from simcompare.errors import Unsupported
from simcompare.model.trajectory import Array
from simcompare.model.tuning import AtSpeed

#: phases of the step in the search, and as many others between them in the check
PHASES = 25
#: where the search for a number stops: deviation of the mean from e, as part of it
AIM = 3e-4
#: largest deviation of the mean from e in the phases that the search did not use, as part of it
ALLOWED = 5e-3
#: largest restitution: above it a step's errors are as large as what a bounce loses
MAX_RESTITUTION = 0.99
#: most attempts at one number
_ATTEMPTS = 12


class CannotCalibrate(Unsupported):
    """No number of the engine gives the restitution at this step; says what is possible.

    Attributes:
        longest_step_s: longest step with which there is one [s]; NaN where none is known.
    """

    def __init__(self, sentence: str, longest_step_s: float = math.nan) -> None:
        self.longest_step_s = longest_step_s
        super().__init__(sentence)

    def of(self, engine: str) -> CannotCalibrate:
        """The same with the engine's name before it."""
        return CannotCalibrate(f"{engine}: {self}", self.longest_step_s)


@dataclass(frozen=True)
class Calibration:
    """Numbers for an engine, and what they do.

    Attributes:
        restitution: what was asked for [1].
        numbers: the engine's parameters.
        at: what bounces do at the speeds that were given, the first impact first.
        checks: the same from half and from double the height of the first impact.
        stall_speed_m_s: impacts of this speed lose no more, so that the body hops for ever [m/s];
            0 where it comes to rest. Hops of a few steps count as rest.
        drops: how many drops it took.
    """

    restitution: float
    numbers: tuple[float, ...]
    at: tuple[AtSpeed, ...] = ()
    checks: tuple[AtSpeed, ...] = ()
    stall_speed_m_s: float = 0.0
    drops: int = 0


class Counted:
    """Counts the drops of an engine."""

    def __init__(self, drops: Drops) -> None:
        self._drops, self.count = drops, 0

    def __call__(self, numbers: tuple[float, ...], speed_m_s: float, phases: Array) -> Bounces:
        """The engine's own drops."""
        self.count += len(phases)
        return self._drops(numbers, speed_m_s, phases)


def calibrate_coefficient(
    drops: Drops, e: float, speeds_m_s: Sequence[float], step_s: float, gravity_m_s2: float
) -> Calibration:
    """Finds the coefficient whose mean restitution at the first speed is ``e``.

    Args:
        drops: the engine; its number is the coefficient, which is 0 … 1.
        e: restitution, 0 … 0.99; for 0 the coefficient is 0 and nothing is dropped.
        speeds_m_s: speed of the first impact, then those at which it is measured as well [m/s].
        step_s: the engine's time step [s].
        gravity_m_s2: acceleration towards the floor [m/s²].

    Raises:
        CannotCalibrate: nothing bounces at the first speed, or no coefficient is right.
    """
    if e == 0:
        return Calibration(0.0, (0.0,))
    refuse_extremes(e)
    counted = Counted(drops)
    p = coefficient_for(counted, e, speeds_m_s[0], step_s)
    stall = _stall_speed(counted, p, step_s, gravity_m_s2)
    return verified(counted, e, (p,), speeds_m_s, step_s, stall)


def coefficient_for(drops: Drops, e: float, speed_m_s: float, step_s: float) -> float:
    """The coefficient whose mean restitution at a speed is ``e``.

    Raises:
        CannotCalibrate: there is none.
    """

    def bounce(p: float) -> Bounces:
        return drops((p,), speed_m_s, even_phases(PHASES))

    try:
        return solve(bounce, e, (0.0, 1.0), e, 1.0)[0]
    except CannotCalibrate as error:
        raise CannotCalibrate(
            f"no coefficient gives a restitution of {e:g} at {speed_m_s:.3g} m/s with a step of"
            f" {step_s * 1e3:.3g} ms: {error}"
        ) from None


def refuse_extremes(e: float) -> None:
    """Refuses a restitution that no fixed step can give.

    Raises:
        CannotCalibrate: ``e`` is negative or above 0.99.
    """
    if not 0 <= e <= MAX_RESTITUTION:
        raise CannotCalibrate(
            f"a restitution is calibrated from 0 to {MAX_RESTITUTION:g}, not {e:g}"
        )


def solve(
    bounce: Callable[[float], Bounces],
    e: float,
    bounds: tuple[float, float],
    start: float,
    slope: float,
) -> tuple[float, Bounces]:
    """The x whose mean restitution is ``e``, by secants that never leave a shrinking bracket.

    Args:
        bounce: drops the body in all phases with a value of x; the mean grows or falls with it.
        e: restitution to meet.
        bounds: least and largest x; the largest may be the solution.
        start: first guess.
        slope: change of the mean restitution with x there; its sign holds everywhere.

    Returns:
        The value and its drops.

    Raises:
        CannotCalibrate: there is none; says why.
    """
    low, high = bounds
    x = start
    last: tuple[float, float] | None = None
    best: tuple[float, float, Bounces | None] = (math.inf, start, None)
    for _ in range(_ATTEMPTS):
        found = bounce(x)
        # a drop without a bounce returns nothing, which keeps the mean monotone
        mean = float(np.nan_to_num(found.restitution).mean())
        gap = mean - e
        if found.bounced and abs(gap) < best[0]:
            best = (abs(gap), x, found)
        if best[0] <= AIM * e:
            break
        if gap * slope > 0:
            high = x
        elif x >= high == bounds[1]:
            break
        else:
            low = x
        if last is not None and x != last[0]:
            steep = (gap - last[1]) / (x - last[0])
            # phases that jump can turn a short secant round
            slope = steep if 0.2 < steep / slope < 5 else slope
        last = (x, gap)
        x = min(x - gap / slope, bounds[1])
        if not low < x < high and not x == high == bounds[1]:
            x = (low + high) / 2
    reached, x, drops = best
    if drops is None:
        raise CannotCalibrate("some of the drops are not followed by a flight")
    if reached > ALLOWED / 2 * e:
        raise CannotCalibrate(f"the nearest is {drops.mean:.4f}, with {x:.6g}")
    return x, drops


def measured(
    drops: Drops, numbers: tuple[float, ...], speed_m_s: float, phases: int = PHASES
) -> AtSpeed:
    """Bounces at a speed, in phases halfway between those of the search; or in more of them."""
    found = drops(numbers, speed_m_s, even_phases(phases, 0.0))
    return AtSpeed(
        speed_m_s,
        found.mean,
        found.scatter,
        float(found.penetration_m.max()),
        float(found.contact_s.mean()),
        float(found.delay_s.mean()),
    )


def verified(
    drops: Counted,
    e: float,
    numbers: tuple[float, ...],
    speeds_m_s: Sequence[float],
    step_s: float,
    stall_m_s: float = 0.0,
) -> Calibration:
    """What the numbers do at all speeds, in phases that the search did not use.

    Raises:
        CannotCalibrate: the mean at the first speed is another one in those phases.
    """
    first = speeds_m_s[0]
    at = tuple(measured(drops, numbers, speed) for speed in speeds_m_s)
    if not abs(at[0].restitution - e) <= ALLOWED * e:
        raise CannotCalibrate(
            f"a restitution of {e:g} at {first:.3g} m/s depends too much on where in a step of"
            f" {step_s * 1e3:.3g} ms the impact falls: other phases give"
            f" {at[0].restitution:.4f}; simcompare tune tells at which step or speed it can be had"
        )
    checks = tuple(measured(drops, numbers, first * part) for part in (0.5**0.5, 2**0.5))
    return Calibration(e, numbers, at, checks, stall_m_s, drops.count)


def _stall_speed(drops: Drops, p: float, step_s: float, gravity_m_s2: float) -> float:
    """Speed at which a bounce gives back all [m/s]; 0 if there is none.

    Where the rebound is a part p of the speed after gravity has acted for a step, that is about
    p·g·dt/(1-p); there it is looked for.
    """
    if p >= 1:
        return 0.0
    low, high = (part * p * gravity_m_s2 * step_s / (1 - p) for part in (0.8, 1.25))
    slow = drops((p,), low, even_phases(PHASES)).mean
    if not slow > 1:
        return 0.0
    fast = drops((p,), high, even_phases(PHASES)).mean
    # the gain falls as 1/v
    return 1 / (1 / high + (1 / low - 1 / high) * (1 - fast) / (slow - fast))
