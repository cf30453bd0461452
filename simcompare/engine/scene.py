"""What an adapter is asked to build, and what its engine is like."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.engine.contacts import ContactPlan, plan_contacts
from simcompare.engine.drives import JointLaw, laws_of
from simcompare.engine.features import Feature
from simcompare.engine.helps import LANDING, RIMS, centred_efforts, rims, spring_contact
from simcompare.engine.helps.landing import approaches, finely_stepped
from simcompare.engine.kinematics import Mount, add_children, in_order, mount_of, placed_shapes
from simcompare.engine.state import BodyState
from simcompare.errors import Unsupported
from simcompare.model.scenario import MOVABLE, Joint, Scenario
from simcompare.model.settings import COEFFICIENT, SPRING, Settings
from simcompare.model.shapes import Shape, Vector
from simcompare.model.trajectory import BODY_SIGNALS, Array
from simcompare.model.vectors import plus, times, turned


@dataclass(frozen=True)
class Traits:
    """What an engine is like, as far as the core has to know it.

    Attributes:
        positions_first: whether a step advances positions before velocities, so that forces act at
            its end; else velocities come first, and forces act at its start.
        precision: relative rounding of its numbers; 1e-12 for double, 1e-6 for single precision.
        bounces_by: what it is given for a pair's restitution: one ``COEFFICIENT``, or a ``SPRING``
            and damper; empty where it takes the scenario's own number as it stands.
        passive: what it does itself about springs and dampers of joints: "none" of it; "implicit":
            with the rate after a step; "both": also with the rate before it, in an actuator.
        offset_centres: whether bodies may have centres of mass beside their origins.
        most_shapes: how many shapes a body may have; ``None``: any number.
        has_armature: whether joints have armatures; else they become a part of moments of inertia.
        wrong_reactions: faults of its forces that a help can mend: "twice", Coriolis and gyroscopic
            terms in forces through joints; "magnitude", which is all that it tells of them;
            "stale", forces of points of contact that no longer act.
        most_turn_rad: largest turn of a body in an engine step; faster ones are slowed down.
        rims: what ``helps.rims`` builds in place of shapes that it handles badly.
        foresees_contacts: whether it stops a body that would arrive in its next inner step.
        contact_gap_m: gap up to which contacts are to act where nothing bounces [m].
        contact_step_s: longest step during an impact that is landed on [s].
        rest_step_s: longest step while a body rests, where impacts are landed on [s].
        bounce_step_s: longest step where bounces are to be helped but not landed on [s].
        turn_made: what becomes of the turn [rad] that a body should make in a step; ``None``: it is
            made.
    """

    positions_first: bool = False
    precision: float = 1e-12
    bounces_by: str = COEFFICIENT
    passive: str = "none"
    offset_centres: bool = False
    most_shapes: int | None = None
    has_armature: bool = False
    wrong_reactions: frozenset[str] = frozenset()
    most_turn_rad: float | None = None
    rims: rims.Rims | None = None
    foresees_contacts: bool = False
    contact_gap_m: float = 0.0
    #: a bias of g·dt/v stays below 1e-4 down to 0.2 m/s
    contact_step_s: float = 2.0e-6
    rest_step_s: float | None = None
    bounce_step_s: float | None = None
    turn_made: Callable[[float], float] | None = None


@dataclass(frozen=True)
class SceneJoint:
    """One joint.

    Attributes:
        name: its name.
        joint: as the scenario states it.
        mount: how its child sits on its parent where its coordinate is 0.
        law: all that acts on it.
        own: what the engine itself is to be given of springs and dampers, friction and armature.
        actuator_damping: what an actuator of its own gives, with the rate before a step.
        given: what is given as an effort in each step.
    """

    name: str
    joint: Joint
    mount: Mount
    law: JointLaw
    own: JointLaw
    actuator_damping: float
    given: JointLaw

    @property
    def is_movable(self) -> bool:
        """Whether it has a coordinate."""
        return self.joint.type in MOVABLE


@dataclass(frozen=True)
class Scene:
    """A scene at one level, ready to be built.

    Attributes:
        engine: name of the engine, for messages.
        traits: what the engine is like.
        features: what its backend can do.
        scenario: the scene, in steps as fine as our helps ask for.
        settings: level, helps and numbers.
        contacts: who touches whom, and with what.
        joints: all of them, each after the one that carries its parent.
        shapes: what every body is built of; other shapes than its own where a help asks for them.
        helps: our helps that are in it.
        variant: which variant of the engine; empty for the engine as it comes.
    """

    engine: str
    traits: Traits
    features: frozenset[Feature]
    scenario: Scenario
    settings: Settings
    contacts: ContactPlan
    joints: Mapping[str, SceneJoint]
    shapes: Mapping[str, Sequence[Shape]]
    helps: frozenset[str]
    variant: str = ""

    @functools.cached_property
    def starts(self) -> Mapping[str, BodyState]:
        """Motion of every moving body at the start, those on joints included."""
        return starts_of(self.scenario)

    def gives(self, level: str) -> bool:
        """Whether all that a level gives is given to the engine."""
        return self.settings.gives(level)

    def placed_shapes(self, body: str) -> list[Shape]:
        """Shapes of a body: in its frame, or in the world's where it is fixed, and so no body.

        Normals of planes have length 1.
        """
        return placed_shapes(self.scenario.bodies[body], self.shapes[body])

    def drawn(self, joint: str) -> tuple[Vector, Vector]:
        """Anchor and unit axis of a joint in the world's frame, as it is drawn."""
        stated = self.joints[joint].joint
        parent, unit = self.scenario.bodies[stated.parent], 1 / math.hypot(*stated.axis)
        arm, axis = (turned(parent.orientation_wxyz, v) for v in (stated.anchor_m, stated.axis))
        return plus(parent.position_m, arm), times(unit, axis)

    @property
    def roots(self) -> list[str]:
        """Bodies that no joint carries, fixed ones included."""
        carried = {joint.joint.child for joint in self.joints.values()}
        return [name for name in self.scenario.bodies if name not in carried]

    @property
    def lands(self) -> bool:
        """Whether impacts are landed on."""
        return self.settings.takes(LANDING) and bool(approaches(self.scenario)[0])

    @property
    def contact_gap_m(self) -> float:
        """Gap up to which contacts act [m]; a bounce must not begin before there is none."""
        return 0.0 if self.contacts.bounces else self.traits.contact_gap_m

    @property
    def contact_softness(self) -> float:
        """Constraint force mixing of contacts that a help asks for; see ``helps.rims``."""
        return rims.softness_of(self.scenario, self.traits.rims) if RIMS in self.helps else 0.0

    def inertia(self, body: str) -> Array:
        """Tensor of inertia (3, 3) of a body in its own frame, with armatures where they belong.

        Raises:
            Unsupported: an armature that has no place in it.
        """
        found = np.diag(self.scenario.bodies[body].inertia_kg_m2 or (0.0, 0.0, 0.0))
        armature = self.armature_on(body)
        if armature:
            axis = np.array(self._carrying(body).mount.axis)
            found = found + armature * np.outer(axis, axis)
        return np.asarray(found, dtype=float)

    def moments(self, body: str) -> tuple[float, float, float]:
        """Principal moments of inertia of a body, likewise.

        Raises:
            Unsupported: an armature about another axis, or on a slider.
        """
        moments = self.scenario.bodies[body].inertia_kg_m2
        assert moments is not None
        armature = self.armature_on(body)
        if not armature:
            return moments
        joint = self._carrying(body)
        added = [armature if abs(abs(a) - 1) < 1e-9 else 0.0 for a in joint.mount.axis]
        if not any(added):
            raise Unsupported(
                f"{self.engine} has no armature; it can be added to a moment of inertia of {body},"
                f" but the axis of {joint.name} is none of its principal axes"
            )
        first, second, third = (i + a for i, a in zip(moments, added, strict=True))
        return first, second, third

    def armature_on(self, body: str) -> float:
        """Armature that is a part of a body's moment of inertia [kg·m²]; 0 for none.

        Raises:
            Unsupported: it belongs to a slider, where a mass in its place would have weight.
        """
        if self.traits.has_armature:
            return 0.0
        for joint in self.joints.values():
            if joint.joint.child == body and joint.law.armature:
                if joint.joint.type != "hinge":
                    raise Unsupported(
                        f"{self.engine} has no armature, and {joint.name}, a slider, has one: a"
                        " mass in its place would have weight"
                    )
                return joint.law.armature
        return 0.0

    def armature_note(self, body: str) -> str:
        """What to say of a moment of inertia that has an armature in it; empty for others."""
        armature = self.armature_on(body)
        return f"with {armature:g} of the hinge's armature" if armature else ""

    def _carrying(self, body: str) -> SceneJoint:
        return next(joint for joint in self.joints.values() if joint.joint.child == body)


