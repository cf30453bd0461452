"""One device of a sensor: the numbers of its error model, once they are known or drawn.

With the true signal X in the sensor's own axes, after mounting and bandwidth,

    Y = (1 + s·(T - 25))·S·X + O + o·(T - 25) + L·A·(4u³ - 3u) + N,   u = X/L

where S is the sensitivity with its cross-axis terms (the identity of a perfect sensor), O the
offset, s and o their changes with temperature, A the non-linearity as a part of the full scale L,
and N noise. Y is in the unit of X. What follows is sampled, quantised and cut off at the range.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.model.trajectory import Array

#: temperature at which data sheets state their values [°C]
REFERENCE_C = 25.0


@dataclass(frozen=True, eq=False)
class Device:
    """Numbers of one device; 1 or 3 axes, all in the unit of the signal.

    Attributes:
        name: of the device or of its data sheet, for tables and notes.
        sensitivity: S (k, k); k is 1 or 3.
        offset: O (k,).
        nonlinearity: A (k,), largest deviation from the best straight line, part of full scale.
        full_scale: L, infinite where readings are never cut off.
        noise_density: white noise (k,), one-sided [unit/√Hz]; N of an Allan plot is 1/√2 of it.
        bias_instability: B (k,), flicker noise; the floor of the Allan deviation is 0.664·B [unit].
        random_walk: K (k,), [unit/√s].
        noise_per_reading: white noise that grows with the reading (k,), part of it (ranges).
        sensitivity_per_K: s (k,) [1/K].
        offset_per_K: o (k,) [unit/K].
        temperature_C: of the device.
        mounting_wxyz: how the sensor's axes are turned in its box; box from sensor.
        bandwidth_Hz: -3 dB; infinite where nothing is smoothed.
        poles: of a Butterworth low-pass of that bandwidth, 1 to 4.
        rate_Hz: samples in a second; 0: at every sample of the signal.
        rate_error: by how much its clock is fast, part of the rate.
        jitter_s: standard deviation of the time of one sample [s].
        latency_s: by which a sample is older than its time stamp [s].
        resolution: of one count (LSB); 0: not quantised.
    """

    name: str
    sensitivity: Array
    offset: Array
    nonlinearity: Array
    full_scale: float
    noise_density: Array
    bias_instability: Array
    random_walk: Array
    noise_per_reading: Array
    sensitivity_per_K: Array
    offset_per_K: Array
    temperature_C: float = REFERENCE_C
    mounting_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    bandwidth_Hz: float = np.inf
    poles: int = 1
    rate_Hz: float = 0.0
    rate_error: float = 0.0
    jitter_s: float = 0.0
    latency_s: float = 0.0
    resolution: float = 0.0

    @property
    def axes(self) -> int:
        """Number of axes, 1 or 3."""
        return len(self.offset)


def perfect(name: str, axes: int) -> Device:
    """A device without any error; ``dataclasses.replace`` gives it some."""
    none = np.zeros(axes)
    return Device(name, np.eye(axes), none, none, np.inf, none, none, none, none, none, none)
