"""Shapes of bodies, and what every part of a scenario is made of: frozen, finite, SI."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import (
    Field,
    PositiveFloat,
    field_validator,
    model_validator,
)

from simcompare.model.frozen import Frozen

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Nonnegative = Annotated[float, Field(ge=0)]


class Pose(Frozen):
    """Position [m] and orientation (unit quaternion wxyz) in the parent's frame."""

    position_m: Vector = (0.0, 0.0, 0.0)
    orientation_wxyz: Quaternion = (1.0, 0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _unit_quaternion(self) -> Pose:
        norm = math.hypot(*self.orientation_wxyz)
        if abs(norm - 1.0) > 1e-6:
            raise ValueError(f"orientation_wxyz has length {norm:.6g}; a rotation has length 1")
        return self


def not_zero(direction: Vector) -> Vector:
    """The direction itself; a fault if it has no length."""
    if math.hypot(*direction) == 0:
        raise ValueError("a direction of length 0 points nowhere")
    return direction


class Plane(Frozen):
    """Half space below a plane through ``position_m``; ``normal`` points out of the solid."""

    type: Literal["plane"]
    position_m: Vector = (0.0, 0.0, 0.0)
    normal: Vector = (0.0, 0.0, 1.0)

    _has_direction = field_validator("normal")(not_zero)


class Sphere(Pose):
    """Solid sphere."""

    type: Literal["sphere"]
    radius_m: PositiveFloat


class Box(Pose):
    """Box; ``size_m`` holds the full edge lengths along x, y, z."""

    type: Literal["box"]
    size_m: tuple[PositiveFloat, PositiveFloat, PositiveFloat]


class Cylinder(Pose):
    """Cylinder along its own z axis; ``length_m`` is the full length."""

    type: Literal["cylinder"]
    radius_m: PositiveFloat
    length_m: PositiveFloat


class Capsule(Pose):
    """Capsule along its own z axis; ``length_m`` is that of the cylindrical part."""

    type: Literal["capsule"]
    radius_m: PositiveFloat
    length_m: PositiveFloat


Shape = Annotated[Plane | Sphere | Box | Cylinder | Capsule, Field(discriminator="type")]


def sizes_m(shape: Shape) -> dict[str, float]:
    """The lengths that make a shape, by name [m]; none for a plane."""
    match shape.type:
        case "plane":
            return {}
        case "sphere":
            return {"radius_m": shape.radius_m}
        case "box":
            return {f"size_m.{axis}": edge for axis, edge in zip("xyz", shape.size_m, strict=True)}
        case _:
            return {"radius_m": shape.radius_m, "length_m": shape.length_m}
