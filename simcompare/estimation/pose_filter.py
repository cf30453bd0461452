"""Pose of a robot on two wheels: the extended Kalman filter with motors, wheels, gyroscope, ranges.

``pose_model`` says how the five states move and what is read; here readings are put in order of
time, filtered, and a reading that cannot be (far beyond its own innovation's u) is refused.
Without motors the speed and the rate are only kept; their noise must then allow for what changes.

An accelerometer reads what the speed changed by since its last reading, (v - v')/T: its bumps are
those that shake the speed, the noise of the motion and what is read are correlated. With v' as a
state more, the filter knows that by itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation import consistency, kalman, pose_model, timing
from simcompare.estimation.estimate import Estimate, Given, Signal, State, Way
from simcompare.estimation.kalman import Belief, Expected, Filtered, Motion
from simcompare.estimation.pose_model import Ranger, Robot
from simcompare.estimation.pose_roles import LABELS, OPTIONS, SIGNALS, TITLE, TRUTHS
from simcompare.estimation.smoother import smooth
from simcompare.hardware.sensors import odometer
from simcompare.model.trajectory import Array

__all__ = ["LABELS", "OPTIONS", "SIGNALS", "TITLE", "TRUTHS", "estimate"]
_READINGS = ("left_rate", "right_rate", "turning_rate", "acceleration", "range", "wall_range")
#: the speed when the accelerometer was last read
_BEFORE = "speed_before_m_s"


@dataclass(frozen=True, eq=False)
class _Setting:
    """Everything that the filter needs at a time."""

    given: Given
    robot: Robot
    ranger: Ranger
    gate_s: float
    readings: dict[str, Signal]
    time_s: Array
    inputs: Array
    beacons: Array
    since_s: Array


def estimate(given: Given) -> Estimate:
    """Filters, smooths, and tells beside it what the wheels say alone."""
    setting = _setting(given)
    filtered = _filtered(setting)
    smoothed = smooth(filtered)
    time_s = setting.time_s
    ways = (
        _way(given, "filtered", time_s, filtered.means, filtered.uncertainties),
        _way(given, "smoothed", time_s, smoothed.means, smoothed.uncertainties),
        _reckoned(setting),
    )
    labels = {name: LABELS[name] for name in ways[0].states}
    counted = tuple(f"{s}_rate" for s in ("left", "right") if f"{s}_marks" in given.signals)
    innovations = consistency.innovations_of(filtered, ways[0], [*setting.readings], counted)
    return Estimate(ways, labels, innovations, ways[0].last)


def _setting(given: Given) -> _Setting:
    readings, gate_s = _readings(given)
    time_s = timing.merged(list(readings.values()))
    beacons = np.full((len(time_s), 2), np.nan)
    if "range" in readings:
        at = readings["range"].time_s
        places = np.searchsorted(time_s, at - timing.SAME_S)
        for i, role in enumerate(("beacon_x", "beacon_y")):
            beacons[places, i] = given.signal(role).at(at)
    kind, inputs = _inputs(given, time_s)
    o = given.options
    ranger = Ranger(o["ranger_ahead_m"], o["ranger_left_m"], o["beam_rad"])
    since_s = _since(readings, time_s)
    robot = _robot(given, kind)
    return _Setting(given, robot, ranger, gate_s, readings, time_s, inputs, beacons, since_s)


def _since(readings: dict[str, Signal], time_s: Array) -> Array:
    """Time since the accelerometer was read last (n,), infinite at its first reading, else NaN."""
    found = np.full(len(time_s), np.nan)
    if "acceleration" in readings:
        at = readings["acceleration"].time_s
        found[np.searchsorted(time_s, at - timing.SAME_S)] = np.diff(at, prepend=-np.inf)
    return found


def _robot(given: Given, kind: str) -> Robot:
    o = given.options
    drive = {"voltage": o["drive_N_V"], "current": o["drive_N_A"]}.get(kind, 0.0)
    damping = {"voltage": o["damping_N_s_m"], "current": o["current_damping_N_s_m"]}
    return Robot(
        o["radius_m"], o["track_m"], o["inertia_kg"], o["turning_inertia_kg_m2"], drive,
        damping.get(kind, 0.0), o["friction_N"] if kind else 0.0, o["speed_noise_m2_s3"],
        o["turn_noise_rad2_s3"],
    )  # fmt: skip


def _readings(given: Given) -> tuple[dict[str, Signal], float]:
    """Role -> readings, marks counted; and the gate in which they were [s]."""
    found, gate_s = {}, 0.0
    for side in ("left", "right"):
        if f"{side}_marks" in given.signals:
            gate_s = given.options["gate_s"]
            marks = given.signals[f"{side}_marks"]
            found[f"{side}_rate"] = timing.counted(marks, given.options["marks"], gate_s)
    for role in _READINGS:
        if role in given.signals:
            found.setdefault(role, given.signals[role])
    if not {"left_rate", "right_rate"} <= set(found):
        wanted = "expected left_marks and right_marks, or left_rate and right_rate"
        raise InputError("estimate", [f"the wheels are not given; {wanted}"])
    return {role: found[role] for role in _READINGS if role in found}, gate_s


def _inputs(given: Given, time_s: Array) -> tuple[str, Array]:
    """What the motors are driven by, and both inputs (n, 2); none where nothing is given."""
    for kind in ("voltage", "current"):
        roles = (f"left_{kind}", f"right_{kind}")
        if all(role in given.signals for role in roles):
            columns = [given.signals[role].at(time_s) for role in roles]
            return kind, np.nan_to_num(np.array(columns).T)
    return "", np.zeros((len(time_s), 2))


def _filtered(setting: _Setting) -> Filtered:
    o, time_s = setting.given.options, setting.time_s
    mean = np.array([o["start_x_m"], o["start_y_m"], o["start_heading_rad"], 0.0, 0.0])
    u = [o["u_start_m"]] * 2 + [
        o["u_start_heading_rad"], o["u_start_speed_m_s"], o["u_start_rate_rad_s"]
    ]  # fmt: skip
    u += [o["u_start_speed_m_s" if one == _BEFORE else f"u_{one}"] for one in _more(setting.given)]
    mean = np.append(mean, [0.0] * (len(u) - 5))
    noise = np.diag([timing.variance_of(one, name) for name, one in setting.readings.items()])

    def move(state: Array, number: int) -> Motion:
        step_s = float(time_s[number] - time_s[number - 1])
        left, right = setting.inputs[number - 1]
        motion = pose_model.move(setting.robot, state[:5], step_s, left, right)
        return _with_more(setting.given, motion, state, not np.isnan(setting.since_s[number - 1]))

    def expect(state: Array, number: int) -> Expected:
        return _expected(setting, state, number, noise)

    measured = timing.placed(list(setting.readings.values()), time_s)
    if "acceleration" in setting.readings:  # the first one has none before it
        measured[np.isinf(setting.since_s), list(setting.readings).index("acceleration")] = np.nan
    start = Belief(mean, np.diag(np.square(u)))
    return kalman.run(start, measured, move, expect, gate=o["gate"] or None)


#: bias that can be a state -> the option that makes it one, and the reading that has it
_BIASES = {
    "bias_rad_s": ("bias", "turning_rate"),
    "acceleration_bias_m_s2": ("acceleration_bias", "acceleration"),
    "range_bias_m": ("range_bias", "range"),
}


def _biases(given: Given) -> list[str]:
    """Constant errors of sensors that are states here."""
    return [
        name
        for name, (option, role) in _BIASES.items()
        if given.options[option] and role in given.signals
    ]


def _more(given: Given) -> list[str]:
    """States beside those of the robot."""
    return [*_biases(given), *([_BEFORE] if "acceleration" in given.signals else [])]


def _with_more(given: Given, motion: Motion, state: Array, was_read: bool) -> Motion:
    """The same motion with states that stay as they are, but for the speed at a last reading."""
    transition, noise = np.eye(len(state)), np.zeros((len(state), len(state)))
    transition[:5, :5], noise[:5, :5] = motion.transition, motion.noise
    if was_read and "acceleration" in given.signals:
        transition[-1, [pose_model.SPEED, -1]] = 1.0, 0.0
    return Motion(np.append(motion.mean, transition[5:] @ state), transition, noise)


def _expected(setting: _Setting, state: Array, number: int, noise: Array) -> Expected:
    """What every sensor should read, in the order of the readings."""
    left, right = setting.inputs[max(number - 1, 0)]
    rates, slopes = pose_model.wheel_rates(setting.robot, state, left, right, setting.gate_s)
    values, rows = list(rates), list(slopes)
    o = setting.given.options
    if "turning_rate" in setting.readings:
        values.append(state[pose_model.RATE])
        rows.append(np.eye(5)[pose_model.RATE])
    if "acceleration" in setting.readings:
        ahead, rate = o["accelerometer_ahead_m"], state[pose_model.RATE]
        row = np.zeros(5)
        row[pose_model.SPEED] = 1 / _interval(setting, number)
        row[pose_model.RATE] = -2 * ahead * rate
        values.append(row[pose_model.SPEED] * state[pose_model.SPEED] - ahead * rate**2)
        rows.append(row)
    if "range" in setting.readings:
        beacon = np.nan_to_num(setting.beacons[number])
        value, row = pose_model.range_to_beacon(setting.ranger, state, beacon)
        values.append(value)
        rows.append(row)
    if "wall_range" in setting.readings:
        value, row = pose_model.range_to_wall(
            setting.ranger, state, o["wall_normal_rad"], o["wall_m"]
        )
        values.append(value)
        rows.append(row)
    both = np.zeros((len(rows), len(state)))
    both[:, :5] = rows
    names = list(setting.readings)
    for place, name in enumerate(_biases(setting.given), start=5):
        both[names.index(_BIASES[name][1]), place] = 1.0
    if "acceleration" in names:
        both[names.index("acceleration"), -1] = -1 / _interval(setting, number)
    return Expected(np.array(values) + both[:, 5:] @ state[5:], both, noise)


def _interval(setting: _Setting, number: int) -> float:
    """What the accelerometer's reading is a mean over [s]; any number where it is not read."""
    since_s = float(setting.since_s[number])
    return since_s if np.isfinite(since_s) else 1.0


