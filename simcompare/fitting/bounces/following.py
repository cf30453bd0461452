"""Which flight each sample of a filmed ball belongs to, from one motion fitted to all of them.

The motion is the richest closed form: a power law, drag and a scale of the picture. It begins with
two flights between kinks, and one flight after the other is added as it foretells them. A flight
begins and ends where the fitted motion meets the floor, so cut and fit are repeated until neither
changes. A flight is used where it lies near the place that the flights before it foretell, to a
tenth of its height. Within a flight a sample is rejected only where no ball in free flight can be,
whatever the law of restitution: the samples deviate from the motion by a straight line, for the
flight's own apex may have another time and height.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from simcompare.fitting.bounces.bounce_models import Bounces
from simcompare.fitting.bounces.flights import MIN_SAMPLES, MOST, OUTLIER, Samples, no_flights
from simcompare.fitting.bounces.lines import Line, shared
from simcompare.fitting.bounces.motion import UNKNOWNS, Motion, nearest, problem_of
from simcompare.fitting.bounces.problem import Problem
from simcompare.model.trajectory import Array
from simcompare.statistics.agreement import MAD_TO_SD

#: bounces lower than so many standard deviations of a height say nothing
LOWEST = 3.0
#: part of a flight at the open end that is not used yet, for its end is foretold only
_GUARD = 0.1
#: repeats of cut and fit
_REPEATS = 12
#: flights in between that may be hidden
_HIDDEN = 1
#: chance of a scatter about an arc below which it is no flight
_RARE = 1e-6
#: nothing flies where chi squared of a flight is so much above that of a straight line
_STRAIGHT = 4.0
#: part of its height by which drag that is not known yet bends a flight
_BENT = 0.01
#: part of its height by which a flight may be off, for restitutions scatter
_VAGUE = 0.1
HELD = "before the ball falls"
TOO_LOW = "bounces no higher than the noise"
NOT_SEEN = f"no undisturbed flight of at least {MIN_SAMPLES} samples"


@dataclass(frozen=True)
class _Cut:
    """Samples, and the flights that a motion makes of them.

    Attributes:
        seen: the samples.
        u: of each, the larger of the stated one and the scatter (n,) [m].
        motion: fitted to the samples that are used.
        last: number of the last flight that is used.
        disturbed: numbers of flights before it that are not used.
        flight: number of the flight, -1 where a sample is not used (n,).
        why: of those that lie in a flight, by index.
    """

    seen: Samples
    u: Array
    motion: Motion
    last: int = 1
    disturbed: frozenset[int] = frozenset()
    flight: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    why: Mapping[int, str] = field(default_factory=dict)

    @property
    def release_s(self) -> float:
        """When the first flight that is used begins to fall [s]."""
        return float(self.motion.values["release_time_s"])

    @property
    def is_told(self) -> bool:
        """Whether the samples that are used suffice for a motion."""
        return bool(np.count_nonzero(self.flight >= 0) >= len(UNKNOWNS))

    @property
    def bounces(self) -> Bounces:
        """Up to the impact after the last flight."""
        return self.motion.bounces(self.last + 1)


def follow(
    seen: Samples, noise: float, gravity: float, start: Mapping[str, float]
) -> tuple[NDArray[np.int64], dict[int, str]]:
    """Number of the flight of each sample, -1 where it is not used, and why, by index.

    Args:
        seen: the samples.
        noise: a first guess of the scatter [m].
        gravity: free fall [m/s²].
        start: the motion as two flights tell it.

    Raises:
        InputError: too few samples follow any motion.
    """
    u = np.where(np.isfinite(seen.u_m), seen.u_m, noise)
    x = np.array([start.get(name, 0.0) for name in UNKNOWNS])
    at_first = np.zeros(len(u), dtype=np.int64)
    motion = Motion(problem_of(seen.time_s, seen.height_m, u, at_first, gravity), x)
    cut = _settled(_Cut(seen, u, motion))
    for grown in (_one_later, _one_earlier):
        while (longer := _longer(cut, grown)) is not None:
            cut = longer
    cut = _settled(cut, guard=0.0)
    while cut.last > 1 and _ends_badly(cut):
        cut = _settled(replace(cut, last=cut.last - 1), guard=0.0)
    if not cut.is_told:
        raise no_flights(seen.source)
    end = TOO_LOW if _is_low(cut) else NOT_SEEN
    return cut.flight, {k: cut.why.get(k, end) for k in np.flatnonzero(cut.flight < 0).tolist()}


def _longer(cut: _Cut, grown: Callable[[_Cut], tuple[_Cut, int] | None]) -> _Cut | None:
    """The same with the next flight that is seen where it is foretold; nothing where none is."""
    for _ in range(_HIDDEN + 1):
        found = grown(cut)
        if found is None:
            return None
        cut, number = found
        # a fit finds bounces in much, so the flight must be where it was foretold too
        foretold = replace(cut, u=cut.u + _BENT * cut.bounces.apex_m[number])
        if _flies(foretold, number):
            settled = _settled(cut)
            if settled.is_told and _flies(settled, number):
                return settled
        cut = replace(cut, disturbed=cut.disturbed | {number})
    return None


def _one_later(cut: _Cut) -> tuple[_Cut, int] | None:
    """The same up to the next flight, and its number; nothing where it cannot be seen."""
    return None if _is_low(cut) else (replace(cut, last=cut.last + 1), cut.last + 1)


def _one_earlier(cut: _Cut) -> tuple[_Cut, int] | None:
    """The same from the flight before the first on."""
    if not np.any(cut.seen.time_s < cut.release_s):
        return None
    disturbed = frozenset(number + 1 for number in cut.disturbed)
    motion = cut.motion.one_earlier()
    return replace(cut, motion=motion, last=cut.last + 1, disturbed=disturbed), 0


def _ends_badly(cut: _Cut) -> bool:
    """Whether the end of the last flight is off and the ball is not seen afterwards: a catch."""
    end = int(np.searchsorted(cut.seen.time_s, cut.bounces.impact_s[-1]))
    return not _is_low(cut) and end < len(cut.seen.time_s) and end - 1 in cut.why


def _settled(cut: _Cut, guard: float = _GUARD) -> _Cut:
    """Cut and fit repeated until the flights do not change."""
    for _ in range(_REPEATS):
        whole = _assigned(cut, guard)
        held = np.flatnonzero(cut.seen.time_s < cut.release_s)
        why = dict.fromkeys(held.tolist(), HELD)
        disturbed = np.flatnonzero(np.isin(whole, list(cut.disturbed)))
        why |= dict.fromkeys(disturbed.tolist(), NOT_SEEN)
        lines = _lines(cut, _without(whole, why))
        scatter = _scatter(lines)
        u = np.fmax(cut.seen.u_m, scatter) if scatter > 0 else cut.u
        why |= {k: text for line in lines for k, text in _off(line, u).items()}
        flight = _without(whole, why)
        same = np.array_equal(flight, cut.flight)
        cut = replace(cut, u=u, flight=flight, why=why)
        if same or not cut.is_told:
            break
        cut = replace(cut, motion=nearest(_problem(cut), cut.motion.x))
    return cut


def _problem(cut: _Cut) -> Problem:
    """The fit of the motion to the samples that are used."""
    used, gravity = cut.flight >= 0, cut.motion.problem.fixed["gravity_m_s2"]
    time, height = cut.seen.time_s[used], cut.seen.height_m[used]
    return problem_of(time, height, cut.u[used], cut.flight[used], gravity)


def _without(flight: NDArray[np.int64], why: Mapping[int, str]) -> NDArray[np.int64]:
    left = flight.copy()
    left[list(why)] = -1
    return left


def _assigned(cut: _Cut, guard: float) -> NDArray[np.int64]:
    """The flight in which each sample lies, -1 after the last."""
    impacts = cut.bounces.impact_s
    flight = np.searchsorted(impacts, cut.seen.time_s).astype(np.int64)
    end = impacts[-1] - guard * (impacts[-1] - impacts[-2])
    return np.where(cut.seen.time_s < end, flight, -1)


def _lines(cut: _Cut, flight: NDArray[np.int64]) -> list[Line]:
    """The line in the residuals that most samples of a flight share, of flights with enough."""
    time = cut.seen.time_s
    residual = cut.seen.height_m - cut.motion.height(time, np.maximum(flight, 0))
    found = []
    for number in range(int(flight.max(initial=-1)) + 1):
        own = np.flatnonzero(flight == number)
        if len(own) >= MIN_SAMPLES:
            found.append(shared(own, time[own], residual[own], OUTLIER * cut.u[own]))
    return found


def _scatter(lines: list[Line]) -> float:
    """Standard deviation about the lines; 0 where nothing tells it."""
    inner = [line.residual[line.on] for line in lines]
    free = sum(max(len(one) - 2, 0) for one in inner)
    if not free:
        return 0.0
    every = np.concatenate(inner)
    return MAD_TO_SD * float(np.median(np.abs(every))) * float(np.sqrt(len(every) / free))


def _off(line: Line, u: Array) -> dict[int, str]:
    """Samples that do not share their flight with its other samples."""
    off = np.abs(line.residual) > OUTLIER * u[line.index] * line.spread
    return {
        k: f"{1e3 * by:.0f} mm off the flight of its neighbours"
        for k, by in zip(line.index[off].tolist(), line.residual[off], strict=True)
    }


def _is_low(cut: _Cut) -> bool:
    """Whether the next bounce is no higher than the noise."""
    apex = cut.bounces.apex_m[-1] / cut.motion.values["scale"]
    return bool(apex < LOWEST * float(np.median(cut.u)))


def _flies(cut: _Cut, number: int) -> bool:
    """Whether most samples of a flight are on one arc, and not as well on a straight line."""
    from scipy import stats

    own = (_assigned(cut, _GUARD) == number) & (cut.seen.time_s >= cut.release_s)
    lines = _lines(cut, np.where(own, number, -1))
    if not lines:
        return False
    (line,) = lines
    on = line.index[line.on]
    flying = float(np.sum((line.residual[line.on] / cut.u[on]) ** 2))
    t, y, w = cut.seen.time_s[on], cut.seen.height_m[on], 1 / cut.u[on]
    straight = float(np.sum((w * (y - np.polyval(np.polyfit(t, y, 1, w=w), t))) ** 2))
    by_chance = stats.chi2.sf(flying, max(len(on) - 2, 1)) > _RARE
    off = abs(line.level) - OUTLIER * float(np.median(cut.u))
    is_near = off < _VAGUE * float(cut.bounces.apex_m[number])
    is_most = len(on) >= MOST * len(line.on)
    return bool(is_near and is_most and by_chance and flying < straight + _STRAIGHT)
