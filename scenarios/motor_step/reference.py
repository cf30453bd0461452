"""Closed form of a motor under a voltage that is made of straight lines.

With i = (V - k·ω)/R the rate follows J·ω̇ = (k/R)·V - D·ω - τ_c·sgn ω, D = k²/R + b. While V is a
straight line and the shaft keeps turning one way, the solution is a straight line and what is left
of the start, ω = A + B·t + C·exp(-t/T) with T = J/D. Where the rate becomes 0 a new piece begins;
at rest the shaft stays while |k·V/R| ≤ τ_c.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare.errors import InputError
from simcompare.model.signals import Constant, Ramp, Signal, Step, Table
from simcompare.model.trajectory import Array
from simcompare.scenarios.instants import corners_of, crossing, piece_at

#: halvings in which an instant is looked for
HALVINGS = 80
#: pieces between two corners of the voltage, of which there are hardly ever more than two
MAX_PIECES = 10


def reference(
    parameters: Mapping[str, float], time_s: Array, inputs: Mapping[str, Signal]
) -> dict[str, Array]:
    """Motion of the shaft and what the motor takes at the given times.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on, growing (n,) [s].
        inputs: ``supply``, the voltage.

    Returns:
        Angle and rate of the shaft, voltage, current and torque of the motor, each (n,).

    Raises:
        InputError: a voltage that is not made of straight lines.
    """
    supply = inputs["supply"]
    if not isinstance(supply, Constant | Step | Ramp | Table):
        fault = "the voltage must be constant, a step, a ramp or a table; no closed form is known"
        raise InputError("inputs.supply", [fault])
    k, resistance = parameters["torque_constant_N_m_A"], parameters["resistance_Ohm"]
    angle, rate = motion(parameters, time_s, supply)
    voltage = supply.at(time_s)
    current = (voltage - k * rate) / resistance
    return {
        "shaft.angle_rad": angle,
        "shaft.rate_rad_s": rate,
        "motor.voltage_V": voltage,
        "motor.current_A": current,
        "motor.torque_N_m": k * current,
    }


@dataclass(frozen=True)
class Piece:
    """Part of the motion: ω = a + b·t + c·exp(-t/T) from ``start_s`` on."""

    start_s: float
    angle: float
    a: float
    b: float
    c: float

    def rate_at(self, t: float, lasting: float) -> float:
        """Rate t after the start [rad/s]."""
        return self.a + self.b * t + self.c * math.exp(-t / lasting)

    def angle_at(self, t: float, lasting: float) -> float:
        """Angle t after the start [rad]."""
        faded = -math.expm1(-t / lasting)
        return self.angle + self.a * t + self.b * t * t / 2 + self.c * lasting * faded


def motion(parameters: Mapping[str, float], time_s: Array, supply: Signal) -> tuple[Array, Array]:
    """Angle [rad] and rate [rad/s] at the given times (n,)."""
    pieces, lasting = _pieces(parameters, float(time_s[-1]) if len(time_s) else 0.0, supply)
    table = np.array([(p.start_s, p.angle, p.a, p.b, p.c) for p in pieces])
    start, angle, a, b, c = table[piece_at(table[:, 0], time_s)].T
    t = time_s - start
    angle = angle + a * t + b * t**2 / 2 - c * lasting * np.expm1(-t / lasting)
    return angle, a + b * t + c * np.exp(-t / lasting)


def _pieces(
    parameters: Mapping[str, float], until_s: float, supply: Signal
) -> tuple[list[Piece], float]:
    """All pieces up to a time, and the time constant T."""
    k, resistance = parameters["torque_constant_N_m_A"], parameters["resistance_Ohm"]
    friction = parameters["friction_N_m"]
    fall = k * k / resistance + parameters["damping_N_m_s_rad"]
    lasting = parameters["inertia_kg_m2"] / fall
    bends = corners_of(supply)
    bends = bends[(bends > 0) & (bends < until_s)]
    starts = np.concatenate(([0.0], bends))
    ends = np.append(bends, max(until_s, float(starts[-1])) + lasting)
    # two points inside, so that a jump at either end is not seen
    first, last = (supply.at(starts + part * (ends - starts)) for part in (0.25, 0.75))
    slope = (last - first) / (0.5 * (ends - starts))
    begin = first - 0.25 * (ends - starts) * slope
    pieces: list[Piece] = []
    state = (0.0, parameters["start_rate_rad_s"])
    for start, end, u, s in zip(starts.tolist(), ends.tolist(), begin.tolist(), slope.tolist(),
                                strict=True):  # fmt: skip
        torques = (k / resistance * u, k / resistance * s, fall, friction)
        state = _through(pieces, (start, end), state, torques, lasting)
    return pieces, lasting


def _through(
    pieces: list[Piece],
    span: tuple[float, float],
    state: tuple[float, float],
    torques: tuple[float, float, float, float],
    lasting: float,
) -> tuple[float, float]:
    """Adds the pieces between two corners of the voltage; angle and rate at the second one."""
    torque, growth, fall, friction = torques
    now, end = span
    for _ in range(MAX_PIECES):
        drive = torque + growth * (now - span[0])
        way = math.copysign(1.0, state[1]) if state[1] else _way(drive, growth, friction)
        if not way:
            pieces.append(Piece(now, state[0], 0.0, 0.0, 0.0))
            leaves = _leaves(drive, growth, friction)
            if now + leaves >= end:
                return state[0], 0.0
            now += leaves
            way = math.copysign(1.0, torque + growth * (now - span[0]))
            drive = way * friction
        b = growth / fall
        a = (drive - way * friction) / fall - lasting * b
        piece = Piece(now, state[0], a, b, state[1] - a)
        pieces.append(piece)
        stops = _stops(piece, way, end - now, lasting)
        if stops is None:
            return piece.angle_at(end - now, lasting), piece.rate_at(end - now, lasting)
        state = (piece.angle_at(stops, lasting), 0.0)
        now += stops
    return state


def _way(drive: float, growth: float, friction: float) -> float:
    """Which way the shaft sets off from rest: 1, -1, or 0 where friction holds it."""
    if friction == 0.0 and drive == 0.0:
        return math.copysign(1.0, growth) if growth else 0.0
    return math.copysign(1.0, drive) if abs(drive) > friction else 0.0


def _leaves(drive: float, growth: float, friction: float) -> float:
    """Time until the torque exceeds the friction."""
    if not growth:
        return math.inf
    return max(0.0, (math.copysign(friction, growth) - drive) / growth)


def _stops(piece: Piece, way: float, length: float, lasting: float) -> float | None:
    """When the rate becomes 0, ``None`` where it does not."""

    def forward(t: float) -> float:
        return way * piece.rate_at(t, lasting)

    # the rate has one extremum at most, where b = (c/T)·exp(-t/T)
    extremum = None
    if piece.b and piece.c / piece.b > 0:
        instant = lasting * math.log(piece.c / (lasting * piece.b)) if piece.c else 0.0
        extremum = instant if 0 < instant < length else None
    if extremum is not None and way * piece.c > 0 and forward(extremum) < 0:
        return crossing(forward, 0.0, extremum, HALVINGS)
    if forward(length) < 0:
        return crossing(forward, extremum or 0.0, length, HALVINGS)
    return None
