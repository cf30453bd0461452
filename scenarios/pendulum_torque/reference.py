"""Motion of a pendulum with viscous and Coulomb friction under a given torque.

With θ the angle from hanging down, J the moment of inertia about the hinge (m·l² + I + rotor),

    J·θ̈ = s·u(t) - m·g·l·sin θ - K·θ - D·θ̇ - c·sgn θ̇

and, at rest, no motion at all while what drives it is smaller than c (Coulomb's law; the same c
holds and slides). K is 0 here; a servo has it. Between the corners of u the classical Runge-Kutta
scheme of fourth order takes steps of at most 1 ms and 0.0067/ω. The angle is then right to 1e-9 rad
(tests, against DOP853), and to 2e-8 rad where Coulomb friction has changed its sign some ten times.
Where the rate becomes 0 the step is cut, so that such a change never lies within one. Near the
upper rest every error grows, by e^(ω·t).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.model.signals import Signal
from simcompare.model.trajectory import Array
from simcompare.scenarios.instants import corners_of, crossing, grid

#: longest step [s], and longest step in radians of the fastest natural frequency
LONGEST_STEP_S = 0.001
LONGEST_STEP_RAD = 0.0067
#: two corners that are nearer than this are one [s]
SAME_S = 1e-9
#: halvings of a step in which an instant is looked for: 1 ms to 1e-18 s
MAX_HALVINGS = 50
#: turns in one step, of which there are hardly ever two
MAX_TURNS = 10
#: torque in a step as c0 + c1·x + c2·x², x the time since it began
Parabola = tuple[float, float, float]
#: Gauss' points in a step, as fractions: inside, so that a jump at its end is not seen
_INSIDE = (0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15))


@dataclass(frozen=True)
class Pendulum:
    """The constants of the equation of motion.

    Attributes:
        inertia: J, about the hinge [kg·m²].
        weight: m·g·l [N·m].
        damping: D [N·m·s/rad].
        friction: c [N·m].
        gain: s, torque for one unit of the input.
        stiffness: K [N·m/rad].
        constant: torque that is always there [N·m].
    """

    inertia: float
    weight: float
    damping: float
    friction: float
    gain: float = 1.0
    stiffness: float = 0.0
    constant: float = 0.0


def reference(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """Motion of the pendulum at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,), increasing [s].
        inputs: ``torque``, as the drive reports it.

    Returns:
        Coordinate (from the start angle) and rate of the hinge (n,).
    """
    length, mass = parameters["length_m"], parameters["mass_kg"]
    inertia = mass * length**2 + parameters["inertia_kg_m2"] + parameters["rotor_inertia_kg_m2"]
    pendulum = Pendulum(
        inertia=inertia,
        weight=mass * length * parameters["gravity_m_s2"],
        damping=parameters["damping_N_m_s_rad"],
        friction=parameters["friction_N_m"],
        gain=parameters["torque_scale"],
    )
    # the true angle; zero_rad is only what the sensor reads there
    hangs = parameters["start_angle_rad"] - parameters["zero_rad"]
    start = (hangs, parameters["start_rate_rad_s"])
    angle, rate = motion(pendulum, start, time_s, inputs["torque"])
    return {"hinge.angle_rad": angle - hangs, "hinge.rate_rad_s": rate}


def motion(
    pendulum: Pendulum, start: tuple[float, float], time_s: Array, drive: Signal
) -> tuple[Array, Array]:
    """Angle and rate (n,) at the times, from angle and rate at time 0."""
    angle, rate = np.empty(len(time_s)), np.empty(len(time_s))
    places, wanted = grid(time_s, corners_of(drive), _longest_s(pendulum), SAME_S)
    angle[wanted == 0], rate[wanted == 0] = start
    i = int(np.searchsorted(wanted, 1))
    state = start
    # what the step's end is to the samples: the next one of them, or none
    ends = wanted.tolist()
    for step, (length, torque) in enumerate(_steps(pendulum, places, drive), start=1):
        state = _through(pendulum, state, length, torque)
        while i < len(ends) and ends[i] == step:
            angle[i], rate[i] = state
            i += 1
    return angle, rate


def _longest_s(pendulum: Pendulum) -> float:
    """Longest step [s]: a hair more than a whole number of them is that number."""
    fastest = math.sqrt((pendulum.weight + pendulum.stiffness) / pendulum.inertia)
    longest = min(LONGEST_STEP_S, LONGEST_STEP_RAD / fastest) if fastest else LONGEST_STEP_S
    return longest * (1 + 1e-6)


def _steps(pendulum: Pendulum, places: Array, drive: Signal) -> Iterator[tuple[float, Parabola]]:
    """Length of every step, and the torque of the drive in it: a parabola.

    It goes through the signal at three points inside the step.
    """
    lengths = np.diff(places)
    first, middle, last = (
        pendulum.gain * drive.at(places[:-1] + part * lengths) for part in _INSIDE
    )
    reach = _INSIDE[2] - 0.5
    slope = (last - first) / (2 * reach)
    bend = (last - 2 * middle + first) / (2 * reach**2)
    # from x/length - 1/2 to x
    c_0 = pendulum.constant + middle - slope / 2 + bend / 4
    c_1, c_2 = (slope - bend) / lengths, bend / lengths**2
    drives = zip(c_0.tolist(), c_1.tolist(), c_2.tolist(), strict=True)
    yield from zip(lengths.tolist(), drives, strict=True)


def _through(
    pendulum: Pendulum, state: tuple[float, float], length: float, drive: Parabola
) -> tuple[float, float]:
    """Angle and rate after a step, in which the pendulum may turn back, stop and set off again."""
    begun = 0.0
    for _ in range(MAX_TURNS):
        way = (
            math.copysign(1.0, state[1])
            if state[1]
            else _way_from_rest(pendulum, state, begun, drive)
        )
        if not way:
            begun = _rests_until(pendulum, state, begun, length, drive)
            if begun >= length:
                return state
            # at this instant the drive is as large as the friction; which way is told by the drive
            way = math.copysign(1.0, _driven(pendulum, state[0], begun, drive))
        after = _slide(pendulum, state, way, begun, length - begun, drive)
        if way * after[1] >= 0 or not pendulum.friction:
            return after
        went = _turns_after(pendulum, state, way, begun, length - begun, drive)
        state = (_slide(pendulum, state, way, begun, went, drive)[0], 0.0)
        begun += went
    # it chatters: within a step of a millisecond it is at rest
    return state


def _slide(
    pendulum: Pendulum,
    state: tuple[float, float],
    way: float,
    begun: float,
    length: float,
    drive: Parabola,
) -> tuple[float, float]:
    """One step of the classical Runge-Kutta scheme with the friction against one way."""
    inverse, stiffness = 1 / pendulum.inertia, pendulum.stiffness
    weight, damping = pendulum.weight, pendulum.damping
    c_0, c_1, c_2 = drive
    c_0 -= way * pendulum.friction
    angle, rate = state
    half = 0.5 * length
    sine = math.sin
    x = begun
    a_1 = (
        c_0 + x * (c_1 + x * c_2) - weight * sine(angle) - stiffness * angle - damping * rate
    ) * inverse
    x += half
    u = c_0 + x * (c_1 + x * c_2)
    w_2, q = rate + half * a_1, angle + half * rate
    a_2 = (u - weight * sine(q) - stiffness * q - damping * w_2) * inverse
    w_3, q = rate + half * a_2, angle + half * w_2
    a_3 = (u - weight * sine(q) - stiffness * q - damping * w_3) * inverse
    x += half
    w_4, q = rate + length * a_3, angle + length * w_3
    a_4 = (c_0 + x * (c_1 + x * c_2) - weight * sine(q) - stiffness * q - damping * w_4) * inverse
    sixth = length / 6
    return (
        angle + sixth * (rate + 2 * (w_2 + w_3) + w_4),
        rate + sixth * (a_1 + 2 * (a_2 + a_3) + a_4),
    )


def _turns_after(
    pendulum: Pendulum,
    state: tuple[float, float],
    way: float,
    begun: float,
    length: float,
    drive: Parabola,
) -> float:
    """Time until the rate is 0, where it has changed its sign after ``length``."""

    def onward(x: float) -> float:
        return way * _slide(pendulum, state, way, begun, x, drive)[1]

    return crossing(onward, 0.0, length, MAX_HALVINGS)


def _driven(pendulum: Pendulum, angle: float, x: float, drive: Parabola) -> float:
    """What would set the pendulum in motion from rest [N·m]."""
    torque = drive[0] + x * (drive[1] + x * drive[2])
    return torque - pendulum.weight * math.sin(angle) - pendulum.stiffness * angle


def _way_from_rest(
    pendulum: Pendulum, state: tuple[float, float], x: float, drive: Parabola
) -> float:
    """Which way it sets off from rest: 1, -1, or 0 where the friction holds it."""
    pull = _driven(pendulum, state[0], x, drive)
    return math.copysign(1.0, pull) if abs(pull) > pendulum.friction else 0.0


def _rests_until(
    pendulum: Pendulum, state: tuple[float, float], begun: float, length: float, drive: Parabola
) -> float:
    """When the drive exceeds the friction; the step's length where it does not within it."""

    def spare(x: float) -> float:
        return pendulum.friction - abs(_driven(pendulum, state[0], begun + x, drive))

    if spare(length - begun) >= 0:
        return length
    return begun + crossing(spare, 0.0, length - begun, MAX_HALVINGS)
