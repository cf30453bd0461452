"""The estimator ``odometry``: dead reckoning on two wheels, and how far it strays.

What the wheels are believed to be is uncertain by the same amount all the way; that, and the
counting of marks, is all that its uncertainty says. Slip is in neither.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation.dead_reckoning import DeadReckoning, Wheels, from_counts, from_rates
from simcompare.estimation.drift import Drift, drift, ellipse
from simcompare.estimation.estimate import Estimate, Given, Number, Signal, State, Way
from simcompare.estimation.estimators import Option
from simcompare.estimation.pose_roles import PLACE, START, WHEELS
from simcompare.hardware.sensors import drive_mistakes
from simcompare.hardware.sensors.drive_mistakes import Cures, Driven
from simcompare.model.trajectory import Array
from simcompare.statistics.suspicions import Suspicion

TITLE = "Dead reckoning of a robot on two wheels"
SIGNALS, TRUTHS = WHEELS, PLACE
OPTIONS = {
    "radius_m": Option("radius of the left wheel, as odometry believes it", least=1e-3),
    "right_larger": Option(
        "by what part it believes the right one to be larger", 0.0, -0.5, 1.0
    ),
    "track_m": Option("distance of the wheels, as odometry believes it", least=1e-3),
    "marks": Option("marks in one turn of a wheel", 0.0),
    "u_radius_m": Option("standard uncertainty of each radius", 0.0),
    "correlation": Option("of the errors of both radii", 0.0, -1.0, 1.0),
    "u_track_m": Option("standard uncertainty of the track", 0.0),
    **START,
    "u_start_m": Option("standard uncertainty of that place", 0.0),
    "u_start_heading_rad": Option("standard uncertainty of that heading", 0.0),
    "u_place_m": Option("standard uncertainty of the true place", 0.0),
}  # fmt: skip
#: what to type, or to write in the mapping file
CURES = Cures(
    exchange="exchange the channels of left and right under estimate: in the mapping file",
    sign=lambda side: f"write scale: -1 for the {side} wheel under estimate: in the mapping file",
    track_m=lambda value: f"add --option track_m={value:.4g}",
    radius_m=lambda value: f"add --option radius_m={value:.4g}",
    heading_rad=lambda value: f"add --option start_heading_rad={value:.4f}",
)
LABELS = {
    "drift_m": "Distance from the true place",
    "x_m": "Place along x",
    "y_m": "Place along y",
    "heading_rad": "Heading",
}


def estimate(given: Given) -> Estimate:
    """The path by dead reckoning, its uncertainty, and its drift where the truth is known.

    Raises:
        InputError: wheels that are not given, or that are no wheels.
    """
    reckoned = _judged(given, _reckoned(given))
    strayed = _strayed(given, reckoned)
    states = {
        name: State(
            reckoned.pose[:, k], reckoned.u[:, k], given.truth_at(role, reckoned.time_s),
            circular=role == "heading",
        )
        for k, (name, role) in enumerate((("x_m", "x"), ("y_m", "y"), ("heading_rad", "heading")))
    }  # fmt: skip
    if strayed is not None:
        nothing = np.zeros(len(reckoned.time_s))
        own = State(strayed.distance_m, strayed.u_distance_m, nothing)
        states = {"drift_m": own, **states}
    ways = (Way("odometry", reckoned.time_s, states), _region(reckoned))
    labels = {name: LABELS[name] for name in states}
    return Estimate(ways, labels, numbers=dict(_numbers(reckoned, strayed)))


def suspected(given: Given) -> Suspicion | None:
    """The mistake in what is said of the robot that explains how far it strays, where one does."""
    x, y = (given.truth.get(role) for role in ("x", "y"))
    if x is None or y is None:
        return None
    reckoned, o = _reckoned(given), given.options
    ways = _ways(given, reckoned.wheels)
    inside = reckoned.time_s <= x.time_s[-1]
    place = np.column_stack([np.interp(reckoned.time_s, one.time_s, one.values) for one in (x, y)])
    u_m = float(np.sqrt(np.mean(np.sum(reckoned.u[inside, :2] ** 2, axis=1))))
    start = (o["start_x_m"], o["start_y_m"], o["start_heading_rad"])
    driven = Driven(
        ways[0][inside], ways[1][inside], o["track_m"], place[inside], o["radius_m"], start,
        o["u_start_heading_rad"], u_m,
    )  # fmt: skip
    return drive_mistakes.suspected(driven, CURES)


def _ways(given: Given, wheels: Wheels) -> tuple[Array, Array]:
    """How far each wheel has rolled, as it is believed to be [m]."""
    if {"left_marks", "right_marks"} <= set(given.signals):
        _, turned = _pair(given.signal("left_marks"), given.signal("right_marks"))
        mark_rad = 2 * np.pi / given.options["marks"]
        angles = ((turned[0] - turned[0][0]) * mark_rad, (turned[1] - turned[1][0]) * mark_rad)
    else:
        time_s, rates = _pair(given.signal("left_rate"), given.signal("right_rate"))
        steps = np.diff(time_s)
        left, right = (
            np.concatenate(([0.0], np.cumsum(steps * (r[1:] + r[:-1]) / 2))) for r in rates
        )
        angles = (left, right)
    return angles[0] * wheels.left_radius_m, angles[1] * wheels.right_radius_m


def _reckoned(given: Given) -> DeadReckoning:
    o = given.options
    radius, larger, u = o["radius_m"], 1 + o["right_larger"], o["u_radius_m"]
    wheels = Wheels(
        radius, radius * larger, o["track_m"], u, u * larger, o["u_track_m"], o["correlation"]
    )
    start = (o["start_x_m"], o["start_y_m"], o["start_heading_rad"])
    u_start = (o["u_start_m"], o["u_start_m"], o["u_start_heading_rad"])
    if {"left_marks", "right_marks"} <= set(given.signals):
        time_s, counts = _pair(given.signal("left_marks"), given.signal("right_marks"))
        return from_counts(time_s, counts, o["marks"], wheels, start, u_start=u_start)
    if {"left_rate", "right_rate"} <= set(given.signals):
        left = given.signal("left_rate")
        time_s, rates = _pair(left, given.signal("right_rate"))
        noise = 0.0 if left.u is None else float(np.max(left.u))
        return from_rates(time_s, rates, wheels, start, u_rad_s=noise, u_start=u_start)
    wanted = "expected left_marks and right_marks, or left_rate and right_rate"
    raise InputError("estimate", [f"the wheels are not given; {wanted}"])


def _judged(given: Given, reckoned: DeadReckoning) -> DeadReckoning:
    """The samples at which the true place is known; all of them where it never is."""
    places = [given.truth_at(role, reckoned.time_s) for role in ("x", "y")]
    known = np.isfinite(np.sum([p for p in places if p is not None], axis=0))
    if len([p for p in places if p is not None]) < 2 or known.all():
        return reckoned
    kept = {
        name: getattr(reckoned, name)[known]
        for name in ("time_s", "pose", "way_m", "random", "sensitivity", "by_start")
    }
    return replace(reckoned, **kept)


def _pair(left: Signal, right: Signal) -> tuple[Array, tuple[Array, Array]]:
    """Both at the times of the left one, where both were measured."""
    other = right.at(left.time_s)
    known = np.isfinite(left.values) & np.isfinite(other)
    return left.time_s[known], (left.values[known], other[known])


def _strayed(given: Given, reckoned: DeadReckoning) -> Drift | None:
    x, y = (given.truth_at(role, reckoned.time_s) for role in ("x", "y"))
    if x is None or y is None:
        return None
    heading = given.truth_at("heading", reckoned.time_s)
    place = np.column_stack((x, y))
    return drift(reckoned, place, heading, u_place_m=given.options["u_place_m"])


def _region(reckoned: DeadReckoning) -> Way:
    """Where the robot is with 95 % at the end, as a line around it."""
    border = reckoned.pose[-1, :2] + ellipse(reckoned.covariance[-1, :2, :2])
    at = np.full(len(border), reckoned.time_s[-1])
    return Way("95 % of the ends", at, {"x_m": State(border[:, 0]), "y_m": State(border[:, 1])})


def _numbers(reckoned: DeadReckoning, strayed: Drift | None) -> Iterator[tuple[str, Number]]:
    way_m = reckoned.way_m if strayed is None else strayed.way_m
    yield "path_length", Number(float(way_m[-1]), "m")
    if strayed is None:
        return
    for name, values, u in (
        ("end_drift", strayed.distance_m, strayed.u_distance_m),
        ("end_along", strayed.along_m, strayed.u_along_m),
        ("end_across", strayed.across_m, strayed.u_across_m),
    ):
        yield name, Number(float(values[-1]), "m", float(u[-1]))
    if strayed.heading_rad is not None and strayed.u_heading_rad is not None:
        turned, u_turned = strayed.heading_rad[-1], strayed.u_heading_rad[-1]
        yield "end_turn", Number(float(turned), "rad", float(u_turned))
    if strayed.per_metre is not None:
        yield "drift_per_metre", Number(strayed.per_metre, "1", strayed.u_per_metre)
