"""The robot's file: each part with its mass, size, place and source; all of it is frozen.

Lengths are in metres in the frame of ``solids.py``: the origin is the middle of the axle, x
forward, y left, z up. The types say what kind of value a place holds; what the values
must be for a robot to exist is in ``possible.py``, so that all faults are told at once.
"""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import Field

from simcompare.hardware.robot.pins import Pin, Role, Wire
from simcompare.model.frozen import Frozen
from simcompare.model.shapes import Vector
from simcompare.model.words import Line, Name


class Bought(Frozen):
    """Where a part comes from.

    Attributes:
        text: what it is.
        maker: who makes or sells it.
        part_number: of the maker or seller, where one was seen.
        price: of one piece, where one was seen. currency: of the price.
        price_source: where the price was seen.
        source: where mass and size were read, or how they were chosen.
        confirmed: whether mass and size stand in that source.
    """

    text: Line
    maker: Line = ""
    part_number: Line = ""
    price: float | None = None
    currency: Line = ""
    price_source: Line = ""
    source: Line = ""
    confirmed: bool = False


class Chassis(Bought):
    """The printed part: a plate on the motors, two cheeks, a post for the caster, a wall in front.

    Attributes:
        length_m: of the plate, along x. width_m: across. thickness_m: of the plate.
        front_m: how far it reaches before the axle.
        underside_m: how far the plate's underside is above the axle.
        cheek_m: size of each of the cheeks between which the battery hangs.
        post_m: length and width of the post that carries the caster.
        wall_m: size of the wall on the plate's front edge, which carries the range sensor.
        density_kg_m3: of the printed part as it is filled.
    """

    length_m: float
    width_m: float
    thickness_m: float
    front_m: float
    underside_m: float
    cheek_m: Vector
    post_m: tuple[float, float]
    wall_m: Vector
    density_kg_m3: float


class Wheels(Bought):
    """Both wheels, taken as uniform cylinders; track_m is between their middles."""

    mass_kg: float
    radius_m: float
    width_m: float
    track_m: float


class Caster(Bought):
    """The ball caster, taken as an upright cylinder on the floor.

    Attributes:
        mass_kg: with its housing. behind_m: from the axle to the ball. radius_m: of the ball.
        height_m: from the floor to the post. screws_m: between its two screws, across.
        screw_m: diameter of the holes for them.
    """

    mass_kg: float
    behind_m: float
    radius_m: float
    height_m: float
    screws_m: float
    screw_m: float


class Part(Bought):
    """A part that is fixed to the chassis, taken as a uniform box.

    Attributes:
        mass_kg: of one. size_m: edges along x, y and z. position_m: of its middle.
        mirrored: whether there is another one on the other side, at -y.
        wires: its pins, and where each leads.
        right_wires: what of that is other for the one on the right.
        pins: of the controller: what each of them can do.
        i2c: its address on the bus.
        frame: what ROS calls its frame, where it is a sensor.
    """

    mass_kg: float
    size_m: Vector
    position_m: Vector
    mirrored: bool = False
    wires: Mapping[Pin, Wire] = Field(default_factory=dict)
    right_wires: Mapping[Pin, Wire] = Field(default_factory=dict)
    pins: Mapping[Pin, Role] = Field(default_factory=dict)
    i2c: int | None = None
    frame: Name | None = None


class Drive(Frozen):
    """Constants of a motor, as ``dc_motor`` of a scenario has them, of its encoder and supply."""

    resistance_Ohm: float
    torque_constant_N_m_A: float
    gear_ratio: float
    efficiency: float
    rotor_friction_N_m: float
    rotor_damping_N_m_s_rad: float
    rotor_inertia_kg_m2: float
    shaft_marks: int
    battery_V: float
    source: Line = ""
    confirmed: bool = False


class Motor(Part):
    """A gear motor; there is one on each side. ``drive`` holds its constants."""

    drive: Drive


class Robot(Frozen):
    """A robot on two wheels and a caster.

    Attributes:
        scenario: in which it is written for other simulators.
        body: what is called there all of it but the wheels.
    """

    name: Name
    title: Line
    scenario: Name
    body: Name
    chassis: Chassis
    wheels: Wheels
    caster: Caster
    motor: Motor
    parts: Mapping[Name, Part]

    @property
    def all_parts(self) -> Mapping[str, Part]:
        """Parts that are fixed to the chassis, with the motors."""
        return {"motor": self.motor, **self.parts}
