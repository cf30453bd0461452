"""A real range sensor of many zones: what comes back of its light, and what it makes of that.

Each zone is looked at along several rays. A matt surface of reflectance ρ at the distance R, met at
the angle θ, sends back ρ·cos θ/R². Rays that end close to each other along the axis are one target,
whose distance is their mean, weighted by what comes back. A target is found where it stands out of
the dark and of the background. Its distance is off by what stays with the device, and scatters; it
is rounded to whole counts. The numbers are those of ``zone_numbers``.

What is left out: light that strays into other zones (the sharpener), reflections from one thing to
another, mirrors, motion within a frame, and what a shaded sensor does below 2 cm.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from numbers import Real
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from simcompare.engine.range_sensing import zone_rays
from simcompare.errors import InputError
from simcompare.hardware.sensors import zone_numbers
from simcompare.hardware.sensors.zone_numbers import ZoneNumbers
from simcompare.model.sensor_errors import COLDEST_C, HOTTEST_C
from simcompare.model.trajectory import Array
from simcompare.statistics.streams import stream

#: what the chip says of a zone: UM2884, revision 2, Table 4
VALID, FIRST, LARGE_PULSE, NEW, NOTHING = 5, 6, 9, 10, 255
#: those of which half or more can be trusted, by its section 5.5
TRUSTED = (VALID, FIRST, LARGE_PULSE)
#: least and most of a setting that is a number. The sun at noon gives 100 klux; a cover glass as
#: bright as a white target 1 cm away gives 10,000; far more scatter than any is no reading
_LIMITS: Mapping[str, tuple[float, float]] = {
    "ambient_klux": (0.0, 1000.0), "temperature_C": (COLDEST_C, HOTTEST_C),
    "crosstalk": (0.0, 1e6), "scatter": (0.0, 1000.0),
}  # fmt: skip
#: settings of a device, and what each may be
SETTINGS: Mapping[str, str] = {
    "rate_Hz": "a number above 0",
    **{name: f"a number from {low:g} to {high:g}" for name, (low, high) in _LIMITS.items()},
    "order": "strongest or closest",
}
Codes = NDArray[np.int_]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class View:
    """What the rays of a sensor meet: n frames, z zones, k rays in each.

    Attributes:
        distance_m: along the axis (n, z, k); ``inf`` where a ray meets nothing.
        cosine: of the angle between ray and surface (n, z, k).
        reflectance: of what is met (n, z, k).
    """

    distance_m: Array
    cosine: Array
    reflectance: Array


@dataclass(frozen=True, eq=False)
class Frames:
    """What a sensor tells.

    Attributes:
        range_m: along the axis (n, z), in whole counts; NaN where there is no target.
        status: the chip's own code (n, z).
        targets: targets that were found (n, z).
        sigma_m: standard deviation of the scatter (n, z); NaN where there is no target.
    """

    range_m: Array
    status: Codes
    targets: Codes
    sigma_m: Array

    @property
    def valid(self) -> Flags:
        """Where half or more can be trusted (n, z)."""
        return np.asarray(np.logical_or.reduce([self.status == code for code in TRUSTED]))


@dataclass(frozen=True, eq=False)
class Multizone:
    """One device.

    Attributes:
        numbers: of its kind.
        zones: in a row.
        geometry: how its angle of view is divided.
        stays: what stays with it in each zone (z,), in its standard deviations.
        rate_Hz: frames in a second.
        ambient_klux: light on the scene.
        temperature_C: of the device.
        crosstalk: what a cover glass sends back, as a signal [1/m²]; it draws near targets to 0.
        order: which of several targets in a zone is told.
        scatter: factor on all scatter; 0 for none.
    """

    numbers: ZoneNumbers
    zones: Literal[4, 8]
    geometry: str
    stays: Array
    rate_Hz: float
    ambient_klux: float = 0.0
    temperature_C: float = 23.0
    crosstalk: float = 0.0
    order: Literal["strongest", "closest"] = "strongest"
    scatter: float = 1.0

    @property
    def latency_s(self) -> float:
        """Age of a frame when it is told: it is collected during the whole period before."""
        return 0.5 / self.rate_Hz

    @property
    def u_mean(self) -> float:
        """Standard deviation over devices of the mean of ``stays``."""
        return math.sqrt(self.numbers.shared + (1 - self.numbers.shared) / self.zones**2)

    def rays(self, in_a_row: int = 5) -> Array:
        """Rays (z, in_a_row², 3) in the sensor's frame, until x = 1 m."""
        return zone_rays(self.zones, self.geometry, in_a_row)

    def read(
        self, view: View, generator: np.random.Generator, found_before: Flags | None = None
    ) -> Frames:
        """What it tells of frames that follow one another.

        Args:
            view: of the rays that ``rays`` gives.
            generator: of the scatter; the same state gives the same frames.
            found_before: which zones (z,) had a target in the frame before; ``None``: there was no
                frame before.
        """
        from scipy import special

        numbers, (distance, signal, spread, light) = self.numbers, self._targets(view)
        least = np.hypot(numbers.least_signal, numbers.background * np.sqrt(light))
        beyond = numbers.background_sigmas * (signal / least - 1)
        chance = special.ndtr(beyond + special.ndtri(numbers.detection_rate))
        near_enough = (signal > 0) & (distance <= numbers.reach_m)
        found = near_enough & (generator.random(chance.shape) < chance)
        rank = np.where(found, signal if self.order == "strongest" else -distance, -np.inf)
        chosen = np.argmax(rank, axis=2)[..., None]
        any_found: Flags = np.asarray(found.any(axis=2))
        distance, signal, spread = (
            np.take_along_axis(part, chosen, axis=2)[..., 0] for part in (distance, signal, spread)
        )
        sigma = self._sigma(signal, light[..., 0])
        told = self._with_errors(distance, signal, sigma, generator)
        status = self._status(any_found, spread, found_before)
        return Frames(
            np.where(any_found, told, np.nan), status, found.sum(axis=2),
            np.where(any_found, sigma, np.nan),
        )  # fmt: skip

    def _targets(self, view: View) -> tuple[Array, Array, Array, Array]:
        """Distance, signal and spread of each target (n, z, 4), and the background (n, z, 1)."""
        _, zones, count = view.distance_m.shape
        order = np.argsort(view.distance_m, axis=2)
        first = count * np.arange(zones)[:, None]
        long = _lengths(self.zones, self.geometry, round(count**0.5)).take(order + first)
        order += first + zones * count * np.arange(len(order))[:, None, None]
        along, cosine, rho = (
            part.take(order) for part in (view.distance_m, view.cosine, view.reflectance)
        )
        met = np.isfinite(along)
        along = np.where(met, np.maximum(along, 1e-6), 0.0)
        back = np.where(met, rho * cosine / np.where(met, along * long, 1.0) ** 2, 0.0)
        back /= count
        gap = np.zeros(along.shape, dtype=int)
        gap[..., 1:] = along[..., 1:] - along[..., :-1] > self.numbers.separation_m
        which = np.cumsum(gap * met, axis=2)
        own = np.where(
            which == np.arange(int(self.numbers.targets))[:, None, None, None], back, 0.0
        )
        signal = own.sum(axis=3)
        whole = np.where(signal > 0, signal, 1.0)
        mean = (own * along).sum(axis=3) / whole
        spread = np.sqrt((own * (along - mean[..., None]) ** 2).sum(axis=3) / whole)
        distance, signal, spread = (np.moveaxis(part, 0, 2) for part in (mean, signal, spread))
        light = self.ambient_klux * np.where(met, rho, 0.0).mean(axis=2)
        return distance, signal, spread, light[..., None]

    def _sigma(self, signal: Array, light: Array) -> Array:
        numbers, signal = self.numbers, np.maximum(signal, 1e-9)
        dark = numbers.dark_scatter_m / np.sqrt(signal)
        ambient = numbers.ambient_scatter_m * np.sqrt(light) / signal
        return self.scatter * np.sqrt(numbers.noise_floor_m**2 + dark**2 + ambient**2)

    def _with_errors(
        self, distance: Array, signal: Array, sigma: Array, generator: np.random.Generator
    ) -> Array:
        numbers = self.numbers
        drawn_near = distance * signal / np.maximum(signal + self.crosstalk, 1e-12)
        stays = self.stays * np.maximum(numbers.stays_near_m, numbers.stays_far * distance)
        drift = numbers.drift_m_per_K * (self.temperature_C - numbers.nominal_C)
        told = drawn_near + stays + drift + sigma * generator.standard_normal(distance.shape)
        counts = np.rint(np.clip(told, 0.0, None) / numbers.count_m)
        return np.asarray(counts * numbers.count_m, dtype=float)

    def _status(self, found: Flags, spread: Array, before: Flags | None) -> Codes:
        status = np.where(spread > self.numbers.pulse_m, LARGE_PULSE, VALID)
        earlier = np.empty_like(found)
        earlier[1:] = found[:-1]
        earlier[0] = True if before is None else before
        status = np.where(earlier, status, NEW)
        if before is None:
            status[0] = FIRST
        return np.where(found, status, NOTHING)


