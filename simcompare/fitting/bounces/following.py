"""Which flight each sample of a filmed ball belongs to, from one motion fitted to all of them.

The motion is the richest closed form: a power law, drag and a scale of the picture. It begins with
two flights between kinks, and one flight after the other is added as it foretells them. A flight
begins and ends where the fitted motion meets the floor, so cut and fit are repeated until neither
changes. A sample is rejected only where no ball in free flight can be, whatever the law of
restitution: the samples of a flight deviate from the motion by a straight line, for the flight's
own apex may have another time and height.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from simcompare.fitting.bounces.flights import MIN_SAMPLES, MOST, OUTLIER, no_flights
from simcompare.fitting.bounces.likelihood import minimum
from simcompare.fitting.bounces.lines import Line, shared
from simcompare.fitting.bounces.motion import UNKNOWNS, Motion, problem_of
from simcompare.model.trajectory import Array
from simcompare.statistics.agreement import MAD_TO_SD

#: bounces lower than so many standard deviations of a height say nothing
LOWEST = 3.0
#: a rise before the first apex is one where it is so many standard deviations high
_RISE = 20.0
#: part of a flight at the open end that is not used yet, for its end is foretold only
_GUARD = 0.1
#: repeats of cut and fit
_REPEATS = 12
#: samples scatter about their flight by less than so many standard deviations, or by chance
_AS_NEAR, _RARE = 2.0, 1e-6
#: a line through the heights of a ball that lies is likelier than that
_LIKELY = 1e-3
#: a ball lies where chi squared of bounces is so much above that of a line
_BETTER = 25.0
#: bounces that are looked at whether a ball lies
_MORE = 20
#: part of its height that a flight before the first that is fitted is uncertain by
_VAGUE = 0.1
IN_HAND = "not released yet"
TOO_LOW = "bounces no higher than the noise"
TOO_SHORT = "bounces shorter than the time between samples"
NOT_FREE = "no free flight any more"
DISTURBED = "no free flight"
AT_REST = "at rest"
_NONE_LEFT = "after the last flight"


@dataclass(frozen=True)
class _Cut:
    """Samples, and the flights that a motion makes of them.

    Attributes:
        time: (n,) [s].
        height: (n,) [m].
        stated: standard uncertainty, NaN where unknown (n,) [m].
        u: the larger of the stated one and the scatter (n,) [m].
        gravity: free fall [m/s²].
        source: name of the file.
        motion: fitted to the samples that are used.
        last: number of the last flight that is used.
        disturbed: numbers of flights before it that are not used.
        flight: number of the flight, -1 where a sample is not used (n,).
        why: of those that lie in a flight, by index.
    """

    time: Array
    height: Array
    stated: Array
    u: Array
    gravity: float
    source: str
    motion: Motion
    last: int = 1
    disturbed: frozenset[int] = frozenset()
    flight: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    why: dict[int, str] = field(default_factory=dict)


def follow(
    time: Array,
    height: Array,
    stated: Array,
    noise: float,
    gravity: float,
    start: Mapping[str, float],
    source: str,
) -> tuple[NDArray[np.int64], dict[int, str]]:
    """Number of the flight of each sample, -1 where it is not used, and why, by index.

    Args:
        time: (n,) [s].
        height: (n,) [m].
        stated: standard uncertainty, NaN where unknown (n,) [m].
        noise: a first guess of the scatter [m].
        gravity: free fall [m/s²].
        start: the motion as two flights tell it.
        source: name of the file.

    Raises:
        InputError: too few samples follow any motion.
    """
    u = np.where(np.isfinite(stated), stated, noise)
    problem = problem_of(time, height, u, np.zeros(len(time), dtype=np.int64), gravity)
    motion = Motion(problem, np.array([start.get(name, 0.0) for name in UNKNOWNS]))
    cut, end = _to_the_end(_settled(_Cut(time, height, stated, u, gravity, source, motion)))
    while (longer := _from_earlier(cut)) is not None:
        cut = longer
    cut = _settled(cut, guard=0.0)
    return cut.flight, {k: cut.why.get(k, end) for k in np.flatnonzero(cut.flight < 0).tolist()}


def _to_the_end(cut: _Cut) -> tuple[_Cut, str]:
    """One flight after the other added, as long as they fly, and why none is added any more."""
    while not (end := _end(cut)):
        longer = _settled(replace(cut, last=cut.last + 1))
        if _lies(longer):
            return cut, AT_REST
        if not _flies(longer):
            disturbed = cut.disturbed | {longer.last}
            beyond = replace(cut, last=cut.last + 2, disturbed=disturbed)
            longer = _settled(beyond)
            # a fit finds bounces in much, so the flight must be where it was foretold too
            if not (_flies(beyond, surely=True) and _flies(longer)):
                return cut, NOT_FREE
        cut = longer
    return cut, end


def _from_earlier(cut: _Cut) -> _Cut | None:
    """The same from one flight earlier on; nothing where the samples do not show it."""
    motion = cut.motion.one_earlier()
    impact = float(motion.bounces(1).impact_s[0])
    disturbed = frozenset(number + 1 for number in cut.disturbed)
    first = replace(cut, motion=motion, last=cut.last + 1, disturbed=disturbed)
    near = np.flatnonzero((cut.time < impact) & (cut.time > motion.values["release_time_s"]))
    seen = motion.height(cut.time[near], np.zeros(len(near), dtype=np.int64))
    off = np.abs(cut.height[near] - seen) > OUTLIER * cut.u[near] + _VAGUE * (
        seen - float(motion.values["floor_m"])
    )
    if not len(near) or np.mean(off) > 1 - MOST:
        return None
    longer = _settled(first)
    return longer if _flies(longer, 0) and _flies(longer, 1) else None


def _settled(cut: _Cut, guard: float = _GUARD) -> _Cut:
    """Cut and fit repeated until the flights do not change."""
    for _ in range(_REPEATS):
        whole = _assigned(cut, guard)
        why = _in_hand(cut, whole)
        why |= {k: DISTURBED for k in np.flatnonzero(np.isin(whole, list(cut.disturbed))).tolist()}
        flying = _without(whole, why)
        lines = _lines(cut, flying)
        scatter = _scatter(lines)
        u = np.fmax(cut.stated, scatter) if scatter > 0 else cut.u
        why |= {k: text for line in lines for k, text in _off(line, u).items()}
        why |= _outside(cut, flying)
        flight = _without(whole, why)
        used = flight >= 0
        if np.count_nonzero(used) < len(UNKNOWNS):
            raise no_flights(cut.source)
        problem = problem_of(cut.time[used], cut.height[used], u[used], flight[used], cut.gravity)
        motion = Motion(problem, minimum(problem, cut.motion.x).x[0])
        same = np.array_equal(flight, cut.flight)
        cut = replace(cut, u=u, motion=motion, flight=flight, why=why)
        if same:
            break
    return cut


def _without(flight: NDArray[np.int64], why: Mapping[int, str]) -> NDArray[np.int64]:
    left = flight.copy()
    left[list(why)] = -1
    return left


def _assigned(cut: _Cut, guard: float) -> NDArray[np.int64]:
    """The flight in which each sample lies, -1 after the last."""
    impacts = cut.motion.bounces(cut.last + 1).impact_s
    flight = np.searchsorted(impacts, cut.time).astype(np.int64)
    end = impacts[-1] - guard * (impacts[-1] - impacts[-2])
    return np.where(cut.time < end, flight, -1)


def _in_hand(cut: _Cut, flight: NDArray[np.int64]) -> dict[int, str]:
    """Samples before the ball falls; a rise is used as far back as it is seen."""
    release = float(cut.motion.values["release_time_s"])
    before = np.flatnonzero((flight == 0) & (cut.time < release))
    if not len(before):
        return {}
    seen = cut.motion.height(cut.time[before], flight[before])
    apart = np.abs(cut.height[before] - seen) > OUTLIER * cut.u[before]
    rise = int(np.flatnonzero(apart).max(initial=-1)) + 1
    tops = cut.motion.height(np.array([release]), np.zeros(1, dtype=np.int64))
    if rise < len(before) and tops[0] - seen[rise] > _RISE * cut.u[before[rise]]:
        before = before[:rise]
    return dict.fromkeys(before.tolist(), IN_HAND)


def _residual(cut: _Cut, flight: NDArray[np.int64]) -> Array:
    return cut.height - cut.motion.height(cut.time, np.maximum(flight, 0))


def _lines(cut: _Cut, flight: NDArray[np.int64]) -> list[Line]:
    """The line in the residuals that most samples of a flight share, of flights with enough."""
    residual = _residual(cut, flight)
    found = []
    for number in range(int(flight.max(initial=-1)) + 1):
        own = np.flatnonzero(flight == number)
        if len(own) >= MIN_SAMPLES:
            found.append(shared(own, cut.time[own], residual[own], OUTLIER * cut.u[own]))
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


def _outside(cut: _Cut, flight: NDArray[np.int64]) -> dict[int, str]:
    """Samples of short flights where a ball cannot be: below the floor, above the bounce before."""
    short = np.flatnonzero((flight > 0) & (np.bincount(flight + 1)[flight + 1] < MIN_SAMPLES))
    apexes = cut.motion.bounces(cut.last + 1).apex_m / cut.motion.values["scale"]
    above = cut.height[short] - float(cut.motion.values["floor_m"])
    limit = OUTLIER * cut.u[short]
    high = above > apexes[flight[short] - 1] + limit
    return dict.fromkeys(short[above < -limit].tolist(), "below the floor") | dict.fromkeys(
        short[high].tolist(), "higher than the bounce before"
    )


def _end(cut: _Cut) -> str:
    """Why no flight can be added; nothing where one can."""
    after = cut.last + 1
    found = cut.motion.bounces(after + 1)
    begin, end = found.impact_s[-2:]
    seen = found.apex_m[after] / cut.motion.values["scale"]
    if not np.any(cut.time > begin):
        return _NONE_LEFT
    if seen < LOWEST * float(np.median(cut.u)):
        return TOO_LOW
    return TOO_SHORT if end - begin < float(np.median(np.diff(cut.time))) else ""


def _flies(cut: _Cut, number: int | None = None, *, surely: bool = False) -> bool:
    """Whether a flight (the last) is one: most of its samples on one arc, as near as the others.

    Args:
        cut: the flights.
        number: of the flight.
        surely: whether too few samples to tell are a no.
    """
    number = cut.last if number is None else number
    whole = _without(_assigned(cut, _GUARD), _in_hand(cut, _assigned(cut, _GUARD)))
    lines = _lines(cut, np.where(whole == number, whole, -1))
    if not lines:
        return not surely
    (line,) = lines
    left = line.residual[line.on] / cut.u[line.index[line.on]]
    # a few samples of something else do not widen the median, a few flying ones may
    near = MAD_TO_SD * float(np.median(np.abs(left))) < _AS_NEAR
    by_chance = stats.chi2.sf(float(left @ left), max(len(left) - 2, 1)) > _RARE
    return bool(len(left) >= MOST * len(line.on) and (near or by_chance))


def _lies(cut: _Cut) -> bool:
    """Whether the ball lies, or rolls, from the last flight on: its heights are a straight line."""
    after = cut.time > cut.motion.bounces(cut.last).impact_s[-1]
    t, y, u = cut.time[after], cut.height[after], cut.u[after]
    if len(t) < MIN_SAMPLES:
        return False
    line = (y - np.polyval(np.polyfit(t, y, 1, w=1 / u), t)) / u
    flight = np.searchsorted(cut.motion.bounces(cut.last + _MORE).impact_s, t)
    heights = cut.motion.height(t, flight.astype(np.int64))
    bounces = (y - np.maximum(heights, float(cut.motion.values["floor_m"]))) / u
    by_chance = stats.chi2.sf(float(line @ line), len(t) - 2) > _LIKELY
    return bool(by_chance and bounces @ bounces > line @ line + _BETTER)
