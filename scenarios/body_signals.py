"""Signals of bodies in references: of one that does not turn, and of a vehicle on flat ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from simcompare.model.rotations import quaternions_of
from simcompare.model.trajectory import Array


def unturned(name: str, position_m: Array, velocity_m_s: Array) -> dict[str, Array]:
    """Signals of a body that moves without turning, (n, 3) each."""
    count = len(position_m)
    return {
        f"{name}.position_m": position_m,
        f"{name}.velocity_m_s": velocity_m_s,
        f"{name}.orientation_wxyz": np.tile((1.0, 0.0, 0.0, 0.0), (count, 1)),
        f"{name}.rate_rad_s": np.zeros((count, 3)),
    }


@dataclass(frozen=True)
class Vehicle:
    """A vehicle on flat ground, by the middle of its axle, all (n,).

    Attributes:
        x_m: where it is.
        y_m: where it is.
        heading_rad: about the vertical.
        speed_m_s: straight ahead.
        yaw_rate_rad_s: rate of its heading.
    """

    x_m: Array
    y_m: Array
    heading_rad: Array
    speed_m_s: Array
    yaw_rate_rad_s: Array

    @property
    def ahead(self) -> Array:
        """The direction straight ahead (n, 3)."""
        return self._flat(np.cos(self.heading_rad), np.sin(self.heading_rad))

    @property
    def aside(self) -> Array:
        """The direction to the left (n, 3)."""
        return self._flat(-np.sin(self.heading_rad), np.cos(self.heading_rad))

    @property
    def orientation_wxyz(self) -> Array:
        """Of everything that is fixed to it (n, 4)."""
        return quaternions_of(self.turned(self.heading_rad))

    def turned(self, about_vertical: Array) -> Array:
        """A vector along the vertical (n, 3)."""
        zero = np.zeros(len(about_vertical))
        return np.column_stack((zero, zero, about_vertical))

    def point(self, ahead_m: float, left_m: float, height_m: float) -> tuple[Array, Array]:
        """Position and velocity of a point of it (n, 3)."""
        position = self._flat(self.x_m, self.y_m) + ahead_m * self.ahead + left_m * self.aside
        position[:, 2] += height_m
        along, across = self.speed_m_s - self.yaw_rate_rad_s * left_m, self.yaw_rate_rad_s * ahead_m
        return position, along[:, None] * self.ahead + across[:, None] * self.aside

    def body(self, name: str, ahead_m: float, left_m: float, height_m: float) -> dict[str, Array]:
        """Signals of a body that is fixed to it at a point."""
        position, velocity = self.point(ahead_m, left_m, height_m)
        return {
            f"{name}.position_m": position,
            f"{name}.velocity_m_s": velocity,
            f"{name}.orientation_wxyz": self.orientation_wxyz,
            f"{name}.rate_rad_s": self.turned(self.yaw_rate_rad_s),
        }

    def _flat(self, x: Array, y: Array) -> Array:
        return np.column_stack((x, y, np.zeros(len(x))))