def make_scene(
    engine: str,
    traits: Traits,
    features: frozenset[Feature],
    scenario: Scenario,
    settings: Settings,
    variant: str = "",
) -> Scene:
    """What an engine is to build of a scenario, at a level and with helps.

    Raises:
        Unsupported: a help cannot be had for this scene.
    """
    springs = {}
    if settings.takes(LANDING) and traits.bounces_by == SPRING:
        springs = spring_contact.springs_of(scenario)
    if settings.takes(LANDING) and traits.bounce_step_s is not None:
        scenario = finely_stepped(scenario, traits.bounce_step_s)
    shapes = {name: tuple(body.shapes) for name, body in scenario.bodies.items()}
    other = rims.other_shapes(scenario, traits.rims) if settings.takes(RIMS) else {}
    return Scene(
        engine, traits, features, scenario, settings, plan_contacts(scenario, settings, springs),
        _joints(scenario, settings, traits.passive), {**shapes, **other},
        frozenset({RIMS} if other else ()), variant,
    )  # fmt: skip


def _joints(scenario: Scenario, settings: Settings, passive: str) -> dict[str, SceneJoint]:
    laws = laws_of(scenario)
    found = {}
    for name, joint in in_order(scenario).items():
        law = laws.get(name, JointLaw())
        own, actuator, given = centred_efforts.shares(law, passive, settings)
        mount = mount_of(scenario, joint)
        found[name] = SceneJoint(name, joint, mount, law, own, actuator, given)
    return found


def starts_of(scenario: Scenario) -> dict[str, BodyState]:
    """Motion of every moving body at the start; that of bodies on joints follows from these."""
    signals = {
        f"{name}.{part}": np.array([getattr(body, part)])
        for name, body in scenario.free_bodies().items()
        for part in BODY_SIGNALS
    }
    for name, joint in scenario.movable_joints().items():
        for part, value in zip(MOVABLE[joint.type], (0.0, joint.rate), strict=True):
            signals[f"{name}.{part}"] = np.array([value])
    add_children(scenario, signals, 1)
    return {  # places as they are drawn, without the rounding of what follows
        name: BodyState(
            body.position_m,
            body.orientation_wxyz,
            tuple(signals[f"{name}.velocity_m_s"][0].tolist()),
            tuple(signals[f"{name}.rate_rad_s"][0].tolist()),
        )
        for name, body in scenario.moving_bodies().items()
    }
