"""Counting of turns, where an engine tells an angle within one turn only.

How often a body has gone round is told from how fast it turned since its angle was last read or
put: the angle that this leads to is wrong by much less than half a turn, so of all angles that look
alike the nearest one is the body's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


def nearest_turn(angle: float, expected: float) -> float:
    """The angle that looks like ``angle`` and is closest to another; nan where one is no number."""
    turns = (expected - angle) / math.tau
    return angle + math.tau * round(turns) if math.isfinite(turns) else math.nan


@dataclass(frozen=True)
class Turned:
    """How far something had turned when it was last looked at.

    Attributes:
        angle: with all turns [rad].
        rate: its stored rate.
        time_s: when that was.
    """

    angle: float
    rate: float
    time_s: float = 0.0

    def later(self, within_a_turn: float, rate: float, time_s: float) -> Turned:
        """The same at another time.

        Args:
            within_a_turn: its angle as the engine has it, less or more any number of turns.
            rate: its rate then.
            time_s: that time.
        """
        expected = self.angle + (self.rate + rate) / 2 * (time_s - self.time_s)
        return Turned(nearest_turn(within_a_turn, expected), rate, time_s)


class Turns:
    """The angles of all bodies over any number of turns."""

    def __init__(self) -> None:
        self._time_s = 0.0
        self._turned: dict[str, Turned] = {}

    def passed(self, time_s: float) -> None:
        """Tells that the engine went on by a time."""
        self._time_s += time_s

    def put(self, body: str, angle: float, rate: float) -> None:
        """Takes note of the angle that a body was put to, turns included."""
        self._turned[body] = Turned(angle, rate, self._time_s)

    def angle(self, body: str, within_a_turn: float, rate: float) -> float:
        """Angle of a body with all its turns; one that was put somewhere before.

        Args:
            body: its name.
            within_a_turn: its angle as the engine has it, less or more any number of turns.
            rate: its rate now.
        """
        turned = self._turned[body] = self._turned[body].later(within_a_turn, rate, self._time_s)
        return turned.angle
