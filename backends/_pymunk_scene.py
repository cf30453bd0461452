"""A scene as Chipmunk's bodies, shapes and constraints, and what they hold."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from simcompare.audit import Audit
from simcompare.backends._pymunk_joints import LINKAGES, Linkage, Point, armature_of
from simcompare.backends._pymunk_sweeps import sweeps_for
from simcompare.drives import JointLaw, laws_of
from simcompare.errors import Unsupported
from simcompare.helps import LANDING
from simcompare.kinematics import add_children, in_order
from simcompare.landing import approaches
from simcompare.pairs import friction_per_body, restitution_per_body, touching_pairs
from simcompare.scenario import MOVABLE, Body, Scenario
from simcompare.settings import Settings
from simcompare.shapes import Shape
from simcompare.state import State
from simcompare.trajectory import BODY_SIGNALS, Array

if TYPE_CHECKING:
    import pymunk

#: a plane is a bar this long to either side and this thick [m]
BAR_HALF_LENGTH_M, BAR_RADIUS_M = 1000.0, 0.5
#: overlap that is allowed where everything is given [m]; the default of 0.1 is meant for pixels
SLOP_M = 1e-9
#: bodies that can have bits of their own in Chipmunk's 32, two of which are shared
MOST_PARTNERS = 30


@dataclass
class Scene:
    """What was built, by the names of the scenario.

    Attributes:
        scenario: what was built.
        settings: how much of the scenario is given to the engine.
        space: the engine's space.
        bodies: the engine's bodies.
        shapes: the shapes of every body.
        joints: all joints, each after the one that carries its parent.
        restitution: per body; empty where it is left to the engine.
        friction: per body, likewise.
        sweeps: of the solver over all joints and contacts; ``None``: the engine's own number.
    """

    scenario: Scenario
    settings: Settings
    space: pymunk.Space
    bodies: dict[str, pymunk.Body] = field(default_factory=dict)
    shapes: dict[str, list[pymunk.Shape]] = field(default_factory=dict)
    joints: dict[str, Linkage] = field(default_factory=dict)
    restitution: dict[str, float] = field(default_factory=dict)
    friction: dict[str, float] = field(default_factory=dict)
    sweeps: int | None = None


def build(engine: ModuleType, scenario: Scenario, settings: Settings) -> Scene:
    """Builds all bodies and joints in a new space, with as much as the contact level gives."""
    told, whole = settings.gives_coefficients, settings.gives_all
    scene = Scene(scenario, settings, engine.Space())
    gx, _, gz = scenario.world.gravity_m_s2
    scene.space.gravity = (gx, gz)
    if whole:
        scene.space.collision_slop = SLOP_M
    if told:
        scene.restitution = restitution_per_body(scenario, settings, "pymunk")
        scene.friction = friction_per_body(scenario, "pymunk")
    laws = laws_of(scenario)
    for name, body in scenario.bodies.items():
        _add_body(engine, scene, name, body, armature_of(scenario.joints, laws, name))
    if told:
        _keep_apart(engine, scene)
    for name, joint in in_order(scenario).items():
        law = laws.get(name, JointLaw())
        linkage = LINKAGES[joint.type](engine, scene.bodies, scenario, name, law, whole)
        scene.joints[name] = linkage
        scene.space.add(*linkage.constraints)
    if whole and scene.joints:
        scene.sweeps = sweeps_for(scenario, scene.bodies, scene.space.constraints)
        scene.space.iterations = scene.sweeps
    _start(scene)
    return scene


def _add_body(
    engine: ModuleType, scene: Scene, name: str, body: Body, armature_kg_m2: float
) -> None:
    if body.fixed:
        held = engine.Body(body_type=engine.Body.STATIC)
    else:
        assert body.inertia_kg_m2 is not None
        held = engine.Body(body.mass_kg, body.inertia_kg_m2[1] + armature_kg_m2)
    held.position = (body.position_m[0], body.position_m[2])
    held.angle = angle_of(body.orientation_wxyz)
    landed = scene.settings.takes(LANDING) and approaches(scene.scenario)[0]
    raised = SLOP_M if scene.settings.gives_all and not landed else 0.0
    shapes = [_shape(engine, held, shape, raised) for shape in body.shapes]
    for shape in shapes if scene.restitution else ():
        shape.elasticity, shape.friction = scene.restitution[name], scene.friction[name]
    scene.bodies[name], scene.shapes[name] = held, shapes
    scene.space.add(held, *shapes)


def _keep_apart(engine: ModuleType, scene: Scene) -> None:
    """Lets moving bodies pass through one another whose pair the scenario does not name.

    Each of those that are named has a bit of its own; all others share one, and so do fixed bodies.
    """
    scenario, alone, fixed = scene.scenario, 1, 2
    partners: dict[str, set[str]] = {}
    for contact in touching_pairs(scenario):
        first, second = contact.pair
        if not (scenario.bodies[first].fixed or scenario.bodies[second].fixed):
            partners.setdefault(first, set()).add(second)
            partners.setdefault(second, set()).add(first)
    bits = {name: fixed << i for i, name in enumerate(partners, start=1)}
    if len(bits) > MOST_PARTNERS:
        raise Unsupported(
            f"pymunk keeps at most {MOST_PARTNERS} moving bodies apart that may touch others,"
            f" not {len(bits)}"
        )
    for name, body in scenario.bodies.items():
        if body.fixed:
            known = engine.ShapeFilter(categories=fixed)
        else:
            mask = fixed | sum(bits[other] for other in partners.get(name, ()))
            known = engine.ShapeFilter(categories=bits.get(name, alone), mask=mask)
        for shape in scene.shapes[name]:
            shape.filter = known


def _start(scene: Scene) -> None:
    """Velocities at the start; those of bodies on joints follow from the joints' rates."""
    scenario = scene.scenario
    signals = {
        f"{name}.{part}": np.array([getattr(body, part)])
        for name, body in scenario.free_bodies().items()
        for part in BODY_SIGNALS
    }
    for name, joint in scenario.movable_joints().items():
        for part, value in zip(MOVABLE[joint.type], (0.0, joint.rate), strict=True):
            signals[f"{name}.{part}"] = np.array([value])
    add_children(scenario, signals, 1)
    for name in scenario.moving_bodies():
        vx, _, vz = signals[f"{name}.velocity_m_s"][0].tolist()
        scene.bodies[name].velocity = (vx, vz)
        scene.bodies[name].angular_velocity = -float(signals[f"{name}.rate_rad_s"][0][1])


