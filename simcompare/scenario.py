"""WHAT is simulated: the scenario as plain frozen values in SI units, engine-neutral.

A :class:`Scenario` is what is left of a scenario file once its parameters have been given numbers.
Frames: world axes x forward, y left, z up (REP-103); quaternions ``wxyz``; positions of a body are
those of its frame, whose origin is its centre of mass unless ``center_of_mass_m`` says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    PositiveFloat,
    field_validator,
    model_validator,
)

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Nonnegative = Annotated[float, Field(ge=0)]
#: samples of one run; more fill the memory of an ordinary machine
MOST_SAMPLES = 1e7


class Frozen(BaseModel):
    """Base of every part of a scenario: immutable, finite numbers, no unknown keys."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


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


def _not_zero(direction: Vector) -> Vector:
    if math.hypot(*direction) == 0:
        raise ValueError("a direction of length 0 points nowhere")
    return direction


class Plane(Frozen):
    """Half space below a plane through ``position_m``; ``normal`` points out of the solid."""

    type: Literal["plane"]
    position_m: Vector = (0.0, 0.0, 0.0)
    normal: Vector = (0.0, 0.0, 1.0)

    _has_direction = field_validator("normal")(_not_zero)


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


class Drag(Frozen):
    """Quadratic air drag -½·ρ·C_d·A·|v|·v on the centre of mass (no lift, no added mass)."""

    coefficient: Nonnegative
    area_m2: PositiveFloat
    air_density_kg_m3: Nonnegative

    @property
    def factor_kg_m(self) -> float:
        """C = ½·ρ·C_d·A in F = -c·|v|·v [kg/m]."""
        return 0.5 * self.air_density_kg_m3 * self.coefficient * self.area_m2


class Body(Pose):
    """A rigid body: fixed to the world, or with mass and principal moments of inertia."""

    fixed: bool = False
    mass_kg: PositiveFloat | None = None
    inertia_kg_m2: tuple[PositiveFloat, PositiveFloat, PositiveFloat] | None = None
    center_of_mass_m: Vector = (0.0, 0.0, 0.0)
    velocity_m_s: Vector = (0.0, 0.0, 0.0)
    rate_rad_s: Vector = (0.0, 0.0, 0.0)
    shapes: tuple[Shape, ...] = ()
    drag: Drag | None = None

    @model_validator(mode="after")
    def _moving_bodies_have_mass(self) -> Body:
        if not self.fixed and (self.mass_kg is None or self.inertia_kg_m2 is None):
            raise ValueError("a body that moves needs mass_kg and inertia_kg_m2 (or fixed: true)")
        if self.inertia_kg_m2 is not None:
            *small, large = sorted(self.inertia_kg_m2)
            if large > sum(small) * (1 + 1e-9):
                raise ValueError(
                    f"no mass has the moments {self.inertia_kg_m2}:"
                    " one exceeds the sum of the others"
                )
        return self


class Joint(Frozen):
    """Connection of two bodies; axis and anchor are given in the parent's frame."""

    type: Literal["hinge", "slider", "fixed", "ball"]
    parent: str
    child: str
    anchor_m: Vector = (0.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 1.0)
    lower: float | None = Field(None, description="lower limit [rad] or [m]")
    upper: float | None = Field(None, description="upper limit [rad] or [m]")
    stiffness: Nonnegative = Field(0.0, description="spring about zero [N·m/rad] or [N/m]")
    damping: Nonnegative = Field(0.0, description="viscous [N·m·s/rad] or [N·s/m]")
    friction: Nonnegative = Field(0.0, description="Coulomb [N·m] or [N]")
    armature: Nonnegative = Field(0.0, description="reflected inertia [kg·m²] or [kg]")

    _has_direction = field_validator("axis")(_not_zero)

    @model_validator(mode="after")
    def _possible(self) -> Joint:
        if self.parent == self.child:
            raise ValueError(f"joins {self.parent} to itself")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise ValueError(f"{self.lower=} is above {self.upper=}")
        return self


class Actuator(Frozen):
    """Drives a joint by a torque [N·m], a force [N] or, through a DC motor, a voltage [V]."""

    type: Literal["torque", "force", "dc_motor"]
    joint: str
    input: str
    gear: float = 1.0
    constants: Mapping[str, float] = Field(default_factory=dict, description="motor data in SI")


class Contact(Frozen):
    """What happens between one pair of bodies; engines combine per-body values by different rules.

    ``restitution`` is Newton's coefficient of the pair, ``friction`` Coulomb's.
    """

    pair: tuple[str, str]
    restitution: Annotated[float, Field(ge=0, le=1)] = 0.0
    friction: Nonnegative = 0.0

    @model_validator(mode="after")
    def _two_bodies(self) -> Contact:
        if self.pair[0] == self.pair[1]:
            raise ValueError(f"{self.pair[0]} cannot touch itself")
        return self


class Sensor(Pose):
    """An ideal sensor fixed to a body; error models are applied afterwards, not in the engine."""

    type: Literal["accelerometer", "gyroscope", "force", "range", "encoder", "barometer"]
    body: str | None = None
    joint: str | None = None

    @model_validator(mode="after")
    def _has_a_place(self) -> Sensor:
        place = "joint" if self.type == "encoder" else "body"
        if getattr(self, place) is None:
            raise ValueError(f"a sensor of type {self.type} needs a {place}")
        return self


class Constant(Frozen):
    """The same value at all times."""

    signal: Literal["constant"]
    value: float


