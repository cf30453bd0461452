"""Where the solids of a robot are, what they weigh together, and a scenario's parameters of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from simcompare.hardware.robot.description import Part, Robot
from simcompare.hardware.robot.solids import Mass, Solid, mass_of, together, volume_m3
from simcompare.model.shapes import Box, Cylinder, Shape, Vector
from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class Placed:
    """A part in its place.

    Attributes:
        name: its own; one of a pair is called left_… or right_….
        place: in the file.
        mass_kg: its mass, spread evenly over its solids.
        solids: what it is made up of.
        is_wheel: whether it turns, and is no part of the body.
    """

    name: str
    place: str
    mass_kg: float
    solids: tuple[Solid, ...]
    is_wheel: bool = False

    @property
    def mass(self) -> Mass:
        """Its mass, centre of mass and inertia."""
        return mass_of(self.solids, self.mass_kg)


def chassis_solids(robot: Robot) -> tuple[Solid, ...]:
    """The printed part: plate, wall, post and cheeks, which touch, less two screw holes."""
    c, caster = robot.chassis, robot.caster
    below, above = c.underside_m, c.underside_m + c.thickness_m
    front, rear = c.front_m, c.front_m - c.length_m
    top = caster.height_m - robot.wheels.radius_m
    post_height = below - top
    plate, wall, cheek = (c.length_m, c.width_m, c.thickness_m), c.wall_m, c.cheek_m
    cheek_y = c.width_m / 2 - robot.motor.size_m[1] - cheek[1] / 2
    solids = [
        _box(plate, ((front + rear) / 2, 0.0, below + c.thickness_m / 2)),
        _box(wall, (front - wall[0] / 2, 0.0, above + wall[2] / 2)),
        _box((*c.post_m, post_height), (-caster.behind_m, 0.0, top + post_height / 2)),
    ]  # fmt: skip
    solids += [
        _box(cheek, (robot.motor.position_m[0], y, below - cheek[2] / 2))
        for y in (cheek_y, -cheek_y)
    ]
    depth = above - top
    hole = (caster.screw_m, caster.screw_m, depth)
    for y in (caster.screws_m / 2, -caster.screws_m / 2):
        place = (-caster.behind_m, y, top + depth / 2)
        solids.append(Solid("z", hole, place, is_hole=True))
    return tuple(solids)


def placed(robot: Robot) -> tuple[Placed, ...]:
    """All parts in their places: the chassis first, the wheels last."""
    chassis = chassis_solids(robot)
    caster, wheels = robot.caster, robot.wheels
    found = [
        Placed("chassis", "chassis", robot.chassis.density_kg_m3 * volume_m3(chassis), chassis)
    ]
    ball = (2 * caster.radius_m, 2 * caster.radius_m, caster.height_m)
    at = (-caster.behind_m, 0.0, caster.height_m / 2 - wheels.radius_m)
    found.append(Placed("caster", "caster", caster.mass_kg, (Solid("z", ball, at),)))
    for name, part in robot.all_parts.items():
        found += _of_part(name, part)
    size = (2 * wheels.radius_m, wheels.width_m, 2 * wheels.radius_m)
    for side, sign in (("left", 1), ("right", -1)):
        at = (0.0, sign * wheels.track_m / 2, 0.0)
        wheel = Solid("y", size, at)
        found.append(Placed(f"{side}_wheel", "wheels", wheels.mass_kg, (wheel,), is_wheel=True))
    return tuple(found)


def body_of(robot: Robot) -> Mass:
    """The robot without its wheels, as one rigid body."""
    return together(one.mass for one in placed(robot) if not one.is_wheel)


def parameters(robot: Robot) -> Mapping[str, float]:
    """What follows from the file, by the names of scenarios' parameters, SI."""
    body, wheels, drive = body_of(robot), robot.wheels, robot.motor.drive
    roll, pitch, yaw = (float(body.inertia_kg_m2[i, i]) for i in range(3))
    return {
        "body_mass_kg": body.mass_kg,
        "body_yaw_inertia_kg_m2": yaw,
        "roll_inertia_share": roll / yaw,
        "pitch_inertia_share": pitch / yaw,
        "wheel_mass_kg": wheels.mass_kg,
        "wheel_radius_m": wheels.radius_m,
        "wheel_width_m": wheels.width_m,
        "track_m": wheels.track_m,
        "center_height_m": wheels.radius_m + float(body.center_m[2]),
        "center_behind_m": -float(body.center_m[0]),
        "caster_behind_m": robot.caster.behind_m,
        "caster_radius_m": robot.caster.radius_m,
        **drive.model_dump(exclude={"source", "confirmed", "battery_V"}),
    }


def drawn(robot: Robot) -> tuple[Shape, ...]:
    """All but the wheels as shapes in the body's frame, whose origin is its centre of mass."""
    center = body_of(robot).center_m
    solids = [one for part in placed(robot) if not part.is_wheel for one in part.solids]
    return tuple(_drawn(one, one.position_m - center) for one in solids if not one.is_hole)


def products_kg_m2(robot: Robot) -> Vector:
    """Products of inertia I_xy, I_xz and I_yz of the body, which no scenario's parameter holds."""
    inertia = body_of(robot).inertia_kg_m2
    return float(inertia[0, 1]), float(inertia[0, 2]), float(inertia[1, 2])


def tilt_rad(robot: Robot) -> float:
    """How far the body's principal axes are turned about y from the robot's own [rad]."""
    inertia = body_of(robot).inertia_kg_m2
    return math.atan2(2 * inertia[0, 2], inertia[2, 2] - inertia[0, 0]) / 2


def _of_part(name: str, part: Part) -> list[Placed]:
    x, y, z = part.position_m
    place = name if name == "motor" else f"parts.{name}"
    if not part.mirrored:
        return [Placed(name, place, part.mass_kg, (_box(part.size_m, part.position_m),))]
    return [
        Placed(f"{side}_{name}", place, part.mass_kg, (_box(part.size_m, at),))
        for side, at in (("left", (x, abs(y), z)), ("right", (x, -abs(y), z)))
    ]


def _drawn(solid: Solid, place: Array) -> Shape:
    """A box, or an upright cylinder: no others are on the body."""
    x, y, z = place.tolist()
    if solid.kind == "box":
        return Box(type="box", size_m=solid.size_m, position_m=(x, y, z))
    return Cylinder(
        type="cylinder",
        radius_m=solid.radius_m,
        length_m=solid.size_m[2],
        position_m=(x, y, z),
    )


def _box(size: Vector, position: Vector) -> Solid:
    return Solid("box", size, position)
