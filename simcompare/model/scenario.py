"""WHAT is simulated: the scenario as plain frozen values in SI units, engine-neutral.

A :class:`Scenario` is what is left of a scenario file once its parameters have been given numbers.
Frames: world axes x forward, y left, z up (REP-103); quaternions ``wxyz``; positions of a body are
those of its frame, whose origin is its centre of mass unless ``center_of_mass_m`` says otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field, PositiveFloat, field_validator, model_validator

from simcompare.model.answer import Answer
from simcompare.model.estimate_plan import EstimatePlan
from simcompare.model.frozen import Frozen
from simcompare.model.sensor import MOST_COMPONENTS, Sensor
from simcompare.model.sensor_errors import ERRORS, SensorErrors
from simcompare.model.shapes import Nonnegative, Pose, Shape, Vector, not_zero
from simcompare.model.signals import Signal
from simcompare.model.trajectory import BODY_SIGNALS
from simcompare.model.validity import Condition
from simcompare.model.words import Line, Name

#: samples of one run; more fill the memory of an ordinary machine
MAX_SAMPLES = 1e7
#: joints with a coordinate, and what is recorded of them: coordinate, then rate
MOVABLE = {"hinge": ("angle_rad", "rate_rad_s"), "slider": ("position_m", "velocity_m_s")}


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
    visual: tuple[Shape, ...] = Field(
        (), description="how it is drawn, where that is not by its shapes; engines never see it"
    )
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
        if self.fixed and (self.mass_kg is not None or self.inertia_kg_m2 is not None):
            raise ValueError("a fixed body has no mass and no inertia: it never moves")
        if self.fixed and (self.drag is not None or any((*self.velocity_m_s, *self.rate_rad_s))):
            raise ValueError("a fixed body has neither velocity nor drag")
        if not self.fixed and any(shape.type == "plane" for shape in self.shapes):
            raise ValueError("a plane is half of all space, and no shape of a body that moves")
        if self.drag is not None and self.drag.factor_kg_m and any(self.center_of_mass_m):
            raise ValueError("drag acts on bodies whose centre of mass is at their origin")
        return self


class Joint(Frozen):
    """Connection of a child to its parent; axis and anchor are given in the parent's frame.

    Its coordinate is 0 as the bodies are drawn, and grows where the child turns about the axis
    (right-handed), or moves along it. A body has at most one joint in which it is the child.
    """

    type: Literal["hinge", "slider", "fixed", "ball"]
    parent: str
    child: str
    anchor_m: Vector = (0.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 1.0)
    rate: float = Field(0.0, description="at the start [rad/s] or [m/s]")
    lower: float | None = Field(None, description="lower limit [rad] or [m]")
    upper: float | None = Field(None, description="upper limit [rad] or [m]")
    stiffness: Nonnegative = Field(0.0, description="spring about rest [N·m/rad] or [N/m]")
    rest: float = Field(0.0, description="where the spring is relaxed [rad] or [m]")
    damping: Nonnegative = Field(0.0, description="viscous [N·m·s/rad] or [N·s/m]")
    friction: Nonnegative = Field(0.0, description="Coulomb [N·m] or [N]")
    armature: Nonnegative = Field(0.0, description="reflected inertia [kg·m²] or [kg]")
    errors: SensorErrors | None = Field(None, description=ERRORS)

    _has_direction = field_validator("axis")(not_zero)

    @model_validator(mode="after")
    def _possible(self) -> Joint:
        if self.parent == self.child:
            raise ValueError(f"joins {self.parent} to itself")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise ValueError(f"the lower limit {self.lower:g} is above the upper {self.upper:g}")
        if self.type not in MOVABLE and (
            any((self.rate, self.stiffness, self.rest, self.damping, self.friction, self.armature))
            or self.lower is not None
            or self.upper is not None
        ):
            raise ValueError(f"a {self.type} joint has no rate, spring, damper or limit here")
        if self.rest and not self.stiffness:
            raise ValueError("rest is where a spring is relaxed, and stiffness is 0")
        return self


class Effort(Frozen):
    """Drives a joint by a torque [N·m] or a force [N] that follows an input."""

    type: Literal["torque", "force"]
    joint: str
    input: str
    gear: float = Field(1.0, description="effort for one unit of the input")
    errors: SensorErrors | None = Field(None, description=ERRORS)


class DcMotor(Frozen):
    """Drives a hinge through a geared permanent-magnet motor; the input is its voltage [V].

    i = (V - k·N·ω)/R and τ = η·N·(k·i - b·N·ω - τ_c·sgn ω - J·N·ω̇), ω the joint's rate. The
    winding's inductance is left out: its time constant L/R is far below a mechanical one. The
    gear's efficiency η is the same when the load drives the motor, which a real gear's is not.
    Every constant of the data sheet must be given, so that none is forgotten.
    """

    type: Literal["dc_motor"]
    joint: str
    input: str
    resistance_Ohm: PositiveFloat
    torque_constant_N_m_A: Annotated[PositiveFloat, Field(description="k, also V·s/rad")]
    gear_ratio: PositiveFloat
    efficiency: Annotated[float, Field(gt=0, le=1)]
    rotor_friction_N_m: Nonnegative
    rotor_damping_N_m_s_rad: Nonnegative
    rotor_inertia_kg_m2: Nonnegative
    errors: SensorErrors | None = Field(None, description=ERRORS)


Actuator = Annotated[Effort | DcMotor, Field(discriminator="type")]


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


#: what is recorded of each actuator
ACTUATOR_SIGNALS = {
    "torque": ("torque_N_m",),
    "force": ("force_N",),
    "dc_motor": ("torque_N_m", "voltage_V", "current_A"),
}


class Probe(Frozen):
    """A scalar that is observed: one component of a body's or a joint's signal, plus an offset."""

    observe: str = Field(description="signal, for example ball.position_m")
    component: int | None = Field(None, ge=0, lt=MOST_COMPONENTS)
    offset: float = 0.0
    label: Line
    unit: str


class Measure(Frozen):
    """A measuring function of ``simcompare.measures`` applied to one probe, or to some.

    ``also`` gives the function further probes by the role that they play in it, ``options`` its
    numbers. ``names`` calls what it measures by other names, so that one function can be used
    twice in a scenario.
    """

    function: str
    probe: str
    also: Mapping[str, str] = Field(default_factory=dict)
    options: Mapping[str, float] = Field(default_factory=dict)
    names: Mapping[str, Name] = Field(default_factory=dict)

    def name_of(self, value: str) -> str:
        """What the scenario calls a value that the function measures."""
        return self.names.get(value, value)


class Tolerance(Frozen):
    """Largest accepted deviation from the truth, and why it is that large.

    With both, the larger one counts: an absolute one is what is left where the truth is near 0.
    """

    relative: PositiveFloat | None = None
    absolute: PositiveFloat | None = None
    reason: str = Field(min_length=10)

    @model_validator(mode="after")
    def _at_least_one(self) -> Tolerance:
        if self.relative is None and self.absolute is None:
            raise ValueError("give relative, absolute, or both of which the larger counts")
        return self

    def width(self, truth: float) -> float:
        """Half-width of the accepted band around ``truth``, in the unit of the truth."""
        return max(self.absolute or 0.0, (self.relative or 0.0) * abs(truth))


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
    """Gravity [m/s²], simulated time [s] and the time between recorded samples [s].

    ``substeps`` are the engine steps in one recorded step, for motion that is faster than what is
    worth recording.
    """

    gravity_m_s2: Vector = (0.0, 0.0, -9.80665)
    duration_s: PositiveFloat
    step_s: PositiveFloat = 0.001
    substeps: Annotated[int, Field(ge=1, le=1000)] = 1

    @property
    def engine_step_s(self) -> float:
        """Length of one engine step [s]."""
        return self.step_s / self.substeps

    @model_validator(mode="after")
    def _sensible_number_of_samples(self) -> World:
        samples = self.duration_s / self.step_s
        if not 1 <= samples <= MAX_SAMPLES:
            raise ValueError(
                f"step_s = {self.step_s:g} gives {samples:.3g} samples in {self.duration_s:g} s;"
                f" expected 1 to {MAX_SAMPLES:g}"
            )
        return self


class Scenario(Frozen):
    """One scene with numbers in it, ready for any engine.

    Attributes:
        parameters: the values that the file's ``${…}`` expressions were given, SI.
    """

    name: str = Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=100)  # it names a folder
    title: Line
    question: Line = Field(description="what the reader of a report wants to know")
    parameters: Mapping[str, float] = Field(default_factory=dict)
    world: World
    bodies: Mapping[Name, Body] = Field(min_length=1)
    joints: Mapping[Name, Joint] = Field(default_factory=dict)
    actuators: Mapping[Name, Actuator] = Field(default_factory=dict)
    sensors: Mapping[Name, Sensor] = Field(default_factory=dict)
    contacts: tuple[Contact, ...] = ()
    inputs: Mapping[Name, Signal] = Field(default_factory=dict)
    probes: Mapping[Name, Probe] = Field(default_factory=dict)
    measures: tuple[Measure, ...] = ()
    tolerances: Mapping[str, Tolerance] = Field(default_factory=dict)
    dither: Dither | None = None
    answer: Answer | None = None
    estimate: Mapping[str, EstimatePlan] = Field(
        default_factory=dict, description="estimator -> how it is used here; the first one leads"
    )
    holds_while: tuple[Condition, ...] = Field((), description="where the truth holds")

    @property
    def beyond(self) -> tuple[str, ...]:
        """Why the truth does not hold for these parameters, a sentence each; empty if it does."""
        return tuple(condition.said for condition in self.holds_while if condition.is_broken)

    def signals(self) -> dict[str, int]:
        """All that is recorded -> its number of components, in the order of the file."""
        owners = (*self.bodies, *self.joints, *self.actuators, *self.sensors)
        return {
            f"{owner}.{part}": width
            for owner in owners
            for part, width in self.signals_of(owner).items()
        }

    def signals_of(self, owner: str) -> dict[str, int]:
        """What is recorded of a body, joint, actuator or sensor -> its number of components."""
        if owner in self.bodies:
            return {} if self.bodies[owner].fixed else dict(BODY_SIGNALS)
        if owner in self.joints:
            return dict.fromkeys(MOVABLE.get(self.joints[owner].type, ()), 1)
        if owner in self.actuators:
            return dict.fromkeys(ACTUATOR_SIGNALS[self.actuators[owner].type], 1)
        return self.sensors[owner].signals

    def sensor_errors(self) -> dict[str, SensorErrors]:
        """Sensors, joints and actuators of which errors are said -> these."""
        owners = {**self.joints, **self.actuators, **self.sensors}
        return {name: owner.errors for name, owner in owners.items() if owner.errors is not None}

    def moving_bodies(self) -> dict[str, Body]:
        """Bodies that are not fixed to the world, in the order of the file."""
        return {name: body for name, body in self.bodies.items() if not body.fixed}

    def free_bodies(self) -> dict[str, Body]:
        """Moving bodies that hang on no joint."""
        children = {joint.child for joint in self.joints.values()}
        return {n: body for n, body in self.moving_bodies().items() if n not in children}

    def movable_joints(self) -> dict[str, Joint]:
        """Joints with a coordinate, in the order of the file."""
        return {name: joint for name, joint in self.joints.items() if joint.type in MOVABLE}

    def sensed_joints(self) -> dict[str, str]:
        """Sensors of the force through a joint -> that joint."""
        return {
            name: sensor.joint
            for name, sensor in self.sensors.items()
            if sensor.type == "force" and sensor.joint
        }

    def range_sensors(self) -> dict[str, Sensor]:
        """Sensors that look at other bodies."""
        return {name: sensor for name, sensor in self.sensors.items() if sensor.zones}

    def sensed_pairs(self) -> dict[str, tuple[str, str]]:
        """Sensors of the normal force between two bodies -> these."""
        return {
            name: sensor.pair
            for name, sensor in self.sensors.items()
            if sensor.type == "contact_force" and sensor.pair
        }

    def contact_of(self, first: str, second: str) -> Contact:
        """Contact of two bodies; a pair that is not named has no restitution and no friction.

        Two moving bodies whose pair is not named do not touch, except in the contact level
        "default", where the engine decides.
        """
        for contact in self.contacts:
            if set(contact.pair) == {first, second}:
                return contact
        return Contact(pair=(first, second))