class Step(Frozen):
    """``before`` until ``time_s``, ``after`` from then on."""

    signal: Literal["step"]
    before: float = 0.0
    after: float
    time_s: float = 0.0


class Ramp(Frozen):
    """Straight line from ``start`` at ``start_s`` to ``end`` at ``end_s``, constant outside."""

    signal: Literal["ramp"]
    start: float = 0.0
    end: float
    start_s: float = 0.0
    end_s: float

    @model_validator(mode="after")
    def _forward(self) -> Ramp:
        if self.end_s <= self.start_s:
            raise ValueError(f"{self.end_s=} must be later than {self.start_s=}")
        return self


class Sine(Frozen):
    """offset + amplitude·sin(2π·frequency·t + phase)."""

    signal: Literal["sine"]
    amplitude: float
    frequency_Hz: PositiveFloat
    phase_rad: float = 0.0
    offset: float = 0.0


class Chirp(Frozen):
    """Logarithmic sweep from ``start_Hz`` to ``end_Hz`` within ``duration_s``."""

    signal: Literal["chirp"]
    amplitude: float
    start_Hz: PositiveFloat
    end_Hz: PositiveFloat
    duration_s: PositiveFloat


class Table(Frozen):
    """Values at given times, straight lines between them, constant outside."""

    signal: Literal["table"]
    time_s: tuple[float, ...] = Field(min_length=2)
    value: tuple[float, ...]

    @model_validator(mode="after")
    def _sorted(self) -> Table:
        if len(self.time_s) != len(self.value):
            raise ValueError(f"{len(self.time_s)} times but {len(self.value)} values")
        for i in range(1, len(self.time_s)):
            if self.time_s[i] <= self.time_s[i - 1]:
                raise ValueError(f"time_s[{i}] = {self.time_s[i]} is not later than the one before")
        return self


Signal = Annotated[Constant | Step | Ramp | Sine | Chirp | Table, Field(discriminator="signal")]


class Probe(Frozen):
    """A scalar that is observed: one component of a body's or a joint's signal, plus an offset."""

    observe: str = Field(description="signal, for example ball.position_m")
    component: int | None = Field(None, ge=0, le=3)
    offset: float = 0.0
    label: str
    unit: str


class Measure(Frozen):
    """A measuring function of ``simcompare.measures`` applied to one probe."""

    function: str
    probe: str


class Tolerance(Frozen):
    """Largest accepted deviation from the truth, and why it is that large."""

    relative: PositiveFloat | None = None
    absolute: PositiveFloat | None = None
    reason: str = Field(min_length=10)

    @model_validator(mode="after")
    def _one_of_two(self) -> Tolerance:
        if (self.relative is None) == (self.absolute is None):
            raise ValueError("give either relative or absolute, not both and not neither")
        return self

    def width(self, truth: float) -> float:
        """Half-width of the accepted band around ``truth``, in the unit of the truth."""
        if self.absolute is not None:
            return self.absolute
        assert self.relative is not None
        return self.relative * abs(truth)


class Dither(Frozen):
    """How repeats differ: one parameter is spread evenly over ``span`` about its value.

    A single impact simulation depends on where within a time step the impact falls; the spread
    covers that phase, so the mean over the repeats does not.
    """

    parameter: str
    span: Nonnegative
    count: int = Field(9, ge=1)
    reason: str


class World(Frozen):
    """Gravity [m/s²], simulated time [s] and the time between recorded samples [s]."""

    gravity_m_s2: Vector = (0.0, 0.0, -9.80665)
    duration_s: PositiveFloat
    step_s: PositiveFloat = 0.001

    @model_validator(mode="after")
    def _sensible_number_of_samples(self) -> World:
        samples = self.duration_s / self.step_s
        if not 1 <= samples <= MOST_SAMPLES:
            raise ValueError(
                f"step_s = {self.step_s:g} gives {samples:.3g} samples in {self.duration_s:g} s;"
                f" expected 1 to {MOST_SAMPLES:g}"
            )
        return self


class Scenario(Frozen):
    """One scene with numbers in it, ready for any engine.

    Attributes:
        parameters: the values that the file's ``${…}`` expressions were given, SI.
    """

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$")
    title: str
    question: str = Field(description="what the reader of a report wants to know")
    parameters: Mapping[str, float] = Field(default_factory=dict)
    world: World
    bodies: Mapping[str, Body] = Field(min_length=1)
    joints: Mapping[str, Joint] = Field(default_factory=dict)
    actuators: Mapping[str, Actuator] = Field(default_factory=dict)
    sensors: Mapping[str, Sensor] = Field(default_factory=dict)
    contacts: tuple[Contact, ...] = ()
    inputs: Mapping[str, Signal] = Field(default_factory=dict)
    probes: Mapping[str, Probe] = Field(default_factory=dict)
    measures: tuple[Measure, ...] = ()
    tolerances: Mapping[str, Tolerance] = Field(default_factory=dict)
    dither: Dither | None = None

    def moving_bodies(self) -> dict[str, Body]:
        """Bodies that are not fixed to the world, in the order of the file."""
        return {name: body for name, body in self.bodies.items() if not body.fixed}

    def contact_of(self, first: str, second: str) -> Contact:
        """Contact of two bodies; a pair that is not named has no restitution and no friction.

        Two moving bodies whose pair is not named are left to what the engine makes of them.
        """
        for contact in self.contacts:
            if set(contact.pair) == {first, second}:
                return contact
        return Contact(pair=(first, second))