def _reckoned(setting: _Setting) -> Way:
    """Dead reckoning: what the rates of the wheels alone add up to, from the same start."""
    left, right = setting.readings["left_rate"], setting.readings["right_rate"]
    time_s, robot, o = left.time_s, setting.robot, setting.given.options
    both = robot.radius_m * np.array([left.values, right.at(time_s)])
    both[:, np.isnan(both).any(axis=0)] = 0.0
    ways = np.cumsum(np.diff(time_s, prepend=time_s[0] - setting.gate_s) * both, axis=1)
    rolled_left, rolled_right = np.insert(ways, 0, 0.0, axis=1)
    start = (o["start_x_m"], o["start_y_m"], o["start_heading_rad"])
    driven = odometer.arcs(rolled_left, rolled_right, robot.track_m, start[2])
    rates = (both.mean(axis=0), (both[1] - both[0]) / robot.track_m)
    means = np.column_stack((odometer.poses(driven, start)[1:], *rates))
    return _way(setting.given, "wheels alone", time_s, means, None)


def _way(given: Given, name: str, time_s: Array, means: Array, u: Array | None) -> Way:
    states = {}
    roles = [*TRUTHS, *[""] * len(LABELS)]
    for i, state in enumerate(_names(given)[: means.shape[1]]):
        role = roles[i]
        states[state] = State(
            means[:, i], None if u is None else u[:, i], given.truth_at(role, time_s),
            circular=role == "heading",
        )  # fmt: skip
    return Way(name, time_s, states)


def _names(given: Given) -> list[str]:
    """States that are told, those of the robot first."""
    return [*list(LABELS)[:5], *_biases(given)]
