"""State of a simulation, as plain values that bring it back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class BodyState:
    """Motion of one body: position [m], orientation wxyz, velocity [m/s], rate [rad/s]; world."""

    position_m: tuple[float, ...]
    orientation_wxyz: tuple[float, ...]
    velocity_m_s: tuple[float, ...]
    rate_rad_s: tuple[float, ...]


@dataclass(frozen=True)
class State:
    """State of a simulation after a whole number of recorded steps.

    Attributes:
        time_s: time since the scenario's start [s].
        bodies: motion of every moving body.
        velocity_step_s: engine step to which the stored velocities belong [s]; see ``landing``.
        joints: coordinate and rate of every movable joint [rad, rad/s or m, m/s].
        rates_before: stored rates of the driven joints one engine step earlier; see ``drives``.
    """

    time_s: float
    bodies: Mapping[str, BodyState]
    velocity_step_s: float = field(default=0.0)
    joints: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    rates_before: tuple[float, ...] | None = None
