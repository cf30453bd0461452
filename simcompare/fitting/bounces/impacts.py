"""The instants and heights of one drop of a bouncing ball."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected

SOUND, CLOCKED, TRACK, TABLE = "sound", "stopwatch", "video track", "rebound heights"
INTERVALS = "time intervals"
#: names of recorded signals
LOUDNESS, HEIGHT = "sound", "height_m"
_NOTHING = np.empty(0)

#: most impacts of one drop: a steel ball of restitution 0.99 falls from 1 m to 0.1 mm in them
MAX_COUNT = 500


@dataclass(frozen=True)
class Track:
    """Height against time, every sample with the flight that it belongs to.

    Attributes:
        time_s: (n,) [s].
        height_m: above a level that need not be the floor (n,) [m].
        u_m: standard uncertainty, NaN where unknown (n,) [m].
        flight: number of the flight, 0 is the first fall (n,).
    """

    time_s: Array
    height_m: Array
    u_m: Array
    flight: NDArray[np.int64]


@dataclass(frozen=True)
class Signal:
    """What was recorded of a drop over time, as it is drawn.

    Attributes:
        name: "sound", or "height_m" above the level of the recording.
        time_s: on the recording's clock (n,) [s].
        values: (n,).
    """

    name: str
    time_s: Array
    values: Array


@dataclass(frozen=True)
class Flights:
    """Whole flights that were measured, from one impact to the next.

    Attributes:
        numbers: the impact at which each begins, first is 1 (n,).
        lengths_s: how long they lasted (n,) [s].
        covariance_s2: of the lengths; as if every u were 1 s where they are unknown (n, n) [s²].
        u_known: whether the uncertainties are stated.
    """

    numbers: NDArray[np.int64]
    lengths_s: Array
    covariance_s2: Array
    u_known: bool


@dataclass(frozen=True)
class Impacts:
    """What one drop of a ball left behind.

    Attributes:
        times_s: impact times on the recording's clock (n,) [s].
        u_s: their standard uncertainties, NaN where unknown (n,) [s].
        numbers: which impact each is, first is 1; a number that is left out was missed.
        kind: where they come from.
        source: name of the file.
        intervals_s: times between neighbouring impacts, each with an error of its own (k,) [s].
        u_intervals_s: their standard uncertainties, NaN where unknown (k,) [s].
        interval_numbers: the impact at which each interval begins, first is 1.
        heights_m: apex heights above the floor between impacts (m,) [m].
        u_heights_m: their standard uncertainties, NaN where unknown (m,) [m].
        height_numbers: after which impact each apex comes; 0 is the drop itself.
        track: samples of height against time, where there was a video.
        covariance_s2: of the times, where they are correlated (n, n) [s²].
        dropped: what was left out, and why.
        missed: numbers of impacts that were not recorded.
        notes: what else must be known, one sentence each.
        signal: the recording itself, where it is a sound or a video.
    """

    times_s: Array = field(default_factory=_NOTHING.copy)
    u_s: Array = field(default_factory=_NOTHING.copy)
    numbers: tuple[int, ...] = ()
    kind: str = SOUND
    source: str = ""
    intervals_s: Array = field(default_factory=_NOTHING.copy)
    u_intervals_s: Array = field(default_factory=_NOTHING.copy)
    interval_numbers: tuple[int, ...] = ()
    heights_m: Array = field(default_factory=_NOTHING.copy)
    u_heights_m: Array = field(default_factory=_NOTHING.copy)
    height_numbers: tuple[int, ...] = ()
    track: Track | None = field(default=None, repr=False)
    covariance_s2: Array | None = field(default=None, repr=False)
    dropped: tuple[Rejected, ...] = ()
    missed: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()
    signal: Signal | None = field(default=None, repr=False)

    @property
    def count(self) -> int:
        """Number of impacts that a model must give to be held against this."""
        flights = [] if self.track is None else self.track.flight.tolist()
        ends = [number + 1 for number in self.interval_numbers]
        return int(max((*self.numbers, *ends, *self.height_numbers, *flights, 1)))

    @property
    def rebounds(self) -> int:
        """Number of the last impact after which the ball was followed.

        After the last recorded time nothing tells how the ball left, so no restitution is known.
        """
        flights = [] if self.track is None else self.track.flight.tolist()
        ends = [number - 1 for number in self.numbers]
        return int(max((*ends, *self.interval_numbers, *self.height_numbers, *flights, 1)))

    @property
    def u_known(self) -> bool:
        """Whether every measured number has a stated uncertainty."""
        if self.track is not None:
            return bool(np.all(np.isfinite(self.track.u_m)))
        every = np.concatenate((self.u_s, self.u_intervals_s, self.u_heights_m))
        return bool(np.all(np.isfinite(every)))

    @property
    def flights(self) -> Flights:
        """Flights both of whose ends were recorded, or the measured intervals."""
        if len(self.intervals_s):
            u = np.where(np.isfinite(self.u_intervals_s), self.u_intervals_s, 1.0)
            numbers = np.array(self.interval_numbers, dtype=np.int64)
            known = bool(np.all(np.isfinite(self.u_intervals_s)))
            return Flights(numbers, self.intervals_s, np.diag(u**2), known)
        numbers = np.array(self.numbers, dtype=np.int64)
        at = np.flatnonzero(np.diff(numbers) == 1)
        change = np.zeros((len(at), len(numbers)))
        change[np.arange(len(at)), at], change[np.arange(len(at)), at + 1] = -1.0, 1.0
        covariance = change @ self.covariance(1.0) @ change.T
        known = bool(np.all(np.isfinite(self.u_s)))
        return Flights(numbers[at], change @ self.times_s, covariance, known)

    def covariance(self, where_unknown_s: float = np.nan) -> Array:
        """Covariance of the times [s²], with the uncertainty to assume where none is known."""
        if self.covariance_s2 is not None:
            return self.covariance_s2
        return np.diag(np.where(np.isfinite(self.u_s), self.u_s, where_unknown_s) ** 2)
