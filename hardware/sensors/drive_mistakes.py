"""Usual mistakes in what is said of a robot on two wheels, each undone for a trial."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from simcompare.hardware.sensors import odometer
from simcompare.model.trajectory import Array
from simcompare.statistics import suspicions
from simcompare.statistics.suspicions import Change, Hypothesis, Suspicion

#: told where the path misses by more than this part of its length
MISSES = 0.02
#: and only what leaves no more than this part of it
EXPLAINED = 0.05
#: samples beyond which the path becomes no other one
MOST_SAMPLES = 2000
#: factors that come of a half taken for the whole, a radius for a diameter, one encoder's edges
FACTORS = (2.0, 0.5)
#: other factors that are looked for, and the smallest that is no matter of calibration
_WIDEST, LEAST_FACTOR = 5.0, 1.25
_GRID = np.linspace(-math.log(_WIDEST), math.log(_WIDEST), 80)
#: part by which wheels of one kind may differ
UNEQUAL = 0.03
#: smallest turn of the first heading that is told beside quarters of a turn [rad]
LEAST_TURN_RAD = math.radians(20)


@dataclass(frozen=True, eq=False)
class Driven:
    """Ways of two wheels and where the robot truly was.

    Attributes:
        left_m: way of the left wheel since the start (n,).
        right_m: of the right wheel (n,).
        track_m: distance of the wheels as stated.
        place_m: true places at the same times (n, 2).
        radius_m: of the wheels as stated.
        start: first pose as stated; ``None``: the path is laid on the true one as well as it goes.
        u_heading_rad: standard uncertainty of the first heading.
        u_place_m: typical uncertainty of a place from what is known of the wheels.
    """

    left_m: Array
    right_m: Array
    track_m: float
    place_m: Array
    radius_m: float = 1.0
    start: tuple[float, float, float] | None = None
    u_heading_rad: float = 0.0
    u_place_m: float = 0.0

    @property
    def length_m(self) -> float:
        """Length of the true path."""
        return float(np.hypot(*np.diff(self.place_m, axis=0).T).sum())

    @property
    def path_m(self) -> Array:
        """Places by dead reckoning (n, 2)."""
        start = self.start or (0.0, 0.0, 0.0)
        driven = odometer.arcs(self.left_m, self.right_m, self.track_m, start[2])
        return odometer.poses(driven, start)[:, :2]

    def thinned(self) -> Driven:
        """The same with so few samples that many trials take no time."""
        every = max(1, len(self.left_m) // MOST_SAMPLES)
        return replace(
            self, left_m=self.left_m[::every], right_m=self.right_m[::every],
            place_m=self.place_m[::every],
        )  # fmt: skip


def misfit(one: Driven) -> float:
    """Root mean square distance of dead reckoning from the true place [m]."""
    if one.start is None:
        return apart(one.path_m, one.place_m)
    return math.sqrt(float(np.mean(np.sum((one.path_m - one.place_m) ** 2, axis=1))))


def apart(path: Array, place: Array) -> float:
    """Root mean square distance of two paths after the best turn and shift of one."""
    ours, true = path - path.mean(axis=0), place - place.mean(axis=0)
    turn = turn_between(ours, true)
    cosine, sine = math.cos(turn), math.sin(turn)
    turned = ours @ np.array([[cosine, sine], [-sine, cosine]])
    return math.sqrt(float(np.mean(np.sum((turned - true) ** 2, axis=1))))


def turn_between(ours: Array, true: Array) -> float:
    """The turn about the origin that brings places (n, 2) nearest to others [rad]."""
    x, y = ours.T
    return math.atan2(float(np.sum(x * true[:, 1] - y * true[:, 0])), float(np.sum(ours * true)))


@dataclass(frozen=True)
class Cures:
    """How what was suspected is undone, in words of whoever reads the record.

    Attributes:
        exchange: left and right.
        sign: a side -> of its wheel.
        track_m: a distance -> of the wheels.
        radius_m: a radius -> of the wheels.
        heading_rad: a heading -> at the start.
    """

    exchange: str
    sign: Callable[[str], str]
    track_m: Callable[[float], str]
    radius_m: Callable[[float], str]
    heading_rad: Callable[[float], str]


def suspected(driven: Driven, cures: Cures) -> Suspicion | None:
    """The mistake that explains why dead reckoning misses the true place, where one does.

    Args:
        driven: what is known of the robot.
        cures: how each mistake is undone.
    """
    if not misfit(driven) > MISSES * driven.length_m:
        return None
    thin = driven.thinned()
    # wheels that are not quite alike bend a path as well, and that is no mistake
    usual = calibrated(thin)
    if not usual > MISSES * driven.length_m:
        return None
    found = suspicions.suspected(thin, mistakes(cures), misfit)
    if found is None or found.after > EXPLAINED * driven.length_m:
        return None
    return found if usual > suspicions.BETTER * found.after else None


def calibrated(one: Driven) -> float:
    """The misfit that is left where the right wheel may differ a little from the left one [m]."""

    def at(larger: float) -> float:
        return misfit(replace(one, right_m=one.right_m * (1 + larger)))

    return _least(at, np.linspace(-UNEQUAL, UNEQUAL, 61))[1]


def _least(at: Callable[[float], float], grid: Array) -> tuple[float, float]:
    """Where a function is least, and what it is there."""
    from scipy.optimize import minimize_scalar

    best, step = min(grid.tolist(), key=at), grid[1] - grid[0]
    found = minimize_scalar(at, bounds=(best - step, best + step), method="bounded")
    return float(found.x), float(found.fun)


def mistakes(cures: Cures) -> Sequence[Hypothesis[Driven]]:
    """All of them, the likeliest first.

    Args:
        cures: how each is undone.
    """
    sizes = [partial(_scaled, cures, what, f) for f in FACTORS for what in ("track", "radius")]
    return [
        partial(_exchanged, cures),
        *(partial(_turned, cures, quarters * math.pi / 2) for quarters in (2, 1, -1)),
        *(partial(_reversed, cures, side) for side in ("left", "right")),
        *sizes,
        *(partial(_rescaled, cures, what) for what in ("track", "radius")),
        partial(_best_turned, cures),
    ]


def _exchanged(cures: Cures, one: Driven) -> Change[Driven]:
    other = replace(one, left_m=one.right_m, right_m=one.left_m)
    says = "left and right exchanged (or a truth whose frame is mirrored)"
    return Change(other, says, cures.exchange)


def _reversed(cures: Cures, side: str, one: Driven) -> Change[Driven]:
    ways = {"left": one.left_m, "right": one.right_m}
    other = replace(one, **{f"{side}_m": -ways[side]})  # type: ignore[arg-type]
    return Change(other, f"the sign of the {side} wheel reversed", cures.sign(side))


def _turned(cures: Cures, turn_rad: float, one: Driven, words: str = "") -> Change[Driven] | None:
    if one.start is None:
        return None
    x, y, heading = one.start
    heading = (heading + turn_rad + math.pi) % (2 * math.pi) - math.pi
    quarter = f"a quarter of a turn to the {'left' if turn_rad > 0 else 'right'}"
    words = words or ("half a turn" if abs(turn_rad) > 3 else quarter)
    says = f"the heading turned by {words}"
    return Change(replace(one, start=(x, y, heading)), says, cures.heading_rad(heading))


def _best_turned(cures: Cures, one: Driven) -> Change[Driven] | None:
    """The turn about the start that brings the paths together."""
    if one.start is None or not misfit(one) > 3 * one.u_place_m:
        return None
    ours, true = one.path_m - one.start[:2], one.place_m - one.start[:2]
    turn = turn_between(ours, true)
    if abs(turn) < max(LEAST_TURN_RAD, 5 * one.u_heading_rad):
        return None
    return _turned(cures, turn, one, f"{math.degrees(turn):.0f}°")


def _sized(one: Driven, what: str, factor: float) -> Driven:
    if what == "track":
        return replace(one, track_m=one.track_m * factor)
    return replace(
        one, radius_m=one.radius_m * factor, left_m=one.left_m * factor,
        right_m=one.right_m * factor,
    )  # fmt: skip


def _scaled(cures: Cures, what: str, factor: float, one: Driven) -> Change[Driven]:
    other, words = _sized(one, what, factor), {2.0: "twice", 0.5: "half"}.get(factor)
    words = words or f"{factor:.3g} times"
    if what == "track":
        says, cure = f"{words} the track, {other.track_m:.4g} m,", cures.track_m(other.track_m)
    else:
        says = f"wheels {words} as large (or another gear or number of marks)"
        cure = cures.radius_m(other.radius_m)
    return Change(other, says, cure)


def _rescaled(cures: Cures, what: str, one: Driven) -> Change[Driven] | None:
    """The factor that fits best, where it is more than a matter of calibration."""

    def at(log: float) -> float:
        return misfit(_sized(one, what, math.exp(log)))

    factor = math.exp(_least(at, _GRID)[0])
    if not LEAST_FACTOR < max(factor, 1 / factor) < 0.98 * _WIDEST:
        return None
    return _scaled(cures, what, factor, one)
