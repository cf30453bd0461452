"""A range sensor of many zones in a scenario: one device, and what it reads of a motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError, UnknownName
from simcompare.hardware.sensors import multizone, zone_numbers, zone_view
from simcompare.hardware.sensors.drawn_terms import DrawnTerm
from simcompare.hardware.sensors.multizone import Frames, Multizone
from simcompare.hardware.sensors.zone_numbers import ZoneSheet
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import Array, Trajectory
from simcompare.statistics.streams import stream


@dataclass(frozen=True, eq=False)
class ZoneReading:
    """What a device told, beside the ideal ranges at the same times.

    Attributes:
        time_s: when frames are told (m,) [s].
        ideal: ranges of the ideal sensor then (m, z) [m].
        frames: what was told.
    """

    time_s: Array
    ideal: Array
    frames: Frames

    def columns(self) -> dict[str, NDArray[Any]]:
        """One row for each zone of each frame; a range that there is not is NaN."""
        frames, (count, zones) = self.frames, self.ideal.shape
        return {
            "time_s": np.repeat(self.time_s, zones),
            "zone": np.tile(np.arange(zones), count),
            "ideal_m": self.ideal.ravel(),
            "range_m": frames.range_m.ravel(),
            "status": frames.status.ravel(),
            "targets": frames.targets.ravel(),
            "sigma_m": frames.sigma_m.ravel(),
        }


@dataclass(frozen=True, eq=False)
class DrawnZones:
    """The device that looks in place of an ideal sensor.

    Attributes:
        signal: such as "eye.range_m".
        device: its numbers.
        sheet: its data sheet.
        scenario: the scene in which it looks.
        reflectance: of bodies of which one is said.
    """

    signal: str
    device: Multizone
    sheet: ZoneSheet
    scenario: Scenario
    reflectance: Mapping[str, float]

    def read(self, moved: Trajectory, seed: int) -> ZoneReading | None:
        """What it tells; ``None`` where a source lacks the ideal ranges, or moves not all bodies.

        Raises:
            InputError: the motion is shorter than a frame.
        """
        needed = [
            f"{name}.{part}"
            for name in self.scenario.moving_bodies()
            for part in ("position_m", "orientation_wxyz")
        ]
        if not {self.signal, *needed} <= set(moved.signals):
            return None
        owner, noise = self.signal.partition(".")[0], stream(seed, self.signal, "noise")
        told_s, frames = zone_view.frames(
            self.device, self.scenario, owner, moved, noise, self.reflectance
        )
        samples = zone_view.nearest(moved.time_s, told_s)
        return ZoneReading(told_s, moved.signals[self.signal][samples], frames)

    def terms(self) -> Iterator[DrawnTerm]:
        """The numbers of the device with their sources: what was drawn, then those of its kind."""
        far_away, stays = self.device.numbers.stays_far, self.device.stays
        rows = {row.term: row for row in self.sheet.rows[self.device.zones]}
        far = rows["far"]
        yield DrawnTerm(
            "stays", "mean of zones", float(far_away * stays.mean()), "", "normal",
            far_away * self.device.u_mean, far.says, str(far.page), far.confirmed,
        )  # fmt: skip
        for row in rows.values():
            source = row.source if row.page == "none" else str(row.page)
            unit = next((u for u, end in _UNITS.items() if row.term.endswith(end)), "1")
            yield DrawnTerm(
                row.term, "", row.value, unit, "fixed", 0.0, row.says, source, row.confirmed
            )


_UNITS = {"m/K": "_m_per_K", "m": "_m", "Hz": "_Hz", "klux": "_klux", "°C": "_C"}


def of_sensor(scenario: Scenario, name: str, said: Mapping[str, Any], seed: int) -> DrawnZones:
    """A device in the place of a range sensor.

    Args:
        scenario: the scene.
        name: of the sensor.
        said: ``sheet``, settings of ``Multizone``, and ``reflectance``: body -> 0 to 1.
        seed: of all streams.

    Raises:
        UnknownName: no such sheet.
        InputError: no sheet or one without zones, and settings that cannot be; all of these.
    """
    if "sheet" not in said:
        raise InputError(name, ["a range sensor of many zones needs a sheet, such as vl53l5cx"])
    sheet, sensor = zone_numbers.load(said["sheet"]), scenario.sensors[name]
    settings = {key: one for key, one in said.items() if key not in ("sheet", "reflectance")}
    known = [*multizone.SETTINGS, "reflectance"]
    faults = [
        str(UnknownName("setting of a range sensor", key, known))
        for key in settings
        if key not in known
    ]
    reflectance = said.get("reflectance", {})
    if isinstance(reflectance, Mapping):
        faults += _faults_of(reflectance, scenario)
    else:
        faults.append("reflectance is of a body, such as reflectance.floor = 0.1")
    assert sensor.zones is not None
    try:
        device = multizone.drawn(
            said["sheet"], zones=sensor.zones, seed=seed, device_name=name,
            geometry=sensor.geometry or "equal_angle",
            **{key: one for key, one in settings.items() if key in known},
        )  # fmt: skip
    except InputError as error:
        raise InputError(name, [*faults, *error.faults]) from None
    frame_s, lasts_s = 1 / device.rate_Hz, scenario.world.duration_s
    if frame_s > lasts_s * (1 + 1e-9):
        short = f"a frame takes {frame_s:.4g} s and the scenario {lasts_s:g} s"
        faults.append(f"{short}; simulate for longer, or ask for a higher rate_Hz")
    if faults:
        raise InputError(name, faults)
    return DrawnZones(f"{name}.range_m", device, sheet, scenario, reflectance)


def _faults_of(reflectance: Mapping[str, object], scenario: Scenario) -> Iterator[str]:
    for body, value in reflectance.items():
        if body not in scenario.bodies:
            yield f"reflectance: {UnknownName('body', body, scenario.bodies)}"
        elif isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= 1:
            yield f"reflectance of {body} is {value!r}; expected 0 to 1"
