"""A six-position session with a device that is drawn from a data sheet: as in the laboratory.

The device is laid on each side for a few seconds, never quite level, and read. So calibrations can
be tried without hardware, and what they recover can be held against what is true.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from simcompare.hardware.sensors import error_model, still_poses
from simcompare.hardware.sensors.calibrated import Readings
from simcompare.hardware.sensors.calibration import Taken
from simcompare.hardware.sensors.device import Device
from simcompare.hardware.sensors.six_position import ON_A_TABLE, POSITIONS
from simcompare.hardware.sensors.still_poses import BLOCK_S, StillPose
from simcompare.model.trajectory import Array
from simcompare.statistics.distributions import Distribution

#: readings in a second, far slower than any bandwidth: their noise is white
RATE_HZ = 100.0


@dataclass(frozen=True, eq=False)
class Session:
    """What was read in each pose.

    Attributes:
        readings: means with their uncertainty.
        acting: what truly acted (p, 3) [m/s²].
    """

    readings: Readings
    acting: Array


def hold(
    device: Device,
    generator: np.random.Generator,
    gravity_m_s2: float,
    tilt: Taken = ON_A_TABLE,
    *,
    pose_s: float = 5.0,
    others: Array | None = None,
) -> Session:
    """Lays an accelerometer on its six sides, and in other poses that verify.

    Args:
        device: its numbers.
        generator: of its noise and of the tilts.
        gravity_m_s2: g where it is done.
        tilt: of what each pose is off the vertical, two angles [rad].
        pose_s: time in each pose [s].
        others: directions of "up" of the other poses (q, 3).
    """
    wanted = np.array([*POSITIONS.values(), *([] if others is None else others)])
    acting = gravity_m_s2 * _tilted(wanted, tilt.known, generator)
    blocks, size = round(pose_s / BLOCK_S), round(BLOCK_S * RATE_HZ)
    force = np.repeat(acting, blocks * size, axis=0)
    slow = replace(device, rate_Hz=0.0, bandwidth_Hz=np.inf, jitter_s=0.0, latency_s=0.0)
    read = error_model.measured(slow, np.arange(len(force)) / RATE_HZ, force, generator)
    means = read.measured.reshape(len(wanted), blocks, size, 3).mean(axis=2)
    poses = tuple(
        StillPose(pose_s * number, pose_s * (number + 1), one) for number, one in enumerate(means)
    )
    found = still_poses.readings_of(poses)
    extra = (f"tilted {number}" for number in range(1, 1 + len(wanted) - len(POSITIONS)))
    return Session(replace(found, names=(*POSITIONS, *extra)), acting)


def chord(device: Device, gravity_m_s2: float) -> tuple[Array, Array]:
    """True S and O between -g and +g, at the device's temperature, seen from the box.

    An odd curvature makes the slope of that chord another one than that through zero.
    """
    none = np.zeros(device.axes)
    quiet = replace(
        device, noise_density=none, bias_instability=none, random_walk=none, resolution=0.0,
        noise_per_reading=none, rate_Hz=0.0, bandwidth_Hz=np.inf, jitter_s=0.0, latency_s=0.0,
    )  # fmt: skip
    force = gravity_m_s2 * np.array(list(POSITIONS.values()))
    time_s = np.arange(len(force)) / RATE_HZ
    read = error_model.measured(quiet, time_s, force, np.random.default_rng(0)).measured
    up, down = read[::2], read[1::2]
    return (up - down).T / (2 * gravity_m_s2), np.asarray(read.mean(axis=0), dtype=float)


def _tilted(wanted: Array, tilt: Distribution, generator: np.random.Generator) -> Array:
    """Directions off these by two small angles each."""
    off = tilt.draw(generator, wanted.shape)
    off -= np.sum(off * wanted, axis=1, keepdims=True) * wanted
    up = wanted + off
    return np.asarray(up / np.linalg.norm(up, axis=1, keepdims=True), dtype=float)
