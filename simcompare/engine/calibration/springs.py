"""The stiffest spring and damper that bounces alike in every phase of a fixed step.

What a spring and damper does depends mainly on √k·dt and the damping ratio, and a stiff one on
where in a step the contact begins; the scatter grows with √k·dt, with islands where a contact lasts
a whole number of steps. The search climbs from the softest that the depth allows until the scatter
is too large, first without an engine, on :class:`SteppedDashpot`, then from there in the engine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from simcompare.engine.calibration.calibration import (
    PHASES,
    Calibration,
    CannotCalibrate,
    Counted,
    refuse_extremes,
    solve,
    verified,
)
from simcompare.engine.calibration.drops import Bounces, Drops, even_phases
from simcompare.engine.calibration.stepped_dashpot import SteppedDashpot
from simcompare.engine.dashpot import damping_ratio, restitution

#: largest scatter over the phases at the first impact, as part of e
SCATTER = 0.02
#: largest depth at the first impact, as part of the body's smallest size
DEPTH = 0.5
#: √k·dt above which a contact lasts less than four steps, and anything may happen
MAX_PHASE = 0.8
#: smallest restitution that is tried
MIN_RESTITUTION = 0.1
#: the search keeps this part of both limits, since other phases give a little more
_MARGIN = 0.95
#: √k·dt below which a contact lasts so many hundred steps that nothing can be gained by less
_SOFTEST_PHASE = 0.005
#: √k·dt up to which the scatter grows evenly; where it is less, the search may leap
_SMOOTH_PHASE = 0.22
#: factor from one √k to the next where it may leap and where not, and where the search ends
_LEAP, _CLIMB, _CLOSE = 1.5, 1.04, 1.01
#: how much stiffer than the softest one a steadier one is looked for
_STIFFER = (1.05, 1.1, 1.2, 1.35, 1.5)


@dataclass(frozen=True)
class _Spring:
    """One spring and damper, and what it did."""

    omega: float
    part: float
    damping: float
    bounces: Bounces

    @property
    def numbers(self) -> tuple[float, float]:
        return (-(self.omega**2), -self.damping)

    @property
    def depth_m(self) -> float:
        return float(self.bounces.penetration_m.max())


@dataclass(frozen=True)
class _SpringSearch:
    """What is looked for, and where."""

    drops: Drops
    e: float
    speed_m_s: float
    step_s: float
    depth_m: float
    scatter: float = SCATTER

    def on(self, drops: Drops, step_s: float) -> _SpringSearch:
        return replace(self, drops=drops, step_s=step_s)

    def spring(self, omega: float, factor: float = 1.0) -> _Spring | None:
        """The damper for a stiffness; ``factor`` guesses it in parts of the continuous one."""
        zeta = damping_ratio(self.e)
        whole, phases = 2 * zeta * omega, even_phases(PHASES)

        def bounce(part: float) -> Bounces:
            return self.drops((-(omega**2), -part * whole), self.speed_m_s, phases)

        slope = (restitution(1.01 * zeta) - restitution(0.99 * zeta)) / 0.02
        try:
            part, bounces = solve(bounce, self.e, (0.1, 4.0), factor, slope)
        except CannotCalibrate:
            return None
        return _Spring(omega, part, part * whole, bounces)

    def is_steady(self, spring: _Spring | None) -> bool:
        return spring is not None and spring.bounces.scatter <= _MARGIN * self.scatter * self.e

    def is_shallow(self, spring: _Spring | None) -> bool:
        return spring is not None and spring.depth_m < self.depth_m

    def softest(self) -> _Spring | None:
        """The spring that is as deep as allowed; ``None`` if none bounces at the step."""
        zeta = damping_ratio(self.e)
        omega = restitution(zeta) ** 0.5 * self.speed_m_s / (_MARGIN * self.depth_m)
        omega = max(omega, _SOFTEST_PHASE / self.step_s)
        spring, part = None, 1.0
        for _ in range(8):
            if omega * self.step_s > MAX_PHASE:
                return None
            spring = self.spring(omega, part)
            if spring is None:
                return None
            part, deeper = spring.part, spring.depth_m / (_MARGIN * self.depth_m)
            if abs(deeper - 1) < 0.01 or (deeper < 1 and omega * self.step_s <= _SOFTEST_PHASE):
                break
            omega *= deeper
        return spring

    def steadiest(self) -> _Spring | None:
        """The one that scatters least within both limits: the softest, or near it."""
        softest = self.softest()
        if softest is None:
            return None
        tried = [softest]
        for stiffer in _STIFFER:
            if stiffer * softest.omega * self.step_s > MAX_PHASE:
                break
            tried += [s for s in [self.spring(stiffer * softest.omega, softest.part)] if s]
        fitting = [s for s in tried if self.is_steady(s) and self.is_shallow(s)]
        return min(fitting, key=lambda spring: spring.bounces.scatter, default=None)

    def stiffest(self) -> _Spring | None:
        """The last steady spring before the first that is not, climbing from the softest."""
        spring = self.softest()
        if not self.is_steady(spring):
            return None
        assert spring is not None
        limit, smooth = MAX_PHASE / self.step_s, _SMOOTH_PHASE / self.step_s
        high = limit
        while True:
            omega = max(_CLIMB * spring.omega, min(_LEAP * spring.omega, smooth))
            if omega >= limit:
                break
            stiffer = self.spring(omega, spring.part)
            if not self.is_steady(stiffer):
                high = omega
                break
            assert stiffer is not None
            spring = stiffer
        while high > _CLOSE * spring.omega:
            omega = (spring.omega + high) / 2
            stiffer = self.spring(omega, spring.part)
            if self.is_steady(stiffer):
                assert stiffer is not None
                spring = stiffer
            else:
                high = omega
        return spring


def calibrate_spring(
    drops: Drops,
    e: float,
    speeds_m_s: Sequence[float],
    step_s: float,
    smallest_size_m: float,
    gravity_m_s2: float,
    drops_at: Callable[[float], Drops] | None = None,
) -> Calibration:
    """Finds the stiffest spring and damper, scattering by 2 % at most, whose mean is ``e``.

    Args:
        drops: the engine; its numbers are (-k, -b), stiffness [1/s²] and damping [1/s] per unit of
            mass.
        e: restitution, 0.1 … 0.99.
        speeds_m_s: speed of the first impact, then those at which it is measured as well [m/s].
        step_s: the engine's time step [s].
        smallest_size_m: the body's smallest size, a sphere's diameter [m]; half of it is the
            largest depth.
        gravity_m_s2: acceleration towards the floor [m/s²].
        drops_at: the engine with another step [s]; with it the longest step is confirmed there.

    Raises:
        CannotCalibrate: there is none at this step; names the longest step with one.
    """
    refuse_extremes(e)
    if e < MIN_RESTITUTION:
        raise CannotCalibrate(
            f"no spring and damper is calibrated for a restitution of {e:g}, below"
            f" {MIN_RESTITUTION:g}"
        )
    counted = Counted(drops)
    search = _SpringSearch(counted, e, float(speeds_m_s[0]), step_s, DEPTH * smallest_size_m)
    spring = _in_engine(search, gravity_m_s2)
    if spring is not None:
        return verified(counted, e, spring.numbers, speeds_m_s, step_s)
    longest_s = _longest_step(search, gravity_m_s2, drops_at)
    possible = (
        "none was found at shorter steps either"
        if math.isnan(longest_s)
        else f"the longest step below it that has one is {longest_s * 1e3:.3g} ms"
    )
    raise CannotCalibrate(
        f"no spring and damper gives a restitution of {e:g} at {speeds_m_s[0]:.3g} m/s with a step"
        f" of {step_s * 1e3:.3g} ms, a scatter of {search.scatter * e:.2g} and a depth below"
        f" {search.depth_m * 1e3:.3g} mm; {possible}",
        longest_s,
    )


def find_spring(
    drops: Drops,
    e: float,
    speed_m_s: float,
    step_s: float,
    gravity_m_s2: float,
    depth_m: float,
    scatter_part: float = SCATTER,
    *,
    steadiest: bool = False,
) -> tuple[float, float] | None:
    """Numbers of a spring and damper within both limits, ``None`` if there are none.

    Args:
        drops: the engine, as for :func:`calibrate_spring`.
        e: restitution.
        speed_m_s: speed of the impact [m/s].
        step_s: the engine's time step [s].
        gravity_m_s2: acceleration towards the floor [m/s²].
        depth_m: largest penetration [m].
        scatter_part: largest standard deviation over the phases, as part of ``e``.
        steadiest: the one that scatters least, instead of the stiffest.
    """
    search = _SpringSearch(drops, e, speed_m_s, step_s, depth_m, scatter_part)
    found = search.steadiest() if steadiest else _in_engine(search, gravity_m_s2)
    return None if found is None else found.numbers


def damped_for(
    drops: Drops, e: float, speed_m_s: float, step_s: float, numbers: tuple[float, ...]
) -> tuple[float, ...]:
    """The same stiffness with the damper that gives another restitution.

    Raises:
        CannotCalibrate: no damper gives it.
    """
    omega = math.sqrt(-numbers[0])
    part = -numbers[1] / (2 * damping_ratio(e) * omega)
    found = _SpringSearch(drops, e, speed_m_s, step_s, math.inf).spring(omega, part)
    if found is None:
        raise CannotCalibrate(f"no damper gives a restitution of {e:g} with that stiffness")
    return found.numbers


def _in_engine(search: _SpringSearch, gravity_m_s2: float) -> _Spring | None:
    """The spring found without the engine, made softer until it is steady in the engine too."""
    model = search.on(SteppedDashpot(search.step_s, gravity_m_s2), search.step_s)
    guess = model.stiffest()
    if guess is None:
        return None
    omega = guess.omega
    for _ in range(8):
        spring = search.spring(omega, guess.part)
        if not search.is_shallow(spring):
            return None
        if search.is_steady(spring):
            return spring
        omega *= 0.97
    return None


def _longest_step(
    search: _SpringSearch, gravity_m_s2: float, drops_at: Callable[[float], Drops] | None
) -> float:
    """The longest step with a steady spring, to two digits [s]; NaN if there is none."""

    def is_possible(step_s: float) -> bool:
        model = search.on(SteppedDashpot(step_s, gravity_m_s2), step_s)
        return model.is_steady(model.softest())

    # from the step that was asked for downwards, by two digits at a time: between two steps that
    # have a spring there may be one that has none
    step_s = _two_digits_down(search.step_s * (1 - 1e-9))
    while step_s > search.step_s / 1000:
        if is_possible(step_s) and (
            drops_at is None
            or _in_engine(search.on(drops_at(step_s), step_s), gravity_m_s2) is not None
        ):
            return step_s
        step_s = _two_digits_down(step_s * (1 - 1e-9))
    return math.nan


def _two_digits_down(value: float) -> float:
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return round(math.floor(value / unit * (1 + 1e-12)) * unit, 12)
