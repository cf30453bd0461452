"""What the error of a joint's angle at rest is made of, to first order.

With θ the angle of a frame about the joint, x across and z up, a sensor reads (-g·sin θ, g·cos θ).
What its reading is off by turns the angle by

    δθ = -(cos θ·δf_x + sin θ·δf_z)/g

so an offset gives (o_x·cos θ + o_z·sin θ)/g, scale errors ½·(s_x - s_z)·sin 2θ, and cross-axis
terms s_xz·cos² θ - s_zx·sin² θ. Noise s of both gives √2·s/g. g itself cancels.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from simcompare.estimation.joint_angle_pairs import SIDES, Motion, Pairs
from simcompare.hardware.sensors.drawing import Devices
from simcompare.model.trajectory import Array


@dataclass(frozen=True, eq=False)
class Rest:
    """The pose at rest.

    Attributes:
        forces: side -> what acts (3,).
        gravity_m_s2: g.
        length_s: for how long it is read.
    """

    forces: Mapping[str, Array]
    gravity_m_s2: float
    length_s: float

    @staticmethod
    def of(motion: Motion) -> Rest:
        """The rest before a motion."""
        still = motion.still(motion.time_s)
        time_s = motion.time_s[still]
        forces = {side: motion.forces[side][still].mean(axis=0) for side in SIDES}
        return Rest(forces, motion.gravity_m_s2, float(time_s[-1] - time_s[0]))

    def turning(self, side: str) -> Array:
        """Derivative of the frame's angle by its reading (3,) [rad/(m/s²)]."""
        x, _, z = self.forces[side]
        return np.asarray(np.array([-z, 0.0, x]) / (x**2 + z**2), dtype=float)


def as_bought(rest: Rest, drawn: Pairs) -> dict[str, float]:
    """Term -> its standard uncertainty of the angle [rad]."""
    terms: dict[str, list[Array]] = {}
    for side in SIDES:
        devices, force = drawn.devices[side], rest.forces[side]
        off = devices.sensitivity - np.eye(3)
        own = np.diagonal(off, axis1=1, axis2=2) * force
        for name, error in (
            ("offset", devices.offset),
            ("scale", own),
            ("cross-axis", off @ force - own),
            ("non-linearity", _bent(devices, force)),
        ):
            terms.setdefault(name, []).append(error @ rest.turning(side))
    return {**{name: _root(parts) for name, parts in terms.items()}, "noise": _noise(rest, drawn)}


def calibrated(rest: Rest, drawn: Pairs) -> dict[str, float]:
    """The same after a calibration: by the sources of its own uncertainty, and what it leaves."""
    variances: dict[str, float] = {}
    left = []
    for side in SIDES:
        turning, force = rest.turning(side), rest.forces[side]
        one = drawn.calibrations[side][0]
        for name, share in one.shares.items():
            part = replace(one, covariance=share).covariance_of(
                one.sensitivity @ force + one.offset
            )
            added = float(turning @ part[0] @ turning)
            variances[f"calibration: {name}"] = variances.get(f"calibration: {name}", 0.0) + added
        devices, g = drawn.devices[side], rest.gravity_m_s2
        chord = _bent(devices, np.full(3, g)) / g * force
        left.append((_bent(devices, force) - chord) @ turning)
    found = {name: float(np.sqrt(value)) for name, value in variances.items()}
    return {**found, "non-linearity": _root(left), "noise": _noise(rest, drawn)}


def _bent(devices: Devices, force: Array) -> Array:
    """What non-linearity adds to the readings of a force (d, 3)."""
    scale = devices.like.full_scale
    u = np.clip(force / scale, -1.0, 1.0)
    return np.asarray(scale * devices.nonlinearity * (4 * u**3 - 3 * u), dtype=float)


def _noise(rest: Rest, drawn: Pairs) -> float:
    """Of the mean over the rest, of both sensors: white noise and the floor of the flicker."""
    total = 0.0
    for side in SIDES:
        like = drawn.devices[side].like
        white = like.noise_density**2 / (2 * rest.length_s)
        floor = (0.664 * like.bias_instability) ** 2
        total += float(rest.turning(side) ** 2 @ (white + floor))
    return float(np.sqrt(total))


def _root(parts: list[Array]) -> float:
    """Standard uncertainty of independent parts: each the errors of all devices."""
    return float(np.sqrt(sum(np.mean(part**2) for part in parts)))
