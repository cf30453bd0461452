"""What a drawn sensor reads of a trajectory, beside the ideal signal."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from simcompare.hardware.sensors.drawn import DrawnSensor
from simcompare.hardware.sensors.error_model import Reading, measured
from simcompare.hardware.sensors.signals import part_of, values_of
from simcompare.model.trajectory import Array
from simcompare.statistics.streams import stream

#: signals that keep their value until their next sample
_HELD = ("marks",)


def read(
    sensor: DrawnSensor, time_s: Array, signals: Mapping[str, Array], seed: int
) -> Reading | None:
    """The reading of one signal; ``None`` where a source does not give the signal.

    The noise is the same for every source: what differs between two engines is the engines'.

    Args:
        sensor: the device.
        time_s: times of the signals (n,) [s].
        signals: name -> values.
        seed: of all streams.

    Raises:
        InputError: what the device cannot be.
    """
    values = values_of(signals, sensor.signal)
    if values is None:
        return None
    known = np.isfinite(values).reshape(len(values), -1).all(axis=1)
    held = part_of(sensor.signal) in _HELD
    generator = stream(seed, sensor.signal, "noise")
    return measured(sensor.device, time_s[known], values[known], generator, held=held)
