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
    "speed": Role("speed of the vehicle", "m/s", needed=False),
    "acceleration": Role("acceleration of the vehicle", "m/s**2", needed=False),
}
OPTIONS = {
    "diameter_m": Option("diameter of the wheel", least=1e-3),
    "u_diameter_m": Option("standard uncertainty of the diameter", 0.0),
    "marks": Option("marks in one turn of the wheel", 0.0),
    "gate_s": Option("time in which marks are counted", 0.01, 1e-4),
    "jerk_density_m2_s5": Option("density q of the white jerk", 1.0, 1e-12, loosens=True),
    "bias": Option("1: the accelerometer's bias is a state", 0.0, 0.0, 1.0, bias_of="acceleration"),
    "u_bias_m_s2": Option("standard uncertainty of the bias at the start", 0.5, 1e-9),
    "by_way": Option("1: marks are read as a way, a state more", 1.0, 0.0, 1.0, adds_up="marks"),
    "u_start_speed_m_s": Option("standard uncertainty of the speed at the start", 1.0, 1e-9),
    "u_start_acceleration_m_s2": Option("the same of the acceleration", 3.0, 1e-9),
}
LABELS = {
    "speed_m_s": "Speed",
    "acceleration_m_s2": "Acceleration",
    "bias_m_s2": "Bias of the accelerometer",
    "way_m": "Way of the wheel",
}
#: numbers of two states, and what is not known of each state at the start
_BIAS, _WAY = 2, 3
_STARTS = ("u_start_speed_m_s", "u_start_acceleration_m_s2", "u_bias_m_s2", "diameter_m")


def estimate(given: Given) -> Estimate:
    """Filters, smooths, and tells beside it what each sensor says alone."""
    wheel, gate_s = _wheel(given)
    acceleration = given.signals.get("acceleration")
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


def matrices(step_s: float, jerk_density_m2_s5: float) -> tuple[Array, Array]:
    """F and Q of one step under white jerk, for speed and acceleration."""
    t = step_s
    noise = jerk_density_m2_s5 * np.array([[t**3 / 3, t**2 / 2], [t**2 / 2, t]])
    return np.array([[1.0, t], [0.0, 1.0]]), noise


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
    rows = {"the wheel": (wheel, [1.0, -gate_s / 2, 0.0, 0.0])}
    if _by_way(given):
        rows = {"the wheel": (_way_of_marks(given, wheel.time_s), [0.0, 0.0, 0.0, 1.0])}
    if acceleration is not None:
        rows["the accelerometer"] = (acceleration, [0.0, 1.0, 1.0, 0.0])
    noise = np.diag([timing.variance_of(one, name) for name, (one, _) in rows.items()])
    observation = np.array([row for _, row in rows.values()])[:, states]

    def move(mean: Array, number: int) -> Motion:
        step_s = float(time_s[number] - time_s[number - 1])
        whole, open_ = _all_matrices(step_s, options["jerk_density_m2_s5"])
        transition = whole[np.ix_(states, states)]
        return Motion(transition @ mean, transition, open_[np.ix_(states, states)])

    def expect(mean: Array, number: int) -> Expected:
        return Expected(observation @ mean, observation, noise)

    measured = timing.placed([one for one, _ in rows.values()], time_s)
    mean, u = np.zeros(4), np.array([options[name] for name in _STARTS])
    if _by_way(given):  # the first way tells no speed yet; the gate before it does
        mean[0], mean[_WAY] = wheel.values[0], measured[0, 0]
        u[0] = math.sqrt(timing.variance_of(wheel, "the wheel"))
    belief = Belief(mean[states], np.diag(np.square(u[states])))
    return kalman.run(belief, measured, move, expect)


def _all_matrices(step_s: float, jerk_density_m2_s5: float) -> tuple[Array, Array]:
    """F and Q of one step with a bias, which stays, and the way."""
    t, q = step_s, jerk_density_m2_s5
    transition, noise = np.eye(4), np.zeros((4, 4))
    transition[:2, :2], noise[:2, :2] = matrices(t, q)
    transition[_WAY, :2] = t, t**2 / 2
    noise[_WAY, :2] = noise[:2, _WAY] = q * t**4 / 8, q * t**3 / 6
    noise[_WAY, _WAY] = q * t**5 / 20
    return transition, noise


def _way_of_marks(given: Given, time_s: Array) -> Signal:
    """The way by all marks since the start, at these times; each is evenly spread over a mark."""
    pitch_m = way_of_mark(given.options["diameter_m"], given.options["marks"])
    counts = timing.held(given.signals["marks"], time_s)
    return Signal(time_s, pitch_m * (counts - counts[0]), pitch_m / math.sqrt(12))


def _by_way(given: Given) -> bool:
    return bool(given.options["by_way"]) and "marks" in given.signals


def _states(given: Given) -> list[int]:
    """Numbers of the states: speed and acceleration, bias and way where they are wanted."""
    with_bias = bool(given.options["bias"]) and "acceleration" in given.signals
    return [0, 1, *([_BIAS] if with_bias else []), *([_WAY] if _by_way(given) else [])]


def _names(given: Given) -> list[str]:
    return [list(LABELS)[number] for number in _states(given)]


def _way(given: Given, name: str, time_s: Array, means: Array, u: Array) -> Way:
    truths = {"speed_m_s": "speed", "acceleration_m_s2": "acceleration"}
    return Way(
        name,
        time_s,
        {
            state: State(means[:, i], u[:, i], given.truth_at(truths.get(state, ""), time_s))
            for i, state in enumerate(_names(given))
        },
    )


def _alone(given: Given, name: str, signal: Signal, truth: str, age_s: float) -> Way:
    """What one sensor says of one state; a reading is so much older than its stamp."""
    time_s = signal.time_s - age_s
    state = "speed_m_s" if truth == "speed" else "acceleration_m_s2"
    u = None if signal.u is None else np.broadcast_to(signal.u, time_s.shape)
    return Way(name, time_s, {state: State(signal.values, u, given.truth_at(truth, time_s))})


def _integrated(given: Given, acceleration: Signal, first_m_s: float) -> Way:
    """The speed as the sum of accelerations, from the first one that the wheel tells."""
    time_s, values = acceleration.time_s, acceleration.values
    steps = np.diff(time_s) * (values[1:] + values[:-1]) / 2
    speed = first_m_s + np.concatenate(([0.0], np.cumsum(steps)))
    state = State(speed, None, given.truth_at("speed", time_s))
    return Way("acceleration summed up", time_s, {"speed_m_s": state})


def _open(given: Given, way: Way) -> dict[str, Number]:
    """What the diameter leaves open."""
    diameter_m, u_m = given.options["diameter_m"], given.options["u_diameter_m"]
    speed = float(np.abs(way.states["speed_m_s"].values[-1]))
    return {"speed_open_by_diameter": Number(speed * u_m / diameter_m, "m/s")} if u_m else {}
