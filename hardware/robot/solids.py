"""Mass, centre of mass and inertia of boxes and cylinders, and of what is made up of them.

Frame of the robot: the origin is the middle of the axle, x forward, y left, z up.
Source of the moments: any textbook of mechanics, with the theorem of parallel axes.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from simcompare.model.shapes import Vector
from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class Solid:
    """A box, or a cylinder about an axis of the frame; a hole is one that takes away.

    Attributes:
        kind: "box", or the axis of a cylinder.
        size_m: edges along x, y and z. Those across a cylinder's axis are its diameter.
        position_m: of its middle.
        is_hole: whether it is cut out of the others.
    """

    kind: Literal["box", "x", "y", "z"]
    size_m: Vector
    position_m: Vector
    is_hole: bool = False

    @property
    def radius_m(self) -> float:
        """Of a cylinder [m]."""
        return self.size_m[("xyz".index(self.kind) + 1) % 3] / 2

    @property
    def volume_m3(self) -> float:
        """Its volume; that of a hole is negative [m³]."""
        volume = math.prod(self.size_m) * (1.0 if self.kind == "box" else math.pi / 4)
        return -volume if self.is_hole else volume

    @property
    def low_m(self) -> Array:
        """The lower corner of the box around it (3,) [m]."""
        return np.array(self.position_m) - np.array(self.size_m) / 2

    @property
    def high_m(self) -> Array:
        """The upper corner of the box around it (3,) [m]."""
        return np.array(self.position_m) + np.array(self.size_m) / 2

    def squares_m2(self) -> Array:
        """Mean squares of x, y and z about its middle (3,): L²/12; across a cylinder r²/4."""
        parts = np.full(3, 12.0 if self.kind == "box" else 16.0)
        if self.kind != "box":
            parts["xyz".index(self.kind)] = 12.0
        squares: Array = np.array(self.size_m) ** 2 / parts
        return squares


@dataclass(frozen=True, eq=False)
class Mass:
    """What a rigid body is for mechanics.

    Attributes:
        mass_kg: its mass.
        center_m: its centre of mass (3,).
        inertia_kg_m2: moments and products of inertia about that centre, along the axes (3, 3).
    """

    mass_kg: float
    center_m: Array
    inertia_kg_m2: Array


def volume_m3(solids: Iterable[Solid]) -> float:
    """Volume of solids that do not overlap, less their holes [m³]."""
    return sum(solid.volume_m3 for solid in solids)


def mass_of(solids: Iterable[Solid], mass_kg: float) -> Mass:
    """Mass of a uniform body that is made up of solids.

    Args:
        solids: they touch, but do not overlap; each hole lies inside of them.
        mass_kg: of the whole.
    """
    solids = list(solids)
    density = mass_kg / volume_m3(solids)
    return together(
        Mass(
            density * solid.volume_m3,
            np.array(solid.position_m),
            _inertia(density * solid.volume_m3, np.diag(solid.squares_m2())),
        )
        for solid in solids
    )


def together(masses: Iterable[Mass]) -> Mass:
    """Several bodies that are fixed to each other."""
    masses = list(masses)
    total = sum(one.mass_kg for one in masses)
    center: Array = np.sum([one.mass_kg * one.center_m for one in masses], axis=0) / total
    inertia = np.zeros((3, 3))
    for one in masses:
        off = one.center_m - center
        inertia += one.inertia_kg_m2 + _inertia(one.mass_kg, np.outer(off, off))
    return Mass(total, center, inertia)


def _inertia(mass_kg: float, squares_m2: Array) -> Array:
    """Inertia of a mass with such means of x_i·x_j: the products get a minus sign."""
    inertia: Array = mass_kg * (np.trace(squares_m2) * np.eye(3) - squares_m2)
    return inertia
