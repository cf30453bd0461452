"""What a sensor reads that is not ideal: the error model, for one device or for many at once.

In this order, as the signal goes through a sensor: the sensor is turned in its box, its low-pass
smooths, sensitivity, offset, non-linearity and temperature act (see ``device``), noise is added,
the converter samples at the device's own clock, rounds to whole counts (half to even), and cuts off
at the ends of its range.

Time stamps are those of an exact clock. A sample that is stamped T was taken at T minus the
latency, plus the jitter; a device whose clock is fast gives more samples in a second.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.hardware.sensors import noise
from simcompare.hardware.sensors.device import REFERENCE_C, Device
from simcompare.hardware.sensors.device_checks import coarser, faults_of, faults_of_count, mean_rate
from simcompare.hardware.sensors.low_pass import smoothed
from simcompare.model.rotations import conjugate, rotate
from simcompare.model.trajectory import Array

Flags = NDArray[np.bool_]
#: devices that are worked on at once, so that memory stays small
_AT_ONCE = 250


@dataclass(frozen=True, eq=False)
class Reading:
    """What one device read, beside the ideal signal at the same times.

    Attributes:
        time_s: time stamps (m,) [s].
        ideal: the signal that went in, without any error (m,) or (m, k).
        measured: what the device gave, in the same unit.
        saturated: where it was cut off at the end of its range.
        notes: what the reader should know.
    """

    time_s: Array
    ideal: Array
    measured: Array
    saturated: Flags
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Readings:
    """What many devices read of one signal.

    Attributes:
        time_s: time stamps (d, m) [s]; as many for each as the slowest clock gives.
        measured: (d, m, k).
        saturated: (d, m, k).
    """

    time_s: Array
    measured: Array
    saturated: Flags


def measured(
    device: Device, time_s: Array, ideal: Array, generator: np.random.Generator,
    *, held: bool = False,
) -> Reading:  # fmt: skip
    """What a device reads of a signal.

    Args:
        device: its numbers.
        time_s: times of the signal (n,), increasing [s].
        ideal: the signal (n,) or (n, k), k the number of axes of the device.
        generator: of the noise; the same state gives the same noise.
        held: whether the signal keeps its value until its next sample, as a counter does.

    Raises:
        InputError: what the device cannot be, or what does not fit the signal.
    """
    flat = ideal.ndim == 1
    found = measured_by([device], time_s, ideal, generator, held=held)
    stamps = found.time_s[0]
    there = _at(time_s, _columns(ideal), stamps[None], held=held)[0].T
    read, cut = found.measured[0], found.saturated[0]
    if flat:
        there, read, cut = there[:, 0], read[:, 0], cut[:, 0]
    return Reading(stamps, there, read, cut, coarser(device, time_s))


def measured_by(
    devices: Sequence[Device], time_s: Array, ideal: Array, generator: np.random.Generator,
    *, held: bool = False,
) -> Readings:  # fmt: skip
    """What many devices of one kind read of one signal, as draws of one data sheet.

    Args:
        devices: alike in rate, bandwidth, poles, resolution and range; all else may differ.
        time_s: times of the signal (n,), increasing [s].
        ideal: the signal (n,) or (n, k).
        generator: of the noise of all.
        held: whether the signal keeps its value until its next sample.

    Raises:
        InputError: what a device cannot be, or devices of more than one kind.
    """
    one = _checked(devices, time_s, ideal)
    values = _columns(ideal)
    stamps = _stamps(devices, one, time_s)
    smooth = _smooth(one, time_s, values)
    read = np.empty((len(devices), stamps.shape[1], values.shape[1]))
    cut = np.zeros(read.shape, dtype=bool)
    for first in range(0, len(devices), _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        block = _block(devices[some], stamps[some], time_s, smooth, generator, held)
        read[some], cut[some] = (part.transpose(0, 2, 1) for part in block)
    return Readings(stamps, read, cut)


def _checked(devices: Sequence[Device], time_s: Array, ideal: Array) -> Device:
    """The first device; all faults of all of them are told at once."""
    if not devices:
        raise InputError("sensor", ["no device is given; expected one or more"])
    one = devices[0]
    axes = 1 if ideal.ndim == 1 else ideal.shape[1]
    faults = []
    if len(time_s) < 2 or len(time_s) != len(ideal):
        faults.append(f"{len(time_s)} times and {len(ideal)} values; expected as many, 2 or more")
    if len(time_s) > 1:
        faults += faults_of_count(devices, float(time_s[-1] - time_s[0]))
    if one.axes != axes:
        faults.append(f"it has {one.axes} axes and the signal has {axes}")
    if len(set(map(_kind, devices))) > 1:
        faults.append("devices differ in axes, rate, bandwidth, poles, resolution or range")
    else:
        faults += faults_of(devices, mean_rate(time_s) if len(time_s) > 1 else math.inf)
    if faults:
        raise InputError(f"sensor {one.name}", faults)
    return one


def _kind(device: Device) -> tuple[float, ...]:
    return (
        device.axes, device.rate_Hz, device.bandwidth_Hz, device.poles, device.resolution,
        device.full_scale,
    )  # fmt: skip


def _columns(ideal: Array) -> Array:
    return ideal[:, None] if ideal.ndim == 1 else ideal


def _stamps(devices: Sequence[Device], one: Device, time_s: Array) -> Array:
    """Time stamps of each device (d, m) [s]."""
    if not one.rate_Hz:
        return np.broadcast_to(time_s, (len(devices), len(time_s)))
    rates = one.rate_Hz * (1 + np.array([device.rate_error for device in devices]))
    count = 1 + math.floor((time_s[-1] - time_s[0]) * rates.min() * (1 + 1e-12) + 1e-9)
    if np.all(rates == rates[0]):
        return np.broadcast_to(time_s[0] + np.arange(count) / rates[0], (len(devices), count))
    return np.asarray(time_s[0] + np.arange(count) / rates[:, None], dtype=float)


def _smooth(one: Device, time_s: Array, values: Array) -> Array:
    """The signal after the low-pass, at its own times."""
    if math.isinf(one.bandwidth_Hz):
        return values
    even = np.linspace(time_s[0], time_s[-1], len(time_s))
    step_s = float(even[1] - even[0])
    if np.allclose(even, time_s, rtol=0, atol=1e-6 * step_s):
        return smoothed(values, step_s, one.bandwidth_Hz, one.poles)
    # uneven: onto its shortest interval and back, but not onto ever more samples
    count = min(10 * len(time_s), 1 + math.ceil((time_s[-1] - time_s[0]) / np.diff(time_s).min()))
    even = np.linspace(time_s[0], time_s[-1], count)
    fine = _at(time_s, values, even[None], held=False)[0].T
    fine = smoothed(fine, float(even[1] - even[0]), one.bandwidth_Hz, one.poles)
    return np.asarray(_at(even, fine, time_s[None], held=False)[0].T, dtype=float)


def _at(time_s: Array, values: Array, at_s: Array, *, held: bool) -> Array:
    """A signal (n, k) at the times of each device (d, m), as (d, k, m)."""
    if held:
        place = np.searchsorted(time_s, at_s + 1e-12 * abs(time_s[-1]), side="right") - 1
        return np.asarray(np.moveaxis(values[np.clip(place, 0, None)], -1, 1), dtype=float)
    columns = [np.interp(at_s, time_s, column) for column in values.T]
    return np.stack(columns, axis=1)


def _block(
    devices: Sequence[Device], stamps: Array, time_s: Array, smooth: Array,
    generator: np.random.Generator, held: bool,
) -> tuple[Array, Flags]:  # fmt: skip
    """Readings and saturation of some devices (d, k, m)."""
    one = devices[0]
    felt = _felt(devices, stamps, time_s, smooth, generator, held)
    read = _systematic(devices, felt)
    read += _noise(devices, stamps, felt, generator)
    if one.resolution:
        read = np.rint(read / one.resolution) * one.resolution
    if math.isinf(one.full_scale):
        return read, np.zeros(read.shape, dtype=bool)
    cut = np.abs(read) >= one.full_scale
    return np.clip(read, -one.full_scale, one.full_scale), cut


def _felt(
    devices: Sequence[Device], stamps: Array, time_s: Array, smooth: Array,
    generator: np.random.Generator, held: bool,
) -> Array:  # fmt: skip
    """The signal in the axes of each sensor, when it was taken (d, k, m)."""
    taken = stamps - np.array([device.latency_s for device in devices])[:, None]
    jitter = np.array([device.jitter_s for device in devices])
    if jitter.any():
        taken = taken + jitter[:, None] * generator.standard_normal(taken.shape)
    if (taken[1:] == taken[:1]).all():  # all at the same times
        once = _at(time_s, smooth, taken[:1], held=held)
        felt = np.broadcast_to(once, (len(devices), *once.shape[1:]))
    else:
        felt = _at(time_s, smooth, taken, held=held)
    turned = np.array([device.mounting_wxyz for device in devices])
    if felt.shape[1] == 1 or not turned[:, 1:].any():
        return felt
    into = [rotate(np.tile(q, (3, 1)), np.eye(3)) for q in conjugate(turned)[:, None]]
    # rows of each are the turned axes: the matrix transposed
    return np.asarray(np.transpose(into, (0, 2, 1)) @ felt, dtype=float)


def _systematic(devices: Sequence[Device], felt: Array) -> Array:
    """Sensitivity, offset, temperature and non-linearity."""
    heat = np.array([device.temperature_C - REFERENCE_C for device in devices])[:, None]
    read = np.array([device.sensitivity for device in devices]) @ felt
    read *= (1 + heat * _stacked(devices, "sensitivity_per_K"))[..., None]
    read += (_stacked(devices, "offset") + heat * _stacked(devices, "offset_per_K"))[..., None]
    bent = _stacked(devices, "nonlinearity")
    if bent.any():
        scale = devices[0].full_scale
        u = np.clip(felt / scale, -1.0, 1.0)
        read += (scale * bent)[..., None] * ((4 * u * u - 3) * u)
    return np.asarray(read, dtype=float)


def _stacked(devices: Sequence[Device], name: str) -> Array:
    """One term of all devices (d, k)."""
    return np.array([getattr(device, name) for device in devices], dtype=float)


def _noise(
    devices: Sequence[Device], stamps: Array, felt: Array, generator: np.random.Generator
) -> Array:
    count = stamps.shape[1]
    step_s = (stamps[:, -1] - stamps[:, 0]) / max(count - 1, 1)
    one = devices[0]
    total = noise.white(
        _stacked(devices, "noise_density"), step_s, count, generator, one.bandwidth_Hz, one.poles
    )
    total += noise.flicker(_stacked(devices, "bias_instability"), count, generator)
    total += noise.random_walk(_stacked(devices, "random_walk"), step_s, count, generator)
    growing = _stacked(devices, "noise_per_reading")
    if growing.any():
        total += growing[..., None] * np.abs(felt) * generator.standard_normal(felt.shape)
    return total
