"""What pairs of drawn devices read of the motion of a joint, and their calibrations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simcompare.errors import InputError
from simcompare.estimation.joint_angle import refuse_upright
from simcompare.hardware.sensors import error_model, session, six_position
from simcompare.hardware.sensors.calibration import Calibration, Taken
from simcompare.hardware.sensors.data_sheet import DataSheet, Part
from simcompare.hardware.sensors.device import Device
from simcompare.hardware.sensors.drawing import Devices
from simcompare.hardware.sensors.error_model import Readings
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import normal
from simcompare.statistics.streams import stream

SIDES = ("first", "second")
#: g is known from a map and the height above the sea [m/s²]
U_G_M_S2 = 1e-3
#: a range is taken that the motion fills to at most this part
_FILLED = 0.8


@dataclass(frozen=True, eq=False)
class Motion:
    """What happens, without any error.

    Attributes:
        time_s: (n,), evenly spaced.
        angle_rad: of the joint (n,).
        forces: "first" and "second", and where they are wanted "first_axis" and "second_axis" ->
            specific force (n, 3), y along the joint.
        rates: side -> rate (n, 3); empty where lever arms are not taken off.
        levers_m: side -> place of its sensor on its z axis, from the joint.
        still_until_s: end of the rest.
        moving_from_s: begin of the free motion.
        gravity_m_s2: g.
        gate: how far from g, as a part, a trusted reading may be.
    """

    time_s: Array
    angle_rad: Array
    forces: Mapping[str, Array]
    rates: Mapping[str, Array]
    levers_m: Mapping[str, float]
    still_until_s: float
    moving_from_s: float
    gravity_m_s2: float = 9.80665
    gate: float = 0.05

    def still(self, time_s: Array) -> NDArray[np.bool_]:
        """Which of these times are at rest."""
        return np.asarray(time_s <= self.still_until_s * (1 + 1e-9))

    def moving(self, time_s: Array) -> NDArray[np.bool_]:
        """Which of these times are in free motion."""
        return np.asarray(time_s > self.moving_from_s * (1 + 1e-9))

    def check(self) -> None:
        """Refuses what no angle can be told from.

        Raises:
            InputError: no rest or no motion, or an axis that stands upright.
        """
        still = self.still(self.time_s)
        if still.sum() < 2 or not self.moving(self.time_s).any():
            fault = "needs two samples at rest and some in motion; correct still_until_s and"
            raise InputError("joint angle", [f"{fault} moving_from_s"])
        for side in SIDES:
            force = self.forces[side][still]
            refuse_upright(f"joint angle, {side}", force, self.gravity_m_s2)


@dataclass(frozen=True, eq=False)
class Pairs:
    """What all pairs read.

    Attributes:
        time_s: when (m,): the accelerometer's own samples.
        devices: side -> its accelerometers.
        calibrations: side -> those of these devices.
        forces: role -> readings (d, m, 3).
        corrected: the same after the calibration.
        rates: side -> readings of the gyroscopes (d, m, 3); empty where the chip has none.
        notes: what the reader must know.
    """

    time_s: Array
    devices: Mapping[str, Devices]
    calibrations: Mapping[str, Sequence[Calibration]]
    forces: Mapping[str, Array]
    corrected: Mapping[str, Array]
    rates: Mapping[str, Array]
    notes: tuple[str, ...]


def drawn_pairs(motion: Motion, sheet: DataSheet, part: Part, count: int, seed: int) -> Pairs:
    """Draws pairs of devices, calibrates each, and lets them read the motion."""
    devices = {side: _drawn(part, motion.forces, side, count, seed) for side in SIDES}
    calibrations = {side: [*_calibrated(devices[side], motion, side, seed)] for side in SIDES}
    read = {
        role: _read(devices[_side(role)], motion.time_s, force, seed, role)
        for role, force in motion.forces.items()
    }
    time_s = read["first"].time_s[0]
    forces = {role: one.measured for role, one in read.items()}
    corrected = {
        role: _corrected(calibrations[_side(role)], force) for role, force in forces.items()
    }
    gyroscope = sheet.part_for("rad/s")
    rates = {} if gyroscope is None else _rates(motion, time_s, gyroscope, count, seed)
    notes = tuple(_notes(sheet.title, devices["first"].like, has_rates=bool(rates)))
    return Pairs(time_s, devices, calibrations, forces, corrected, rates, notes)


def _corrected(calibrations: Sequence[Calibration], force: Array) -> Array:
    """Readings of all devices (d, m, 3), each with its own calibration."""
    return np.stack([one.apply(read) for one, read in zip(calibrations, force, strict=True)])


def _notes(chip: str, like: Device, *, has_rates: bool) -> Iterator[str]:
    filtered = f"behind a low-pass of {like.bandwidth_Hz:g} Hz"
    yield f"{chip}: readings {like.rate_Hz:g} times a second {filtered}"
    if not has_rates:
        yield f"{chip} has no gyroscope, so lever arms are not taken off"


def _side(role: str) -> str:
    return role.partition("_")[0]


def _drawn(part: Part, ideal: Mapping[str, Array], side: str, count: int, seed: int) -> Devices:
    """Devices at the smallest range that the motion fits into, with exact clocks."""
    largest = max(float(np.abs(values).max()) for values in ideal.values())
    ranges = sorted(part.ranges.values(), key=lambda one: one.full_scale)
    fitting = [one for one in ranges if _FILLED * one.full_scale >= largest]
    chosen = (fitting or ranges[-1:])[0].name
    drawn = part.drawn_many(seed, count, f"joint {side}", range=chosen)
    # time stamps are those of the bus, not of the chip
    return replace(drawn, rate_error=np.zeros(count))


def _calibrated(devices: Devices, motion: Motion, side: str, seed: int) -> Iterator[Calibration]:
    g = motion.gravity_m_s2
    known = normal(g, U_G_M_S2)
    for number, device in enumerate(devices):
        generator = stream(seed, "joint", side, "calibration", number)
        held = session.hold(device, generator, float(known.draw(generator, 1)[0]))
        yield six_position.calibrate(held.readings, Taken(known))


def _rates(motion: Motion, time_s: Array, part: Part, count: int, seed: int) -> dict[str, Array]:
    """What the gyroscopes read, at the accelerometers' times."""
    found = {}
    for side, rate in motion.rates.items():
        devices = _drawn(part, motion.rates, side, count, seed)
        own = _read(devices, motion.time_s, rate, seed, f"{side} rate")
        read = _at(time_s, own)
        # at rest a gyroscope tells its own offset
        found[side] = read - read[:, motion.still(time_s)].mean(axis=1, keepdims=True)
    return found


def _read(devices: Devices, time_s: Array, ideal: Array, seed: int, role: str) -> Readings:
    every: list[Device] = list(devices)
    return error_model.measured_by(every, time_s, ideal, stream(seed, "joint", role, "noise"))


def _at(time_s: Array, read: Readings) -> Array:
    """Readings of devices with one clock at other times, on straight lines (d, m, 3)."""
    own = read.time_s[0]
    if len(own) == len(time_s) and np.allclose(own, time_s, rtol=0, atol=1e-9):
        return read.measured
    columns = [[np.interp(time_s, own, axis) for axis in one.T] for one in read.measured]
    return np.asarray(np.transpose(columns, (0, 2, 1)), dtype=float)
