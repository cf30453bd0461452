"""Bounces in closed form: impact times, speeds and heights for many parameter sets at once.

A model is a law of restitution with or without quadratic air drag. The exponent of a law is
-d ln e/d ln v at the reference speed, so that it means the same in each. All of it is written with
k = 1/v_t² (v_t the terminal speed; k = 0 is vacuum) and with functions that are analytic there, so
that a fit may begin in vacuum and its derivatives hold. With s = k·u² a ball that rises from u
takes u/g·A(s) to its apex u²/2g·ln(1+s)/s and returns with u/√(1+s); falling to the speed v takes
v/g·A(-k·v²), where A(s) = arctan(√s)/√s (Timmerman and van der Weele, Am. J. Phys. 67 (1999) 538).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from simcompare.errors import UnknownName
from simcompare.fitting.bounces import hunt_crossley
from simcompare.fitting.bounces.hunt_crossley import REFERENCE_SPEED
from simcompare.model.trajectory import Array

GRAVITY = 9.80665
#: what a fit may seek, in the order in which it is shown, and its value where nothing is said
DEFAULTS = {
    "restitution": 0.8, "exponent": 0.0, "terminal_speed_m_s": np.inf, "drop_height_m": 1.0,
    "release_time_s": 0.0, "clock_skew": 0.0, "floor_m": 0.0, "scale": 1.0,
    "gravity_m_s2": GRAVITY,
}  # fmt: skip
#: below this the functions are summed as series
_SMALL = 1e-3
_ARC_SERIES = (1.0, -1 / 3, 1 / 5, -1 / 7, 1 / 9, -1 / 11)
_COSH_SERIES = (1.0, -1 / 6, 2 / 45, -17 / 1260, 62 / 14175)
#: laws of a restitution that changes with the speed as an exponent tells
SLOPED = ("power", "linear", "logarithmic")
#: a restitution lies between these
_LEAST, _MOST = 1e-3, 1.0
#: part of the reference speed over which a law's slope is taken
_NEAR = 1e-4


@dataclass(frozen=True)
class Model:
    """A law of restitution, with or without drag.

    Attributes:
        name: short name ("constant", "power+drag").
        law: "constant", "power", "linear", "logarithmic" or "hunt_crossley".
        drag: whether the terminal speed is an unknown of it.
        text: what it says, in words.
    """

    name: str
    law: str
    drag: bool
    text: str

    @property
    def own(self) -> tuple[str, ...]:
        """The unknowns that make this model, beside heights and clocks."""
        names = ("restitution", "exponent") if self.law in SLOPED else ("restitution",)
        return (*names, "terminal_speed_m_s") if self.drag else names


MODELS = {
    model.name: model
    for model in (
        Model("constant", "constant", False, "constant restitution, no drag"),
        Model("power", "power", False, "restitution as a power of the speed, no drag"),
        Model("linear", "linear", False, "restitution linear in the speed, no drag"),
        Model("logarithmic", "logarithmic", False,
              "restitution linear in the logarithm of the speed, no drag"),
        Model("hunt_crossley", "hunt_crossley", False, "Hunt-Crossley contact, no drag"),
        Model("constant+drag", "constant", True, "constant restitution and air drag"),
        Model("hunt_crossley+drag", "hunt_crossley", True, "Hunt-Crossley contact and air drag"),
        Model("power+drag", "power", True, "restitution as a power of the speed, and air drag"),
        Model("linear+drag", "linear", True, "restitution linear in the speed, and air drag"),
        Model("logarithmic+drag", "logarithmic", True,
              "restitution linear in the logarithm of the speed, and air drag"),
    )
}  # fmt: skip


def model_of(name: str) -> Model:
    """The model of that name.

    Raises:
        UnknownName: there is none.
    """
    if name not in MODELS:
        raise UnknownName("bounce model", name, MODELS)
    return MODELS[name]


@dataclass(frozen=True)
class Bounces:
    """What a model says, for each of the parameter sets (…).

    Attributes:
        impact_s: impact times on the log's clock (…, K) [s].
        speed_m_s: speeds at which the ball hits (…, K) [m/s].
        restitution: effective restitution of each impact (…, K).
        apex_s: on the ball's own clock from release on, apex of each flight; the first is the
            release (…, K + 1) [s].
        apex_m: height of each apex above the floor, the first is the drop height (…, K + 1) [m].
    """

    impact_s: Array
    speed_m_s: Array
    restitution: Array
    apex_s: Array
    apex_m: Array


def bounces(model: Model, values: Mapping[str, Array | float], count: int) -> Bounces:
    """The first ``count`` impacts.

    Args:
        model: which.
        values: parameters by name, numbers or arrays (…) of one shape. Drag is
            ``terminal_speed_m_s`` or, first, ``drag_k`` = 1/v_t²; what is missing has its default.
        count: number of impacts K, at least 1.
    """
    given = {**DEFAULTS, **values}
    gravity = np.asarray(given["gravity_m_s2"], dtype=float)
    k = drag_of(given)
    e = np.asarray(given["restitution"], dtype=float)
    height = np.asarray(given["drop_height_m"], dtype=float)
    exponent = np.asarray(given["exponent"], dtype=float)
    shape = np.broadcast_shapes(gravity.shape, k.shape, e.shape, height.shape, exponent.shape)
    dissipation = hunt_crossley.dissipation(e) if model.law == "hunt_crossley" else 0
    speeds, laws, ups = (np.empty((count, *shape)) for _ in range(3))
    speed = np.sqrt(2 * gravity * height * _decay(2 * gravity * k * height))
    for n in range(count):
        if model.law == "hunt_crossley":
            law = hunt_crossley.restitution(dissipation * speed)
        else:
            law = _sloped(model.law, e, exponent, speed)
        speeds[n], laws[n] = speed, law
        ups[n] = up = law * speed
        speed = up / np.sqrt(1 + k * up * up)
    # what follows from the speeds is had for all flights at once
    squares = k * ups * ups
    ways_s = np.empty((2 * count, *shape))
    ways_s[0::2] = speeds / gravity * arc_ratio(-k * speeds * speeds)
    ways_s[1::2] = ups / gravity * arc_ratio(squares)
    instants_s = np.cumsum(ways_s, axis=0)
    apex_s, apex_m = (np.empty((count + 1, *shape)) for _ in range(2))
    apex_s[0], apex_m[0] = 0.0, height
    apex_s[1:], apex_m[1:] = instants_s[1::2], ups * ups / (2 * gravity) * _log_ratio(squares)
    own = [np.moveaxis(a, 0, -1) for a in (instants_s[0::2], speeds, laws, apex_s, apex_m)]
    skew, release = (np.asarray(given[n], dtype=float) for n in ("clock_skew", "release_time_s"))
    on_log = release[..., None] + (1 + skew[..., None]) * own[0]
    return Bounces(on_log, *own[1:])


def drag_of(values: Mapping[str, Array | float]) -> Array:
    """K = 1/v_t² [s²/m²]."""
    if "drag_k" in values:
        return np.asarray(values["drag_k"], dtype=float)
    return 1.0 / np.asarray(values["terminal_speed_m_s"], dtype=float) ** 2


def height_at(
    found: Bounces, values: Mapping[str, Array | float], time_s: Array, flight: NDArray[np.int64]
) -> Array:
    """Height that a camera shows at times of the log, each within the flight of that number.

    The arc of a flight is followed beyond its ends, so that the height is smooth in all
    parameters.

    Args:
        found: bounces of the same parameter sets (…).
        values: their parameters, as for :func:`bounces`.
        time_s: times (n,) [s].
        flight: number of the flight of each time, 0 is the first fall (n,).

    Returns:
        floor + height/scale, (…, n) [m].
    """
    given = {name: np.asarray(value)[..., None] for name, value in {**DEFAULTS, **values}.items()}
    k, gravity = drag_of(given), given["gravity_m_s2"]
    own = (time_s - given["release_time_s"]) / (1 + given["clock_skew"])
    height = arc(own - found.apex_s[..., flight], found.apex_m[..., flight], gravity, k)
    return np.asarray(given["floor_m"] + height / given["scale"])


def arc(after_s: Array, apex_m: Array | float, gravity: Array | float, k: Array | float) -> Array:
    """Height at times after (or, negative, before) the apex of a flight, with drag k = 1/v_t²."""
    squared = gravity * gravity * k * after_s * after_s
    fall = _cosh_ratio(np.where(after_s < 0, -squared, squared))
    return np.asarray(apex_m - 0.5 * gravity * after_s * after_s * fall)


def restitution_at(model: Model, values: Mapping[str, Array | float], speed: Array) -> Array:
    """Effective restitution of an impact at that speed."""
    given = {**DEFAULTS, **values}
    e = np.asarray(given["restitution"], dtype=float)
    if model.law == "hunt_crossley":
        return hunt_crossley.restitution(hunt_crossley.dissipation(e) * speed)
    law = _sloped(model.law, e, np.asarray(given["exponent"], dtype=float), speed)
    shape = np.broadcast_shapes(e.shape, np.shape(speed), np.shape(law))
    return np.broadcast_to(law, shape).copy()


def exponent_of(model: Model, values: Mapping[str, Array | float]) -> Array:
    """-d ln e/d ln v at the reference speed."""
    if model.law in SLOPED:
        return np.asarray(values["exponent"], dtype=float)
    ends = (np.array(REFERENCE_SPEED * part) for part in (1 - _NEAR, 1 + _NEAR))
    slow, fast = (np.log(restitution_at(model, values, speed)) for speed in ends)
    return np.asarray((slow - fast) / (2 * _NEAR))


def _sloped(law: str, e: Array, exponent: Array, speed: Array) -> Array:
    """A constant restitution, or one that changes with the speed as an exponent tells."""
    if law == "constant":
        return e
    ratio = np.maximum(speed, 1e-12) / REFERENCE_SPEED
    if law == "power":
        return np.asarray(np.minimum(e * ratio**-exponent, _MOST))
    fall = ratio - 1 if law == "linear" else np.log(ratio)
    return np.asarray(np.clip(e * (1 - exponent * fall), _LEAST, _MOST))


def arc_ratio(s: Array) -> Array:
    """A(s) = arctan(√s)/√s, and artanh(√-s)/√-s below 0; s above -1."""
    s = np.maximum(np.asarray(s), -1 + 1e-15)
    if not s.any():
        return np.ones_like(s)
    root = np.sqrt(np.abs(s))
    small = root * root < _SMALL
    root = np.where(small, 0.5, root)
    exact = np.where(s >= 0, np.arctan(root), np.arctanh(np.minimum(root, 1 - 1e-16))) / root
    return np.where(small, polyval(s, _ARC_SERIES), exact)


def _cosh_ratio(s: Array) -> Array:
    """2·ln cosh(√s)/s, and 2·ln cos(√-s)/s below 0: a fall over that in vacuum."""
    small = np.abs(s) < _SMALL
    root = np.where(small, 0.5, np.sqrt(np.abs(s)))
    down = root + np.log1p(np.exp(-2 * root)) - np.log(2.0)
    up = -np.log(np.cos(np.minimum(root, 1.57)))
    exact = 2 * np.where(s >= 0, down, up) / (root * root)
    return np.where(small, polyval(s, _COSH_SERIES), exact)


def _log_ratio(s: Array) -> Array:
    """ln(1 + s)/s."""
    safe = np.where(s == 0, 1.0, s)
    return np.where(s == 0, 1.0, np.log1p(safe) / safe)


def _decay(x: Array) -> Array:
    """(1 - exp(-x))/x."""
    safe = np.where(x == 0, 1.0, x)
    return np.where(x == 0, 1.0, -np.expm1(-safe) / safe)
