"""The force-clipped spring and damper as an engine with one fixed step computes it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.engine.calibration.drops import Bounces
from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class SteppedDashpot:
    """Drops on a spring and damper in semi-implicit Euler steps, computed without any engine.

    As in MuJoCo, spring and damper prescribe the acceleration of what touches, its weight included,
    from position and velocity before the step, and the contact cannot pull. How restitution and
    scatter depend on √k·dt follows from that; it is where a search in an engine starts.

    Attributes:
        step_s: time step [s].
        gravity_m_s2: acceleration towards the floor [m/s²].
    """

    step_s: float
    gravity_m_s2: float

    def __call__(self, numbers: tuple[float, ...], speed_m_s: float, phases: Array) -> Bounces:
        """Bounces for ``numbers`` (-k, -b): stiffness [1/s²] and damping [1/s] per unit of mass."""
        (minus_k, minus_b), dt, g = numbers, self.step_s, self.gravity_m_s2
        # a step's displacement is its velocity, which belongs to the middle of the step
        z = np.asarray(phases, dtype=float) * min(speed_m_s * dt, speed_m_s**2 / 2 / g)
        w = g * dt / 2 - np.sqrt(speed_m_s**2 - 2 * g * z)
        down_s = (speed_m_s - np.sqrt(speed_m_s**2 - 2 * g * z)) / g
        depth, forced = np.zeros_like(z), np.zeros_like(z)
        up = np.full((3, len(z)), np.nan)
        waiting = np.ones(len(z), dtype=bool)
        risen = ~waiting
        # a contact lasts π/ω or less, longer only where its weight keeps it down
        for count in range(1, 100 + int(20 / (math.sqrt(-minus_k) * dt))):
            pushed = np.where(z < 0, minus_b * w + minus_k * z, -g)
            a = np.maximum(pushed, -g)
            forced += waiting & (a > -g)
            w = w + dt * a
            z = z + dt * w
            depth = np.where(waiting, np.maximum(depth, -z), depth)
            left = waiting & (z > 0) & (w > 0)
            if left.any():
                speed = w[left] - g * dt / 2
                up[:, left] = z[left], speed, np.full(len(speed), count * dt)
            # what sinks again before it has left stays down
            waiting &= ~left & ~(risen & (w <= 0))
            risen |= w > 0
            if not waiting.any():
                break
        apex = np.maximum(up[0] + up[1] ** 2 / (2 * g), 0.0)
        up_s = up[2] + (up[1] - np.sqrt(2 * g * apex)) / g
        return Bounces(
            restitution=np.sqrt(2 * g * apex) / speed_m_s,
            penetration_m=depth,
            contact_s=np.where(np.isfinite(up[0]), forced * dt, np.nan),
            delay_s=up_s - down_s,
        )
