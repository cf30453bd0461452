"""A position and its rate in one log: does the one change as the other says?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.hardware.conditioning.units.meaning import Claim, of_one_thing
from simcompare.hardware.conditioning.units.rest import excerpts
from simcompare.hardware.conditioning.work import Work
from simcompare.model.trajectory import Array

#: what the rate of a quantity is measured in
_RATE_OF = {"rad": "rad/s", "m": "m/s"}
#: words that say "position" or "rate" and nothing of whose
_POSITION = frozenset(
    ("angle", "angles", "ang", "position", "positions", "pos", "theta", "phi", "q", "displacement")
)
_RATE = frozenset(
    (
        "rate", "rates", "velocity", "velocities", "vel", "speed", "speeds", "omega", "angular",
        "dot", "dq", "qd", "qdot", "dtheta", "dphi", "thetadot", "phidot", "w", "v",
    )
)  # fmt: skip
_MAX_WINDOWS = 4096
#: correlations that are as good as the best
_NEARLY = 0.03
_MIN_WINDOWS = 12


@dataclass(frozen=True)
class Slope:
    """How much a position changes for what its rate promises.

    Attributes:
        value: change of the position over the integral of the rate; 1 where both agree.
        alike: correlation of the two, over the time span in which it is best.
        span_s: that time span.
    """

    value: float
    alike: float
    span_s: float


def pairs(claims: Sequence[Claim]) -> list[tuple[Claim, Claim]]:
    """Positions and rates of the same thing, by names and units."""
    skip = _POSITION | _RATE | {"rad", "deg", "m", "s", "mm"}
    return [pair for pair in of_one_thing(claims, _RATE_OF, skip) if _same_frame(*pair)]


def _same_frame(position: Claim, rate: Claim) -> bool:
    frames = [(c.wish.frame if c.wish else "") or c.column.frame for c in (position, rate)]
    return frames[0] == frames[1] or "" in frames


def slope(work: Work, position: Claim, rate: Claim) -> Slope | None:
    """Compares changes of a position with integrals of its rate over spans of many lengths.

    Over short spans rounding and noise dominate; over a whole swing nothing is left of the
    motion. Of the lengths with nearly the highest correlation, that over which the position
    moved most counts. ``None`` where nothing moved or too little is there.
    """
    steps = [_steps(work, position, rate, part) for part in excerpts(len(work.time_s))]
    step_s = float(np.median(np.concatenate([step[3] for step in steps])))
    slopes: list[tuple[float, Slope]] = []
    length = 1
    while length <= max(len(step[0]) for step in steps) // 4:
        moved, promised = (
            np.concatenate([_windows(step, length)[i] for step in steps]) for i in (0, 1)
        )
        fitted = _fitted(moved, promised)
        if fitted is not None:
            size = float(np.sqrt(np.mean(moved**2)))
            slopes.append((size, Slope(*fitted, length * step_s)))
        length *= 2
    best = max((abs(s.alike) for _, s in slopes), default=0.0)
    near = [(size, s) for size, s in slopes if abs(s.alike) >= best - _NEARLY]
    return max(near, key=lambda pair: pair[0])[1] if near else None


def _steps(
    work: Work, position: Claim, rate: Claim, part: slice
) -> tuple[Array, Array, Array, Array]:
    """From sample to sample: change, promised change, whether either is unusable, time."""
    time = np.asarray(work.time_s[part], dtype=np.float64)
    x, v = position.values(part), rate.values(part)
    dt, moved = np.diff(time), np.diff(x)
    promised = 0.5 * (v[1:] + v[:-1]) * dt
    bad = ~(np.isfinite(moved) & np.isfinite(promised))
    if len(dt):
        bad |= dt > 10 * np.median(dt)
    if np.isfinite(x).any():
        # an angle that begins again at its other end
        bad |= np.abs(moved) > 0.5 * (np.nanmax(x) - np.nanmin(x))
    gaps = np.array([g - part.start for g in work.gaps if part.start <= g < part.stop - 1], int)
    bad[gaps[gaps < len(bad)]] = True
    return np.where(bad, 0.0, moved), np.where(bad, 0.0, promised), bad.astype(float), dt


def _windows(step: tuple[Array, Array, Array, Array], length: int) -> tuple[Array, Array]:
    """Sums over windows of ``length`` steps that overlap by half and hold nothing unusable."""
    sums = [np.concatenate(([0.0], np.cumsum(values))) for values in step[:3]]
    count = len(sums[0])
    stride = max(1, length // 2, count // _MAX_WINDOWS)
    first = np.arange(0, count - length, stride)
    moved, promised, bad = (total[first + length] - total[first] for total in sums)
    return moved[bad < 0.5], promised[bad < 0.5]


def _fitted(moved: Array, promised: Array) -> tuple[float, float] | None:
    """Slope through zero with errors on both sides, and correlation; stray windows left out."""
    for _ in range(3):
        if len(moved) < _MIN_WINDOWS:
            return None
        xx, yy, xy = promised @ promised, moved @ moved, promised @ moved
        if not (xx > 0 and yy > 0):
            return None
        value = float(np.copysign(np.sqrt(yy / xx), xy))
        rest = np.abs(moved - value * promised)
        kept = rest <= max(10 * float(np.median(rest)), 1e-12 * float(np.sqrt(yy)))
        if kept.all() or kept.mean() < 0.8:
            break
        moved, promised = moved[kept], promised[kept]
    return value, float(xy / np.sqrt(xx * yy))
