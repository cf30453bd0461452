"""Free fall of a base with a mass in it: z = u·t - g·t²/2, and no force between the two."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.scenarios.body_signals import unturned


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion of the base, and the force on the mass, which is none.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].

    Returns:
        The four signals of ``base``, and ``cell.force_N`` (n, 3).
    """
    g, up = parameters["gravity_m_s2"], parameters["speed_up_m_s"]
    still, forward = np.zeros_like(time_s), parameters["speed_forward_m_s"]
    height = up * time_s - g * time_s**2 / 2
    position = np.column_stack((forward * time_s, still, height))
    velocity = np.column_stack((still + forward, still, up - g * time_s))
    return {
        **unturned("base", position, velocity),
        "cell.force_N": np.zeros((len(time_s), 3)),
    }
