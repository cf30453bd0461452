"""Which flight each sample of a filmed ball belongs to, from one motion fitted to all of them.

The motion is the richest closed form: a power law, drag and a scale of the picture. It begins with
two flights between kinks, and one flight after the other is added as it foretells them. A flight
begins and ends where the fitted motion meets the floor, so cut and fit are repeated until neither
changes. A sample is rejected only where no ball in free flight can be, whatever the law of
restitution: the samples of a flight deviate from the motion by a straight line, for the flight's
own apex may have another time and height.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from simcompare.fitting.bounces import bounce_models
from simcompare.fitting.bounces.bounce_models import MODELS, Bounces
from simcompare.fitting.bounces.flights import MIN_SAMPLES, MOST, OUTLIER, Start
from simcompare.fitting.bounces.impacts import Impacts, Track
from simcompare.fitting.bounces.likelihood import minimum
from simcompare.fitting.bounces.lines import Line, shared
from simcompare.fitting.bounces.problem import Problem, build
from simcompare.model.trajectory import Array
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics.agreement import MAD_TO_SD

#: bounces lower than so many standard deviations of a height say nothing
LOWEST = 3.0
#: a rise before the first apex is one where it is so many standard deviations high
_RISE = 20.0
#: part of a flight at the open end that is not used yet, for its end is foretold only
_GUARD = 0.1
#: repeats of cut and fit
_REPEATS = 12
#: scatter of a flight that is rarer than this is no scatter
_BY_CHANCE = 1e-6
_MODEL = MODELS["power+drag"]
UNKNOWNS = (*_MODEL.own, "drop_height_m", "release_time_s", "floor_m", "scale")
#: what holds unknowns that few flights do not tell
_PRIORS = {"exponent": Prior(0.0, 0.1), "scale": Prior(1.0, 0.05)}
IN_HAND = "not released yet"
TOO_LOW = "bounces no higher than the noise"
TOO_SHORT = "bounces shorter than the time between samples"
NOT_FREE = "no free flight any more"
_NONE_LEFT = "after the last flight"


@dataclass(frozen=True)
class _Motion:
    """A closed form with its unknowns."""

    problem: Problem
    x: Array

    @property
    def values(self) -> dict[str, Array | float]:
        return self.problem.values(self.x, 0)

    def bounces(self, count: int) -> Bounces:
        return bounce_models.bounces(_MODEL, self.values, count)

    def height(self, time: Array, flight: NDArray[np.int64]) -> Array:
        """As the camera shows it."""
        found = self.bounces(int(flight.max(initial=0)) + 1)
        return bounce_models.height_at(found, self.values, time, flight)


@dataclass(frozen=True)
class _Cut:
    """Samples, and the flights that a motion makes of them.

    Attributes:
        time: (n,) [s].
        height: (n,) [m].
        stated: standard uncertainty, NaN where unknown (n,) [m].
        u: the larger of the stated one and the scatter (n,) [m].
        gravity: free fall [m/s²].
        motion: fitted to the samples that are used.
        last: number of the last flight that is used.
        flight: number of the flight, -1 where a sample is not used (n,).
        why: of those that lie in a flight, by index.
    """

    time: Array
    height: Array
    stated: Array
    u: Array
    gravity: float
    motion: _Motion
    last: int
    flight: NDArray[np.int64]
    why: dict[int, str]


def follow(
    time: Array, height: Array, stated: Array, noise: float, gravity: float, start: Start
) -> tuple[NDArray[np.int64], dict[int, str]]:
    """Number of the flight of each sample, -1 where it is not used, and why, by index.

    Args:
        time: (n,) [s].
        height: (n,) [m].
        stated: standard uncertainty, NaN where unknown (n,) [m].
        noise: a first guess of the scatter [m].
        gravity: free fall [m/s²].
        start: the motion as two flights tell it.
    """
    u = np.where(np.isfinite(stated), stated, noise)
    none = np.full(len(time), -1, dtype=np.int64)
    problem = _problem(time, height, u, none + 1, gravity)
    motion = _Motion(problem, np.array([start.values.get(name, 0.0) for name in UNKNOWNS]))
    cut = _settled(_Cut(time, height, stated, u, gravity, motion, start.last, none, {}))
    while not (end := _end(cut)):
        longer = _settled(replace(cut, last=cut.last + 1))
        if not _flies(longer):
            end = NOT_FREE
            break
        cut = longer
    cut = _settled(cut, guard=0.0)
    why = {int(k): cut.why.get(int(k), end) for k in np.flatnonzero(cut.flight < 0)}
    first = int(cut.flight[cut.flight >= 0].min())
    return np.where(cut.flight < 0, -1, cut.flight - first), why


def _problem(
    time: Array, height: Array, u: Array, flight: NDArray[np.int64], gravity: float
) -> Problem:
    return build(
        [Impacts(track=Track(time, height, u, flight))], _MODEL, unknowns=UNKNOWNS,
        fixed={"gravity_m_s2": gravity}, priors=_PRIORS,
    )  # fmt: skip


def _settled(cut: _Cut, guard: float = _GUARD) -> _Cut:
    """Cut and fit repeated until the flights do not change."""
    for _ in range(_REPEATS):
        whole = _assigned(cut, guard)
        held = _in_hand(cut, whole)
        flying = np.where(np.isin(np.arange(len(whole)), list(held)), -1, whole)
        lines = _lines(cut, flying)
        scatter = _scatter(lines)
        u = np.fmax(cut.stated, scatter) if scatter > 0 else cut.u
        why = held | {k: text for line in lines for k, text in _off(line, u).items()}
        flight = flying.copy()
        flight[list(why)] = -1
        used = flight >= 0
        problem = _problem(cut.time[used], cut.height[used], u[used], flight[used], cut.gravity)
        motion = _Motion(problem, minimum(problem, cut.motion.x).x[0])
        same = np.array_equal(flight, cut.flight)
        cut = replace(cut, u=u, motion=motion, flight=flight, why=why)
        if same:
            break
    return cut


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
    return {int(k): IN_HAND for k in before}


def _lines(cut: _Cut, flight: NDArray[np.int64]) -> list[Line]:
    """The line in the residuals that most samples of a flight share, of flights with enough."""
    residual = cut.height - cut.motion.height(cut.time, np.maximum(flight, 0))
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
        int(k): f"{1e3 * by:.0f} mm off the flight of its neighbours"
        for k, by in zip(line.index[off], line.residual[off], strict=True)
    }


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


def _flies(cut: _Cut) -> bool:
    """Whether the last flight is one: most of its samples on one arc, as near as the others."""
    whole = _assigned(cut, _GUARD)
    lines = _lines(cut, np.where(whole == cut.last, whole, -1))
    if not lines:
        return True
    (line,) = lines
    left = line.residual[line.on] / cut.u[line.index[line.on]]
    chance = stats.chi2.sf(float(left @ left), max(len(left) - 2, 1))
    return bool(len(left) >= MOST * len(line.on) and chance > _BY_CHANCE)
