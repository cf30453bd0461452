"""Devices drawn from a data sheet: each systematic term once for a device, by its own stream."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from simcompare.hardware.sensors.device import Device, perfect
from simcompare.hardware.sensors.sheet_parts import PartData, Settings
from simcompare.model.trajectory import Array
from simcompare.statistics.streams import stream


@dataclass(frozen=True, eq=False)
class Devices:
    """Many devices of one part; n devices of k axes, in the units of ``Device``.

    Attributes:
        like: what all of them share, as a device without systematic errors.
        sensitivity: (n, k, k).
        offset: (n, k).
        nonlinearity: (n, k), part of full scale.
        sensitivity_per_K: (n, k) [1/K].
        offset_per_K: (n, k) [unit/K].
        rate_error: (n,), part of the rate.
    """

    like: Device
    sensitivity: Array
    offset: Array
    nonlinearity: Array
    sensitivity_per_K: Array
    offset_per_K: Array
    rate_error: Array

    def __len__(self) -> int:
        return len(self.offset)

    def __iter__(self) -> Iterator[Device]:
        return map(self.device, range(len(self)))

    def device(self, number: int) -> Device:
        """One of them."""
        return replace(
            self.like,
            sensitivity=self.sensitivity[number],
            offset=self.offset[number],
            nonlinearity=self.nonlinearity[number],
            sensitivity_per_K=self.sensitivity_per_K[number],
            offset_per_K=self.offset_per_K[number],
            rate_error=float(self.rate_error[number]),
        )


def typical(part: PartData, settings: Settings, device_name: str = "") -> Device:
    """A device without systematic errors: noise, resolution and range as in the sheet."""
    return replace(
        perfect(device_name or part.sheet, len(part.axes)),
        full_scale=settings.range.full_scale,
        noise_density=_per_axis(part, settings, "noise"),
        bias_instability=_per_axis(part, settings, "bias_instability"),
        random_walk=_per_axis(part, settings, "random_walk"),
        noise_per_reading=_per_axis(part, settings, "noise_per_reading"),
        temperature_C=settings.temperature_C,
        bandwidth_Hz=settings.bandwidth_Hz,
        poles=settings.poles,
        rate_Hz=settings.rate_Hz,
        resolution=settings.range.count,
    )


def many(
    part: PartData, settings: Settings, seed: int, count: int, device_name: str = ""
) -> Devices:
    """That many devices; what one term of one axis draws depends on no other."""
    axes = part.axes

    def drawn(term: str, axis: str, *names: str) -> Array:
        entry = part.entry(term, settings.range.name, axis)
        if entry is None:
            return np.zeros(count)
        names = (part.sheet, device_name, part.name, term, axis, *names)
        return entry.distribution.draw(stream(seed, *names), count)

    def per_axis(term: str) -> Array:
        return np.stack([drawn(term, axis) for axis in axes], axis=-1)

    rows = [
        np.stack(
            [
                1 + drawn("sensitivity", to) if to == source else drawn("cross_axis", to, source)
                for source in axes
            ],
            axis=-1,
        )
        for to in axes
    ]
    sensitivity = np.stack(rows, axis=1)
    # where a sensitivity is right at a reading, the line turns about that reading
    entries = [part.entry("sensitivity", settings.range.name, axis) for axis in axes]
    about = np.array([0.0 if one is None else one.about for one in entries])
    turned = about * (np.diagonal(sensitivity, axis1=1, axis2=2) - 1)
    return Devices(
        like=typical(part, settings, device_name),
        sensitivity=sensitivity,
        offset=per_axis("offset") - turned,
        nonlinearity=per_axis("nonlinearity"),
        sensitivity_per_K=per_axis("sensitivity_per_K"),
        offset_per_K=per_axis("offset_per_K"),
        rate_error=drawn("rate", axes[0]),
    )


def density(part: PartData, settings: Settings, axis: str) -> float:
    """Noise density of an axis; an rms is spread over the bandwidth at which it was stated."""
    entry = part.entry("noise", settings.range.name, axis)
    if entry is None:
        return 0.0
    if entry.kind == "density":
        return entry.stated.typ
    if math.isnan(entry.bandwidth_Hz):  # of one reading, whatever the rate
        return entry.stated.typ / math.sqrt(settings.noise_bandwidth)
    return entry.stated.typ / math.sqrt(part.noise_bandwidth(entry.bandwidth_Hz))


def _per_axis(part: PartData, settings: Settings, term: str) -> Array:
    if term == "noise":
        return np.array([density(part, settings, axis) for axis in part.axes])
    entries = [part.entry(term, settings.range.name, axis) for axis in part.axes]
    return np.array([0.0 if one is None else one.stated.typ for one in entries])
