"""What a device of a sensor cannot be, and what it asks of the signal that it reads."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from simcompare.hardware.sensors.device import Device
from simcompare.model.sensor_errors import COLDEST_C, HOTTEST_C, fault_of_jitter, fault_of_low_pass
from simcompare.model.trajectory import Array

#: samples of all devices; more fill the memory of an ordinary machine
MAX_SAMPLES = 5e7
_NEVER_NEGATIVE = (
    "noise_density", "bias_instability", "random_walk", "noise_per_reading", "rate_Hz",
    "jitter_s", "resolution",
)  # fmt: skip


def faults_of(devices: Sequence[Device], signal_rate_Hz: float) -> list[str]:
    """What devices of one kind cannot be, a sentence each.

    Args:
        devices: their numbers.
        signal_rate_Hz: of the signal, for devices without a rate of their own.
    """
    device = devices[0]
    least = {name: np.min([getattr(one, name) for one in devices]) for name in _NEVER_NEGATIVE}
    faults = [
        f"{name} is {value:g}; expected 0 or more" for name, value in least.items() if value < 0
    ]
    if device.poles not in (1, 2, 3, 4):
        faults.append(f"its low-pass has {device.poles} poles; expected 1 to 4")
    if not device.bandwidth_Hz > 0 or not device.full_scale > 0:
        faults.append("bandwidth and range are above 0")
    if math.isinf(device.full_scale) and np.any([one.nonlinearity for one in devices]):
        faults.append("non-linearity is a part of full scale; give full_scale")
    rate = device.rate_Hz or signal_rate_Hz
    if rate / 2 < device.bandwidth_Hz < math.inf:
        whose = "its rate" if device.rate_Hz else "the rate of the signal, as it has none itself"
        faults.append(
            f"bandwidth {device.bandwidth_Hz:g} Hz is above Nyquist's {rate / 2:.4g} Hz, half of"
            f" {whose}; give a bandwidth below it, or a higher rate"
        )
    if not (slowest := min(one.rate_error for one in devices)) > -1:
        faults.append(f"rate_error is {slowest:g}; expected more than -1")
    return faults + _faults_of_limits(device, rate, max(rate, signal_rate_Hz))


def _faults_of_limits(device: Device, rate: float, fastest: float) -> list[str]:
    """What is beyond all sensors, or beyond the digits of a computer."""
    faults = []
    if fault := fault_of_low_pass(device.bandwidth_Hz, device.poles, fastest):
        faults.append(f"bandwidth {fault}")
    if fault := fault_of_jitter(device.jitter_s, rate):
        faults.append(f"jitter {fault}")
    if not COLDEST_C <= device.temperature_C <= HOTTEST_C:
        faults.append(
            f"temperature {device.temperature_C:g} °C; expected {COLDEST_C:g} to {HOTTEST_C:g}"
        )
    return faults


def faults_of_count(devices: Sequence[Device], duration_s: float) -> list[str]:
    """That some devices take too few samples of a signal, or more than a machine can hold."""
    rate = devices[0].rate_Hz
    samples = duration_s * rate
    if rate > 0 and samples < 1:
        return [
            f"it samples {rate:g} times a second and the signal lasts {duration_s:g} s: one sample"
        ]
    if samples * len(devices) > MAX_SAMPLES:
        whose = f" for each of {len(devices)} devices" if len(devices) > 1 else ""
        return [f"{samples:.3g} samples{whose}; expected at most {MAX_SAMPLES:g} in all"]
    return []


def coarser(device: Device, time_s: Array) -> tuple[str, ...]:
    """A note where the signal has fewer samples than the device takes."""
    own = mean_rate(time_s)
    if device.rate_Hz <= own * (1 + 1e-9):
        return ()
    return (
        f"the sensor {device.name} samples {device.rate_Hz:g} times a second and the simulation"
        f" has {own:.4g} values a second; between them straight lines are taken",
    )


def mean_rate(time_s: Array) -> float:
    """Samples in a second [Hz]."""
    return float((len(time_s) - 1) / (time_s[-1] - time_s[0]))