@functools.lru_cache
def _lengths(zones: int, geometry: str, in_a_row: int) -> Array:
    """Of rays until x = 1 m in the sensor's frame (zones², in_a_row²)."""
    return np.asarray(np.linalg.norm(zone_rays(zones, geometry, in_a_row), axis=2))


def drawn(
    sheet: str = "vl53l5cx", *, zones: Literal[4, 8] = 8, seed: int, device_name: str = "",
    geometry: str = "equal_angle", **settings: object,
) -> Multizone:  # fmt: skip
    """A device drawn from a data sheet: what stays with it is drawn once, by its name.

    Args:
        sheet: name or file of a data sheet with zones.
        zones: in a row.
        seed: of all streams.
        device_name: whose errors they are.
        geometry: "equal_angle" or "rectilinear".
        settings: other fields of ``Multizone``, such as ``ambient_klux``.

    Raises:
        InputError: the sheet has no zones, or a setting that cannot be; all of these at once.
    """
    faults = list(_faults(zones, seed, geometry, settings))
    if zones not in (4, 8):
        raise InputError("range sensor", faults)
    numbers = zone_numbers.load(sheet).numbers(zones)
    most, rate = numbers.rate_Hz, settings.get("rate_Hz", numbers.rate_Hz)
    if isinstance(rate, Real) and float(rate) > most:
        faults.append(f"rate_Hz is {rate}; expected a number above 0, at most {most:g}")
    if faults:
        raise InputError("range sensor", faults)
    normal = stream(seed, device_name or sheet, "zones", "stays").standard_normal(1 + zones**2)
    stays = np.sqrt(numbers.shared) * normal[0] + np.sqrt(1 - numbers.shared) * normal[1:]
    own = {"rate_Hz": most} | settings
    return Multizone(numbers, zones, geometry, stays, **own)  # type: ignore[arg-type]


def ideal(device: Multizone) -> Multizone:
    """The same device without scatter and without what stays; it still misses weak targets."""
    return replace(device, stays=np.zeros_like(device.stays), scatter=0.0)


def _faults(zones: int, seed: int, geometry: str, settings: Mapping[str, object]) -> Iterator[str]:
    """What a device cannot be."""
    if zones not in (4, 8):
        yield f"zones is {zones!r}; expected 4 or 8 in a row"
    if seed < 0:
        yield f"seed is {seed}; expected a whole number of at least 0"
    if geometry not in ("equal_angle", "rectilinear"):
        yield f"geometry is {geometry!r}; expected equal_angle or rectilinear"
    for name, value in settings.items():
        if name not in SETTINGS:
            yield f"{name} is no setting; known: {', '.join(SETTINGS)}"
        elif not _may_be(name, value):
            yield f"{name} is {value!r}; expected {SETTINGS[name]}"


def _may_be(name: str, value: object) -> bool:
    if name == "order":
        return value in ("strongest", "closest")
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        return False
    low, high = _LIMITS.get(name, (math.ulp(0.0), math.inf))
    return low <= float(value) <= high
