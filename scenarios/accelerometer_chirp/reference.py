"""Exact motion of the shaken base and its seismic mass under a sweep of frequencies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.model.signals import Chirp
from simcompare.model.trajectory import Array
from simcompare.scenarios.accelerometer.reference import force_amplitude, motion

#: where the sweep starts and ends, over the natural frequency, as the scenario has it
START, END = 0.025, 4.0


def reference(parameters: Mapping[str, float], time_s: Array) -> dict[str, Array]:
    """Motion under the sweep; for the rest see the scenario that this one is a variant of.

    Args:
        parameters: those of the scenario, SI.
        time_s: times from the start on (n,) [s].
    """
    natural_Hz = parameters["natural_frequency_Hz"]
    sweep = Chirp(
        signal="chirp",
        amplitude=force_amplitude(parameters),
        start_Hz=START * natural_Hz,
        end_Hz=END * natural_Hz,
        duration_s=parameters["sweep_periods"] / natural_Hz,
    )
    return motion(parameters, time_s, sweep.at, np.empty(0), END * natural_Hz)
