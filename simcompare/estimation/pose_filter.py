"""Pose of a robot on two wheels: the extended Kalman filter with motors, wheels, inertia, ranges.

``pose_model`` says how the states move and what is read; here readings are put in order of time,
filtered, and a reading that cannot be (far beyond its own innovation's u) is refused. Marks are
read as the way that a wheel has rolled, whose counting errors are white. Where a wheel has slipped,
that way is wrong for ever: after a refused count it begins anew. Without motors speed and rate only
keep what they gain; the density of jerk must then allow for what changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation import consistency, kalman, pose_model, timing
from simcompare.estimation.estimate import Estimate, Given, Signal, State, Way
from simcompare.estimation.kalman import Belief, Expected, Filtered, Motion
from simcompare.estimation.pose_model import (
    LEFT,
    LEFT_MOTOR,
    RATE,
    RIGHT,
    RIGHT_MOTOR,
    STATES,
    Ranger,
    Robot,
)
from simcompare.estimation.pose_roles import ERRORS, FIRST, LABELS, OPTIONS, SIGNALS, TITLE, TRUTHS
from simcompare.estimation.smoother import smooth
from simcompare.hardware.sensors import odometer
from simcompare.measures.heading import wrapped
from simcompare.model.trajectory import Array

__all__ = ["LABELS", "OPTIONS", "SIGNALS", "TITLE", "TRUTHS", "estimate"]
_MARKS = {"left_marks": LEFT, "right_marks": RIGHT}
_RATES = ("left_rate", "right_rate")
_INERTIAL = ("turning_rate", "acceleration")
_OTHERS = (*_INERTIAL, "range", "wall_range")
#: how far a wheel has rolled before it is counted is not known [marks]
_BEFORE = 10.0


@dataclass(frozen=True, eq=False)
class _Setting:
    """Everything that the filter needs at a time."""

    given: Given
    robot: Robot
    ranger: Ranger
    readings: dict[str, Signal]
    time_s: Array
    inputs: Array
    beacons: Array

    @property
    def errors(self) -> list[str]:
        """Errors of sensors that are states here, behind those of the robot."""
        options = self.given.options
        return [n for n, e in ERRORS.items() if options[e.option] and e.role in self.readings]


def estimate(given: Given) -> Estimate:
    """Filters, smooths, and tells beside it what the wheels say alone."""
    setting = _setting(given)
    filtered = _filtered(setting)
    smoothed = smooth(filtered)
    means, covariances = _told(setting, filtered.means, filtered.covariances)
    later = _told(setting, smoothed.means, smoothed.covariances)
    ways = (
        _way(setting, "filtered", setting.time_s, means, covariances),
        _way(setting, "smoothed", setting.time_s, *later),
        _reckoned(setting),
    )
    labels = {name: LABELS[name] for name in ways[0].states}
    judged = replace(filtered, means=means, covariances=covariances)
    counted = tuple(role for role in setting.readings if role in _MARKS)
    innovations = consistency.innovations_of(judged, ways[0], [*setting.readings], counted)
    return Estimate(ways, labels, innovations, ways[0].last)


def _setting(given: Given) -> _Setting:
    readings = _readings(given)
    time_s = timing.merged(list(readings.values()))
    beacons = np.full((len(time_s), 2), np.nan)
    if "range" in readings:
        at = readings["range"].time_s
        places = np.searchsorted(time_s, at - timing.SAME_S)
        for i, role in enumerate(("beacon_x", "beacon_y")):
            beacons[places, i] = given.signal(role).at(at)
    kind, inputs = _inputs(given, time_s)
    o = given.options
    ranger = Ranger(o["ranger_ahead_m"], o["ranger_left_m"], o["beam_rad"], o["zone_rad"])
    return _Setting(given, _robot(given, kind), ranger, readings, time_s, inputs, beacons)


def _robot(given: Given, kind: str) -> Robot:
    o = given.options
    drive = {"voltage": o["drive_N_V"], "current": o["drive_N_A"]}.get(kind, 0.0)
    damping = {"voltage": o["damping_N_s_m"], "current": o["current_damping_N_s_m"]}
    return Robot(
        o["radius_m"], o["track_m"], o["inertia_kg"], o["turning_inertia_kg_m2"], drive,
        damping.get(kind, 0.0), o["friction_N"] if kind else 0.0, o["load_behind_kg_m"],
        o["jerk_density_m2_s5"], o["turn_jerk_density_rad2_s5"],
        o["lag_s"], o["settling_s"],
    )  # fmt: skip


def _readings(given: Given) -> dict[str, Signal]:
    """Role -> readings; marks as angles that the wheels have turned."""
    signals, o = given.signals, given.options
    if set(signals) >= set(_MARKS):
        wheels = {r: timing.turned(signals[r], o["marks"], o["gate_s"]) for r in _MARKS}
    elif set(signals) >= set(_RATES):
        wheels = {role: signals[role] for role in _RATES}
    else:
        wanted = "expected left_marks and right_marks, or left_rate and right_rate"
        raise InputError("estimate", [f"the wheels are not given; {wanted}"])
    others = {role: signals[role] for role in _OTHERS if role in signals}
    for role in set(others) & set(_INERTIAL):  # a low-pass tells what was a little earlier
        others[role] = replace(others[role], time_s=others[role].time_s - o["imu_late_s"])
    return wheels | others


def _inputs(given: Given, time_s: Array) -> tuple[str, Array]:
    """What the motors are driven by, and both inputs (n, 2); none where nothing is given."""
    for kind in ("voltage", "current"):
        roles = (f"left_{kind}", f"right_{kind}")
        if all(role in given.signals for role in roles):
            both = [given.signals[role] for role in roles]
            return kind, np.array([np.interp(time_s, one.time_s, one.values) for one in both]).T
    return "", np.zeros((len(time_s), 2))


def _filtered(setting: _Setting) -> Filtered:
    o, time_s, readings = setting.given.options, setting.time_s, setting.readings
    start = np.zeros(STATES + len(setting.errors))
    start[: RATE + 1] = [o[name] for name in FIRST]
    start[[LEFT_MOTOR, RIGHT_MOTOR]] = o["left_motor"], o["right_motor"]
    begin, _ = pose_model.accelerations(setting.robot, start[:STATES], *setting.inputs[0])
    push, turn = np.hypot([o["u_push_m_s2"], o["u_turn_rad_s2"]], setting.robot.off_by * begin)
    rolled_m = _BEFORE * 2 * np.pi * o["radius_m"] / max(o["marks"], 1.0)
    u = [o["u_start_m"]] * 2 + [
        o["u_start_heading_rad"], o["u_start_speed_m_s"], o["u_start_rate_rad_s"],
        push, turn, rolled_m, rolled_m,
    ] + [math.hypot(o["u_motor"], o["u_input"])] * 2  # fmt: skip
    u += [o[ERRORS[name].u] for name in setting.errors]
    noise = np.diag([timing.variance_of(one, name) for name, one in readings.items()])

    def move(state: Array, number: int) -> Motion:
        step_s = float(time_s[number] - time_s[number - 1])
        left, right = setting.inputs[number - 1 : number + 1].mean(axis=0)
        motion = pose_model.move(setting.robot, state[:STATES], step_s, left, right)
        transition, shaken = np.eye(len(state)), np.zeros((len(state), len(state)))
        transition[:STATES, :STATES], shaken[:STATES, :STATES] = motion.transition, motion.noise
        return Motion(np.append(motion.mean, state[STATES:]), transition, shaken)

    def expect(state: Array, number: int) -> Expected:
        return _expected(setting, state, number, noise)

    measured = timing.placed(list(readings.values()), time_s)
    first = Belief(start, np.diag(np.square(u)))
    return kalman.run(
        first, measured, move, expect, gate=o["gate"] or None, after_refusal=_anew(setting, noise)
    )


def _anew(setting: _Setting, noise: Array) -> Callable[[Belief, Array, Array], Belief]:
    """Marks that were refused are counted from there on."""
    radius_m, names = setting.robot.radius_m, list(setting.readings)

    def after_refusal(belief: Belief, reading: Array, refused: Array) -> Belief:
        mean, covariance = belief.mean.copy(), belief.covariance.copy()
        for name in (name for name in _MARKS if name in names and refused[names.index(name)]):
            state, place = _MARKS[name], names.index(name)
            mean[state] = radius_m * reading[place]
            covariance[state, :] = covariance[:, state] = 0.0
            covariance[state, state] = radius_m**2 * noise[place, place]
        return Belief(mean, covariance)

    return after_refusal


def _expected(setting: _Setting, state: Array, number: int, noise: Array) -> Expected:
    """What every sensor should read, in the order of the readings."""
    values, rows = np.zeros(len(setting.readings)), np.zeros((len(setting.readings), len(state)))
    for place, role in enumerate(setting.readings):
        value, row = _ideal(setting, state, number, role)
        rows[place, :STATES] = row
        for index, name in enumerate(setting.errors, start=STATES):
            error = ERRORS[name]
            if error.role != role:
                continue
            rows[place, index] = value if error.scales else 1.0
            if error.scales:
                rows[place, :STATES] *= 1 + state[index]
        values[place] = value + rows[place, STATES:] @ state[STATES:]
    return Expected(values, rows, noise)


def _ideal(setting: _Setting, state: Array, number: int, role: str) -> tuple[float, Array]:
    """What a sensor without error should read, and its derivatives (11,)."""
    robot, o, one = setting.robot, setting.given.options, np.eye(STATES)
    if role in _MARKS:
        return state[_MARKS[role]] / robot.radius_m, one[_MARKS[role]] / robot.radius_m
    if role in _RATES:
        rates, slopes = pose_model.wheel_rates(robot, state)
        return rates[_RATES.index(role)], slopes[_RATES.index(role)]
    if role == "turning_rate":
        return state[RATE], one[RATE]
    if role == "range":
        beacon = np.nan_to_num(setting.beacons[number])
        return pose_model.range_to_beacon(setting.ranger, state, beacon)
    if role == "wall_range":
        return pose_model.range_to_wall(setting.ranger, state, o["wall_normal_rad"], o["wall_m"])
    grown, slopes = pose_model.accelerations(robot, state, *setting.inputs[number])
    ahead, rate = o["accelerometer_ahead_m"], state[RATE]
    return grown[0] - ahead * rate**2, slopes[0] - 2 * ahead * rate * one[RATE]


def _told(setting: _Setting, means: Array, covariances: Array) -> tuple[Array, Array]:
    """What is told: accelerations in place of what motors do not explain, and no rolled ways."""
    count = means.shape[1]
    kept = [i for i in range(count) if i not in (LEFT, RIGHT, LEFT_MOTOR, RIGHT_MOTOR)]
    told, spread = means[:, kept].copy(), np.empty((len(means), len(kept), len(kept)))
    for i, mean in enumerate(means):
        slopes = np.eye(count)[kept]
        told[i, 5:7], slopes[5:7, :STATES] = pose_model.accelerations(
            setting.robot, mean, *setting.inputs[i]
        )
        spread[i] = slopes @ covariances[i] @ slopes.T
    return told, spread


def _reckoned(setting: _Setting) -> Way:
    """Dead reckoning: what the rates of the wheels alone add up to, from the same start."""
    given, o = setting.given, setting.given.options
    gate_s, radius_m = 0.0, setting.robot.radius_m
    if "left_marks" in setting.readings:
        gate_s = o["gate_s"]
        left, right = (timing.counted(given.signals[r], o["marks"], gate_s) for r in _MARKS)
    else:
        left, right = (given.signals[role] for role in _RATES)
    time_s = left.time_s
    both = radius_m * np.array([left.values, right.at(time_s)])
    both[:, np.isnan(both).any(axis=0)] = 0.0
    ways = np.cumsum(np.diff(time_s, prepend=time_s[0] - gate_s) * both, axis=1)
    rolled_left, rolled_right = np.insert(ways, 0, 0.0, axis=1)
    start = (o["start_x_m"], o["start_y_m"], o["start_heading_rad"])
    driven = odometer.arcs(rolled_left, rolled_right, setting.robot.track_m, start[2])
    rates = (both.mean(axis=0), (both[1] - both[0]) / setting.robot.track_m)
    means = np.column_stack((odometer.poses(driven, start)[1:], *rates))
    return _way(setting, "wheels alone", time_s, means, None)


def _way(setting: _Setting, name: str, time_s: Array, means: Array, spread: Array | None) -> Way:
    u = None if spread is None else np.sqrt(np.diagonal(spread, axis1=1, axis2=2))
    names = [*list(LABELS)[:7], *setting.errors][: means.shape[1]]
    truths = _truths(setting.given, time_s)
    if over_s := setting.given.options["truth_over_s"]:
        truths |= _changes(setting.given, time_s, over_s / 2)
    states = {
        state: State(
            means[:, i], None if u is None else u[:, i], truths.get(state),
            circular=state == "heading_rad",
        )
        for i, state in enumerate(names)
    }  # fmt: skip
    return Way(name, time_s, states)


def _changes(given: Given, time_s: Array, half_s: float) -> dict[str, Array]:
    """What the true place and heading tell of speeds and accelerations, as far as they are known.

    The way is that along the heading between two times. Speeds are changes over one half of the
    time, accelerations the differences of those over both.
    """
    before, early, now, late, after = (
        _truths(given, time_s + share * half_s) for share in (-1, -0.5, 0, 0.5, 1)
    )

    def turned(one: dict[str, Array], other: dict[str, Array]) -> Array:
        return wrapped(other["heading_rad"] - one["heading_rad"])

    def way(one: dict[str, Array], other: dict[str, Array]) -> Array:
        along = one["heading_rad"] + turned(one, other) / 2
        east, north = (other[name] - one[name] for name in ("x_m", "y_m"))
        return np.asarray(np.cos(along) * east + np.sin(along) * north)

    found = {}
    if "heading_rad" in now:
        found["rate_rad_s"] = turned(early, late) / half_s
        found["turn_acceleration_rad_s2"] = (turned(now, after) - turned(before, now)) / half_s**2
    if {"x_m", "y_m", "heading_rad"} <= set(now):
        found["speed_m_s"] = way(early, late) / half_s
        found["acceleration_m_s2"] = (way(now, after) - way(before, now)) / half_s**2
    return found


def _truths(given: Given, time_s: Array) -> dict[str, Array]:
    """State -> what it was at the middle of the axle (n,), as far as that is known."""
    told = {
        state: given.truth[role].at(time_s)
        for state, role in zip(LABELS, TRUTHS, strict=False)
        if role in given.truth and role != "velocity"
    }
    ahead_m = given.options["mark_ahead_m"]
    if "heading_rad" not in told:
        if ahead_m or "velocity" in given.truth:
            wanted = "expected the truth of the heading, by which those of the axle follow"
            raise InputError("estimate", [f"what is true of a mark is given; {wanted}"])
        return told
    along = np.array([np.cos(told["heading_rad"]), np.sin(told["heading_rad"])])
    for state, part in zip(("x_m", "y_m"), along, strict=True):
        if state in told:
            told[state] = told[state] - ahead_m * part
    if "velocity" in given.truth:
        velocity = given.truth["velocity"].at(time_s)[:, :2]
        told["speed_m_s"] = np.asarray(np.sum(velocity.T * along, axis=0))
    return told
