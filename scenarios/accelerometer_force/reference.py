"""Exact motion of a base with a mass welded to it, and the force that holds the mass.

The two move as one: a = F/(M + m). The base exerts m·(a - g) on the mass: m·F/(M + m) forward and
m·g up (Newton's second law; the specific force times the mass).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.model.signals import SineSteps, Step
from simcompare.model.trajectory import Array
from simcompare.scenarios.accelerometer.reference import FREE
from simcompare.scenarios.instants import grid

#: what the scenario shakes with [Hz], how long each [s], and when it is pushed after that [s]
FREQUENCIES_HZ, DWELL_S, PUSH_S = (10.0, 20.0, 50.0), 0.1, 0.3


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the base and force on the mass.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        Position and velocity of the joint ``slide`` (n,), and ``cell.force_N`` (n, 3).
    """
    amplitude = parameters["acceleration_m_s2"]
    shaking = SineSteps(
        signal="sine_steps", amplitude=amplitude, frequencies_Hz=FREQUENCIES_HZ, dwell_s=DWELL_S
    )
    push = Step(signal="step", after=amplitude, time_s=PUSH_S)

    def acceleration(at_s: Array) -> Array:
        return np.asarray(shaking.at(at_s) + push.at(at_s))

    changes = DWELL_S * np.arange(1.0, len(FREQUENCIES_HZ) + 1)
    times, kept = grid(time_s, changes, 1 / (2 * np.pi * max(FREQUENCIES_HZ)), 0.0)
    position, velocity = (part[kept] for part in FREE.driven(times, acceleration))
    felt = np.zeros((len(time_s), 3))
    felt[:, 0], felt[:, 2] = acceleration(time_s), parameters["gravity_m_s2"]
    return {
        "slide.position_m": position,
        "slide.velocity_m_s": velocity,
        "cell.force_N": parameters["seismic_mass_kg"] * felt,
    }
