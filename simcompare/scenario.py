"""WHAT is simulated: the scenario as plain frozen values in SI units, engine-neutral.

A :class:`Scenario` is what is left of a scenario file once its parameters have been given numbers.
Frames: world axes x forward, y left, z up (REP-103); quaternions ``wxyz``; positions of a body are
those of its frame, whose origin is its centre of mass unless ``center_of_mass_m`` says otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field, PositiveFloat, field_validator, model_validator

from simcompare.shapes import Frozen, Nonnegative, Pose, Shape, Vector, not_zero
from simcompare.signals import Signal

#: samples of one run; more fill the memory of an ordinary machine
MOST_SAMPLES = 1e7


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

    _has_direction = field_validator("axis")(not_zero)

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
