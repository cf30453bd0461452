"""Speed of a vehicle from a wheel and an accelerometer: the Kalman filter of the first lesson.

The state is the speed v and the acceleration a, and, where it is wanted, the bias b of the
accelerometer. What changes a is white jerk of density q, so in a step of T

    F = [1 T]     Q = q·[T³/3  T²/2]     a wheel reads v, an accelerometer a + b
        [0 1]           [T²/2  T   ]

Marks tell a way, a state more: each sum of marks has an error of its own. Counted in a gate of T_g
they tell its mean speed, half a gate old: v - a·T_g/2. But neighbouring counts share the end of a
gate, so their errors cancel, which R cannot say; such a filter is too careful. R holds noise. A
diameter that is taken for too large makes every speed too large by the same part: that is no noise
and averages out in no filter, so it is told beside it.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from simcompare.errors import InputError
from simcompare.estimation import consistency, kalman, timing
from simcompare.estimation.estimate import (
    Estimate,
    Given,
    Number,
    Signal,
    State,
    Way,
)
from simcompare.estimation.estimators import Option, Role
from simcompare.estimation.kalman import Belief, Expected, Filtered, Motion
from simcompare.estimation.smoother import smooth
from simcompare.estimation.wheel import speed_from_rate, way_of_mark
from simcompare.model.trajectory import Array

TITLE = "Speed from a wheel and an accelerometer"
SIGNALS = {
    "marks": Role("marks of the wheel that have passed", "1", needed=False),
    "wheel_rate": Role("rate of the wheel, in place of marks", "rad/s", needed=False),
    "acceleration": Role("reading of the accelerometer along the way", "m/s**2", needed=False),
}
TRUTHS = {
    "way": Role("way of the vehicle, of which the others are changes", "m", needed=False),
    "speed": Role("speed of the vehicle", "m/s", needed=False),
    "acceleration": Role("acceleration of the vehicle", "m/s**2", needed=False),
}
OPTIONS = {
    "diameter_m": Option("diameter of the wheel", least=1e-3),
    "u_diameter_m": Option("standard uncertainty of the diameter", 0.0),
    "marks": Option("marks in one turn of the wheel", 0.0),
    "gate_s": Option("time in which marks are counted", 0.01, 1e-4),
    "jerk_density_m2_s5": Option("density q of the white jerk", 1.0, 1e-12, loosens=True),
    "settling_s": Option("time constant with which accelerations fade; 0: they do not", 0.0),
    "faster": Option("part by which they fade faster", 0.0, -0.5, 0.5, u="u_settling"),
    "u_settling": Option("standard uncertainty of that part", 0.01, 1e-9, 0.5),
    "imu_late_s": Option("by how much the accelerometer is late", 0.0, 0.0, 1.0),
    "truth_over_s": Option(
        "the true speed is the change of the way in half of this time, and the acceleration the"
        " difference of that between its halves; 0: they are what is told",
        0.0,
    ),
    "bias": Option("1: the accelerometer's bias is a state", 0.0, 0.0, 1.0, bias_of="acceleration"),
    "u_bias_m_s2": Option("standard uncertainty of the bias at the start", 0.5, 1e-9),
    "scale": Option(
        "1: the part by which the accelerometer reads too much is a state",
        0.0,
        0.0,
        1.0,
        bias_of="acceleration",
    ),
    "u_scale": Option("standard uncertainty of that part at the start", 0.03, 1e-9),
    "by_way": Option("1: marks are read as a way, a state more", 1.0, 0.0, 1.0, adds_up="marks"),
    "u_start_speed_m_s": Option("standard uncertainty of the speed at the start", 1.0, 1e-9),
    "u_start_acceleration_m_s2": Option("the same of the acceleration", 3.0, 1e-9),
}
LABELS = {
    "speed_m_s": "Speed",
    "acceleration_m_s2": "Acceleration",
    "bias_m_s2": "Bias of the accelerometer",
    "way_m": "Way of the wheel",
    "faster": "Part by which acceleration fades faster",
    "accelerometer_scale": "Scale error of the accelerometer",
}
_TRUE = {"speed_m_s": "speed", "acceleration_m_s2": "acceleration"}
#: numbers of two states, and what is not known of each state at the start
_BIAS, _WAY, _FASTER, _SCALE = 2, 3, 4, 5
_STARTS = (
    "u_start_speed_m_s", "u_start_acceleration_m_s2", "u_bias_m_s2", "diameter_m", "u_settling",
    "u_scale",
)  # fmt: skip


def estimate(given: Given) -> Estimate:
    """Filters, smooths, and tells beside it what each sensor says alone."""
    wheel, gate_s = _wheel(given)
    acceleration = given.signals.get("acceleration")
    if acceleration is not None:  # a low-pass tells what was a little earlier
        late_s = given.options["imu_late_s"]
        acceleration = replace(acceleration, time_s=acceleration.time_s - late_s)
    time_s = timing.merged([wheel, *([] if acceleration is None else [acceleration])])
    # before the wheel has told a speed there is nothing to filter
    time_s = time_s[time_s >= wheel.time_s[0] - timing.SAME_S]
    filtered = _filtered(given, time_s, wheel, acceleration, gate_s)
    smoothed = smooth(filtered)
    ways = [
        _way(given, "filtered", time_s, filtered.means, filtered.uncertainties),
        _way(given, "smoothed", time_s, smoothed.means, smoothed.uncertainties),
        _alone(given, "wheel alone", wheel, "speed", gate_s / 2),
    ]
    if acceleration is not None:
        ways += [
            _integrated(given, acceleration, float(wheel.values[0])),
            _alone(given, "accelerometer alone", acceleration, "acceleration", 0.0),
        ]
    names = ("wheel", "accelerometer")[: filtered.innovations.shape[1]]
    counted = ("wheel",) if "marks" in given.signals and not _by_way(given) else ()
    innovations = consistency.innovations_of(filtered, ways[0], names, counted)
    labels = {name: LABELS[name] for name in _names(given)}
    return Estimate(tuple(ways), labels, innovations, {**_open(given, ways[0]), **ways[0].last})


def matrices(
    step_s: float, jerk_density_m2_s5: float, settling_s: float = 0.0
) -> tuple[Array, Array]:
    """F and Q of one step under white jerk, for speed and acceleration."""
    both = _all_matrices(step_s, jerk_density_m2_s5, settling_s)
    return both[0][:2, :2], both[1][:2, :2]


def _wheel(given: Given) -> tuple[Signal, float]:
    """Speeds that the wheel tells with their noise, and the gate that they are a mean of [s]."""
    options = given.options
    if "marks" in given.signals:
        gate_s = options["gate_s"]
        rates = timing.counted(given.signals["marks"], options["marks"], gate_s)
    elif "wheel_rate" in given.signals:
        rates, gate_s = given.signals["wheel_rate"], 0.0
    else:
        raise InputError("estimate", ["no wheel is given; expected the signal marks or wheel_rate"])
    radius_m = options["diameter_m"] / 2
    u = None if rates.u is None else radius_m * np.asarray(rates.u)
    return Signal(rates.time_s, speed_from_rate(options["diameter_m"], rates.values), u), gate_s


def _filtered(
    given: Given, time_s: Array, wheel: Signal, acceleration: Signal | None, gate_s: float
) -> Filtered:
    options, states = given.options, _states(given)
    # what each reading says of speed, acceleration, bias and way
    rows = {"the wheel": (wheel, [1.0, -gate_s / 2, *4 * [0.0]])}
    if _by_way(given):
        rows = {"the wheel": (_way_of_marks(given, wheel.time_s), [0.0, 0.0, 0.0, 1.0, 0.0, 0.0])}
    if acceleration is not None:
        rows["the accelerometer"] = (acceleration, [0.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    noise = np.diag([timing.variance_of(one, name) for name, (one, _) in rows.items()])
    observation = np.array([row for _, row in rows.values()])

    def move(mean: Array, number: int) -> Motion:
        step_s = float(time_s[number] - time_s[number - 1])
        every = np.zeros(len(_STARTS))
        every[states] = mean
        settling_s = options["settling_s"] / (1 + every[_FASTER])
        whole, open_ = _all_matrices(step_s, options["jerk_density_m2_s5"], settling_s)
        moved = (whole @ every)[states]
        if settling_s:  # what has faded grows by as large a part as it fades faster
            faded = step_s / options["settling_s"] * every[1]
            for state, share in ((1, 1.0), (0, step_s / 2), (_WAY, step_s**2 / 6)):
                whole[state, _FASTER] = -share * faded
        return Motion(moved, whole[np.ix_(states, states)], open_[np.ix_(states, states)])

    def expect(mean: Array, number: int) -> Expected:
        slopes, values = observation.copy(), observation[:, states] @ mean
        if _SCALE in states:  # of an acceleration a part k more is read, k·a
            scale = mean[states.index(_SCALE)]
            slopes[1, [1, _SCALE]] = 1 + scale, mean[1]
            values[1] += scale * mean[1]
        return Expected(values, slopes[:, states], noise)

    measured = timing.placed([one for one, _ in rows.values()], time_s)
    mean, u = np.zeros(len(_STARTS)), np.array([options[name] for name in _STARTS])
    mean[_FASTER] = options["faster"]
    if _by_way(given):  # the first way tells no speed yet; the gate before it does
        mean[0], mean[_WAY] = wheel.values[0], measured[0, 0]
        u[0] = math.sqrt(timing.variance_of(wheel, "the wheel"))
    belief = Belief(mean[states], np.diag(np.square(u[states])))
    return kalman.run(belief, measured, move, expect)


#: places and weights between 0 and 1 at which integrals over a step are taken (Gauss and Legendre)
_PLACES, _WEIGHTS = (both / 2 for both in np.polynomial.legendre.leggauss(12))


def _all_matrices(
    step_s: float, jerk_density_m2_s5: float, settling_s: float
) -> tuple[Array, Array]:
    """F and Q of one step with a bias, which stays, and the way.

    A jolt τ before the end has left exp(-τ/S) of itself as acceleration, the sum of that as speed,
    and the sum of this as way; Q is the integral of their products.
    """
    ago_s = step_s * np.append(_PLACES + 0.5, 1.0)
    acceleration, speed, way = np.ones_like(ago_s), ago_s, ago_s**2 / 2
    if settling_s:
        acceleration = np.exp(-ago_s / settling_s)
        speed = -settling_s * np.expm1(-ago_s / settling_s)
        way = settling_s * (ago_s - speed)
    left = np.zeros((len(_STARTS), len(ago_s)))
    left[[0, 1, _WAY]] = speed, acceleration, way
    transition = np.eye(len(left))
    transition[_WAY, 0] = step_s
    transition[:, 1] = left[:, -1]
    return transition, jerk_density_m2_s5 * step_s * (left[:, :-1] * _WEIGHTS) @ left[:, :-1].T


def _way_of_marks(given: Given, time_s: Array) -> Signal:
    """The way by all marks since the start, at these times; each is evenly spread over a mark."""
    pitch_m = way_of_mark(given.options["diameter_m"], given.options["marks"])
    counts = timing.held(given.signals["marks"], time_s)
    return Signal(time_s, pitch_m * (counts - counts[0]), pitch_m / math.sqrt(12))


def _by_way(given: Given) -> bool:
    return bool(given.options["by_way"]) and "marks" in given.signals


def _states(given: Given) -> list[int]:
    """Numbers of the states: speed and acceleration, bias and way where they are wanted."""
    options, felt = given.options, "acceleration" in given.signals
    wanted = {
        _BIAS: bool(options["bias"]) and felt, _WAY: _by_way(given),
        _FASTER: options["settling_s"] > 0, _SCALE: bool(options["scale"]) and felt,
    }  # fmt: skip
    return [0, 1, *(number for number, one in wanted.items() if one)]


def _names(given: Given) -> list[str]:
    return [list(LABELS)[number] for number in _states(given)]


def _way(given: Given, name: str, time_s: Array, means: Array, u: Array) -> Way:
    return Way(
        name,
        time_s,
        {
            state: State(means[:, i], u[:, i], _truth(given, _TRUE.get(state, ""), time_s))
            for i, state in enumerate(_names(given))
        },
    )


def _truth(given: Given, role: str, time_s: Array) -> Array | None:
    """What is true in a role at these times (n,): told, or by changes of the way."""
    half_s = given.options["truth_over_s"] / 2
    if not half_s or "way" not in given.truth or role not in _TRUE.values():
        return given.truth_at(role, time_s)
    way = given.truth["way"]
    if role == "speed":
        return np.asarray((way.at(time_s + half_s / 2) - way.at(time_s - half_s / 2)) / half_s)
    around = way.at(time_s + half_s) - 2 * way.at(time_s) + way.at(time_s - half_s)
    return np.asarray(around / half_s**2)


def _alone(given: Given, name: str, signal: Signal, truth: str, age_s: float) -> Way:
    """What one sensor says of one state; a reading is so much older than its stamp."""
    time_s = signal.time_s - age_s
    state = "speed_m_s" if truth == "speed" else "acceleration_m_s2"
    u = None if signal.u is None else np.broadcast_to(signal.u, time_s.shape)
    return Way(name, time_s, {state: State(signal.values, u, _truth(given, truth, time_s))})


def _integrated(given: Given, acceleration: Signal, first_m_s: float) -> Way:
    """The speed as the sum of accelerations, from the first one that the wheel tells."""
    time_s, values = acceleration.time_s, acceleration.values
    steps = np.diff(time_s) * (values[1:] + values[:-1]) / 2
    speed = first_m_s + np.concatenate(([0.0], np.cumsum(steps)))
    state = State(speed, None, _truth(given, "speed", time_s))
    return Way("acceleration summed up", time_s, {"speed_m_s": state})


def _open(given: Given, way: Way) -> dict[str, Number]:
    """What the diameter leaves open."""
    diameter_m, u_m = given.options["diameter_m"], given.options["u_diameter_m"]
    speed = float(np.abs(way.states["speed_m_s"].values[-1]))
    return {"speed_open_by_diameter": Number(speed * u_m / diameter_m, "m/s")} if u_m else {}