def bends_of(scenario: Scenario, state: State, step_s: float) -> list[Point]:
    """Half the second differences of all positions in a step, if joints kept their rates."""
    times = step_s * np.array((-1.0, 0.0, 1.0))
    signals: dict[str, Array] = {}
    for name in scenario.free_bodies():
        held = state.bodies[name]
        half = (times * held.rate_rad_s[1] - angle_of(held.orientation_wxyz)) / 2
        zero = np.zeros(3)
        signals[f"{name}.position_m"] = held.position_m + np.outer(times, held.velocity_m_s)
        signals[f"{name}.orientation_wxyz"] = np.column_stack(
            (np.cos(half), zero, np.sin(half), zero)
        )
        for part in ("velocity_m_s", "rate_rad_s"):
            signals[f"{name}.{part}"] = np.tile(getattr(held, part), (3, 1))
    for name, joint in scenario.movable_joints().items():
        position, rate = state.joints[name]
        coordinate, speed = MOVABLE[joint.type]
        signals[f"{name}.{coordinate}"] = position + rate * times
        signals[f"{name}.{speed}"] = np.full(3, rate)
    add_children(scenario, signals, 3)
    found = []
    for name in scenario.moving_bodies():
        before, now, after = signals[f"{name}.position_m"]
        x, _, z = ((before + after) / 2 - now).tolist()
        found.append((x, z))
    return found


def _shape(engine: ModuleType, held: pymunk.Body, shape: Shape, raised_m: float) -> pymunk.Shape:
    x, z = shape.position_m[0], shape.position_m[2]
    match shape.type:
        case "plane":
            nx, nz = shape.normal[0], shape.normal[2]
            length = math.hypot(nx, nz)
            nx, nz = nx / length, nz / length
            # raised by the overlap that is allowed, what is drawn as touching is found to touch
            depth = BAR_RADIUS_M - raised_m
            cx, cz = x - nx * depth, z - nz * depth
            ends = [
                (cx + side * BAR_HALF_LENGTH_M * nz, cz - side * BAR_HALF_LENGTH_M * nx)
                for side in (-1, 1)
            ]
            return engine.Segment(held, *ends, BAR_RADIUS_M)
        case "sphere":
            return engine.Circle(held, shape.radius_m, (x, z))
        case _:
            assert shape.type == "box"
            if shape.orientation_wxyz[1] or shape.orientation_wxyz[3]:
                raise Unsupported("pymunk: a box is turned out of the plane")
            a, b = shape.size_m[0] / 2, shape.size_m[2] / 2
            turned = engine.Transform.identity().translated(x, z)
            turned = turned.rotated(angle_of(shape.orientation_wxyz))
            return engine.Poly(held, [(-a, -b), (a, -b), (a, b), (-a, b)], turned)


def angle_of(orientation_wxyz: Sequence[float]) -> float:
    """Angle in pymunk's plane of a turn about y; from x towards z is positive there."""
    return -2 * math.atan2(orientation_wxyz[2], orientation_wxyz[0])


def audit_of(scene: Scene) -> Audit:
    """Everything that was set, and what the engine holds."""
    audit = Audit("pymunk")
    _audit_world(audit, scene)
    laws = laws_of(scene.scenario)
    _audit_planes(audit, scene)
    for name, body in scene.scenario.moving_bodies().items():
        _audit_body(audit, scene, name, body, armature_of(scene.scenario.joints, laws, name))
    for linkage in scene.joints.values():
        linkage.audit(audit)
        _audit_efforts(audit, linkage, scene.settings.gives_all)
    _audit_contacts(audit, scene)
    return audit


