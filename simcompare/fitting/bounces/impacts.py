"""The instants and heights of one drop of a bouncing ball."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simcompare.model.trajectory import Array
from simcompare.results.records.fit_bounces import Rejected

SOUND, CLOCKED, TRACK, TABLE = "sound", "stopwatch", "video track", "rebound heights"
#: names of recorded signals
LOUDNESS, HEIGHT = "sound", "height_m"
_NOTHING = np.empty(0)


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
class Impacts:
    """What one drop of a ball left behind.

    Attributes:
        times_s: impact times on the recording's clock (n,) [s].
        u_s: their standard uncertainties, NaN where unknown (n,) [s].
        numbers: which impact each is, first is 1; a number that is left out was missed.
        kind: where they come from.
        source: name of the file.
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
        return int(max((*self.numbers, *self.height_numbers, *flights, 1)))

    @property
    def u_known(self) -> bool:
        """Whether every measured number has a stated uncertainty."""
        if self.track is not None:
            return bool(np.all(np.isfinite(self.track.u_m)))
        return bool(np.all(np.isfinite(self.u_s)) and np.all(np.isfinite(self.u_heights_m)))

    def covariance(self, where_unknown_s: float = np.nan) -> Array:
        """Covariance of the times [s²], with the uncertainty to assume where none is known."""
        if self.covariance_s2 is not None:
            return self.covariance_s2
        return np.diag(np.where(np.isfinite(self.u_s), self.u_s, where_unknown_s) ** 2)
