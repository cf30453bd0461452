"""What the robot's controller says and is told, without ROS: lines of text, odometry, safety.

Every line ends with ``*`` and the exclusive or of its bytes as two hexadecimal digits. The
controller sends, some hundred times a second::

    S <time µs> <left marks> <right marks> <ax> <ay> <az> <gx> <gy> <gz>*XX

marks as counters that never turn back, acceleration and rates as the MPU-6050's raw counts. It is
told the parts of the battery's voltage at the motors, in thousandths::

    M <left> <right>*XX
"""

from __future__ import annotations

import functools
import math
import operator
from dataclasses import dataclass

#: counts of the MPU-6050 at its narrowest ranges: of one g, and of one degree a second
COUNTS_PER_G, COUNTS_PER_DEG_S = 16384.0, 131.0
STANDARD_GRAVITY_M_S2 = 9.80665
#: what a motor can be told at most
FULL = 1000
#: numbers in a line of readings
_NUMBERS = 9


@dataclass(frozen=True)
class Robot:
    """What the driver must know of the robot, SI.

    Attributes:
        radius_m: of the wheels. track_m: between their middles. marks: in one turn of a wheel.
        volts_per_rad_s: that a motor needs for each rad/s of its wheel. start_V: that it needs
        to begin. battery_V: at the driver's bridges. gain: part of a wheel's missing speed that is
        added. timeout_s: after which the robot stops when nobody tells it anything.
    """

    radius_m: float
    track_m: float
    marks: float
    volts_per_rad_s: float
    start_V: float
    battery_V: float
    gain: float = 0.5
    timeout_s: float = 0.5


@dataclass(frozen=True)
class Reading:
    """One line of the controller: time [s], marks, specific force [m/s²], rates [rad/s]."""

    time_s: float
    marks: tuple[int, int]
    force_m_s2: tuple[float, float, float]
    rate_rad_s: tuple[float, float, float]


@dataclass(frozen=True)
class Pose:
    """Where the robot is and how it moves: position [m], heading [rad], speed, turning rate."""

    x_m: float = 0.0
    y_m: float = 0.0
    heading_rad: float = 0.0
    speed_m_s: float = 0.0
    rate_rad_s: float = 0.0


def with_checksum(text: str) -> str:
    """The text with its checksum, as one line."""
    return f"{text}*{_checksum(text):02X}\n"


def reading_of(line: str) -> Reading | None:
    """What a line says; ``None`` where it is no whole line of readings."""
    text, star, told = line.strip().rpartition("*")
    try:
        if not star or int(told, 16) != _checksum(text):
            return None
        kind, *numbers = text.split()
        values = [int(number) for number in numbers]
    except ValueError:
        return None
    if kind != "S" or len(values) != _NUMBERS:
        return None
    time_us, left, right, *counts = values
    force = [STANDARD_GRAVITY_M_S2 * count / COUNTS_PER_G for count in counts[:3]]
    rate = [math.radians(count / COUNTS_PER_DEG_S) for count in counts[3:]]
    return Reading(
        time_us * 1e-6,
        (left, right),
        (force[0], force[1], force[2]),
        (rate[0], rate[1], rate[2]),
    )


class Core:
    """The driver's memory: where the robot is, and what its wheels are to do.

    A light barrier does not tell which way a wheel turns: it is taken to turn as it was told.

    Args:
        robot: what is known of it.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.pose = Pose()
        self.angles_rad = [0.0, 0.0]
        self.rates_rad_s = [0.0, 0.0]
        self._last: Reading | None = None
        self._wanted_rad_s = [0.0, 0.0]
        self._signs = [1, 1]
        self._told_s = -math.inf

    def drive(self, speed_m_s: float, rate_rad_s: float, now_s: float) -> None:
        """Takes what the robot is to do; numbers that are none stop it."""
        if not (math.isfinite(speed_m_s) and math.isfinite(rate_rad_s)):
            speed_m_s = rate_rad_s = 0.0
        half = rate_rad_s * self.robot.track_m / 2
        wanted = [
            (speed_m_s - half) / self.robot.radius_m,
            (speed_m_s + half) / self.robot.radius_m,
        ]
        self._wanted_rad_s, self._told_s = wanted, now_s
        self._signs = [
            int(math.copysign(1, rate)) if rate else sign
            for rate, sign in zip(wanted, self._signs, strict=True)
        ]

    def command(self, now_s: float) -> str:
        """The line for the controller: what each motor gets, or nothing after the timeout."""
        if now_s - self._told_s > self.robot.timeout_s:
            self._wanted_rad_s = [0.0, 0.0]
        left, right = map(self._part, self._wanted_rad_s, self.rates_rad_s)
        return with_checksum(f"M {left} {right}")

    def _part(self, wanted_rad_s: float, is_rad_s: float) -> int:
        """Part of the battery's voltage, in thousandths."""
        if not wanted_rad_s:
            return 0
        robot = self.robot
        rate = wanted_rad_s + robot.gain * (wanted_rad_s - is_rad_s)
        volts = robot.volts_per_rad_s * rate + math.copysign(robot.start_V, wanted_rad_s)
        return max(-FULL, min(FULL, round(FULL * volts / robot.battery_V)))

    def update(self, reading: Reading) -> bool:
        """Takes a reading; whether pose and rates are new.

        The robot is taken to have driven an arc: by the mean of both wheels' ways, in the direction
        that it had halfway.
        """
        last, self._last = self._last, reading
        if last is None or reading.time_s <= last.time_s:
            return False
        span_s = reading.time_s - last.time_s
        turns = [
            sign * (now - then) / self.robot.marks * 2 * math.pi
            for sign, now, then in zip(self._signs, reading.marks, last.marks, strict=True)
        ]
        if any(now < then for now, then in zip(reading.marks, last.marks, strict=True)):
            return False  # the controller has begun anew
        self.angles_rad = [a + turn for a, turn in zip(self.angles_rad, turns, strict=True)]
        self.rates_rad_s = [turn / span_s for turn in turns]
        left, right = (self.robot.radius_m * turn for turn in turns)
        way, turn = (left + right) / 2, (right - left) / self.robot.track_m
        middle = self.pose.heading_rad + turn / 2
        self.pose = Pose(
            self.pose.x_m + way * math.cos(middle),
            self.pose.y_m + way * math.sin(middle),
            math.remainder(self.pose.heading_rad + turn, 2 * math.pi),
            way / span_s,
            turn / span_s,
        )
        return True


def _checksum(text: str) -> int:
    return functools.reduce(operator.xor, text.encode(), 0)