def _audit_world(audit: Audit, scene: Scene) -> None:
    space, world = scene.space, scene.scenario.world
    gx, _, gz = world.gravity_m_s2
    audit.add("gravity_m_s2.x", gx, "Space.gravity.x", (gx, space.gravity[0]), "m/s²")
    audit.add("gravity_m_s2.z", gz, "Space.gravity.y", (gz, space.gravity[1]), "m/s²")
    step_s, argument = world.engine_step_s, "an argument of each step"
    audit.add("engine step_s", step_s, "Space.step(dt)", (step_s, None), "s", argument)
    slop = (SLOP_M if scene.settings.gives_all else None, space.collision_slop)
    note = "" if scene.settings.gives_all else "engine's default: overlap that is left alone"
    audit.add("contact", None, "Space.collision_slop", slop, "m", note)
    audit.add("damping", None, "Space.damping", (1.0, space.damping), "1", "1 means none")
    if scene.joints:
        sweeps = (scene.sweeps, space.iterations)
        audit.add("joints", None, "Space.iterations", sweeps, "1", "sweeps over all constraints")


def _audit_planes(audit: Audit, scene: Scene) -> None:
    """Planes are bars whose upper side is raised by the overlap that is allowed."""
    for name, body in scene.scenario.bodies.items():
        for shape, solid in zip(body.shapes, scene.shapes[name], strict=True):
            if shape.type == "plane" and scene.settings.gives_all:
                values = (BAR_RADIUS_M, solid.radius)
                audit.add(
                    f"{name} plane", None, "Segment.radius", values, "m", "a bar, see mapping"
                )


def _audit_body(audit: Audit, scene: Scene, name: str, body: Body, armature: float) -> None:
    moving, shapes = scene.bodies[name], scene.shapes[name]
    audit.add(f"{name}.mass_kg", body.mass_kg, "Body.mass", (body.mass_kg, moving.mass), "kg")
    assert body.inertia_kg_m2 is not None
    moment = body.inertia_kg_m2[1]
    note = f"with {armature:g} of the hinge's armature" if armature else ""
    values = (moment + armature, moving.moment)
    audit.add(f"{name}.inertia_kg_m2.2", moment, "Body.moment", values, "kg·m²", note)
    x, z = body.position_m[0], body.position_m[2]
    audit.add(f"{name}.position_m.x", x, "Body.position.x", (x, moving.position[0]), "m")
    audit.add(f"{name}.position_m.z", z, "Body.position.y", (z, moving.position[1]), "m")
    for shape, solid in zip(body.shapes, shapes, strict=True):
        if shape.type == "sphere":
            audit.add_sizes(name, shape, "Circle.radius", [solid.radius])
        elif shape.type == "box":
            corners = np.array(solid.get_vertices())
            along, up = (float(np.linalg.norm(corners[i + 1] - corners[i])) for i in (0, 1))
            # the order of the corners may begin with either edge; the third edge is not there
            edges = [along, up] if math.isclose(along, shape.size_m[0]) else [up, along]
            audit.add_sizes(name, shape, "Poly.vertices", [edges[0], shape.size_m[1], edges[1]])


def _audit_efforts(audit: Audit, linkage: Linkage, drawn_together: bool) -> None:
    """What acts on a joint in each step, which the engine holds no longer than that."""
    law, kind = linkage.law, linkage.joint.type
    for part, value, unit in (
        ("stiffness", law.stiffness, "N·m/rad" if kind == "hinge" else "N/m"),
        ("damping", law.damping, "N·m·s/rad" if kind == "hinge" else "N·s/m"),
    ):
        if value:
            parameter = "Body.torque" if kind == "hinge" else "Body.force"
            note = "an effort that is given in each step"
            audit.add(f"{linkage.name}.{part}", value, parameter, (value, None), unit, note)
    if law.armature:
        values = (law.armature, None)
        note = "added to the child's moment of inertia, where it is read back"
        audit.add(f"{linkage.name}.armature", law.armature, "Body.moment", values, "kg·m²", note)
    held = linkage.constraints
    colliding = (0.0, float(sum(c.collide_bodies for c in held)))
    audit.add(f"{linkage.name}", None, "Constraint.collide_bodies", colliding, "1")
    bias = (0.0 if drawn_together else None, max(c.error_bias for c in held))
    note = "share of an error that is left after a second"
    audit.add(f"{linkage.name}", None, "Constraint.error_bias", bias, "1", note)


def _audit_contacts(audit: Audit, scene: Scene) -> None:
    note = "pymunk multiplies the two" if scene.restitution else "engine's default"
    for contact in touching_pairs(scene.scenario):
        pair = "-".join(contact.pair)
        for name in contact.pair:
            held = scene.shapes[name][0]
            values = (scene.restitution.get(name), held.elasticity)
            parameter = f"elasticity of {name}"
            audit.add(f"{pair} restitution", contact.restitution, parameter, values, "1", note)
            values = (scene.friction.get(name), held.friction)
            parameter = f"friction of {name}"
            audit.add(f"{pair} friction", contact.friction, parameter, values, "1", note)
