"""A scene as Chipmunk's bodies, shapes and constraints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from simcompare.backends.pymunk.joints import constraints_of, rows_of
from simcompare.backends.pymunk.variants import VARIANTS
from simcompare.kit import (
    COEFFICIENTS,
    TUNED,
    PlanarJoint,
    Scene,
    Shape,
    Unsupported,
    angle_of,
    planar,
    sweeps_for,
)

#: a plane is a bar this long to either side and this thick [m]
BAR_HALF_LENGTH_M, BAR_RADIUS_M = 1000.0, 0.5
#: overlap that is allowed where everything is given [m]; the default of 0.1 is meant for pixels
SLOP_M = 1e-9


@dataclass
class Space:
    """What was built, by the names of the scenario.

    Attributes:
        space: Chipmunk's space.
        bodies: its bodies.
        shapes: the shapes of every body.
        constraints: those of every joint.
        restitution: per body; empty where it is left to the engine.
        friction: per body, likewise.
        sweeps: of the solver over all joints and contacts; ``None``: the engine's own number.
    """

    space: Any
    bodies: dict[str, Any] = field(default_factory=dict)
    shapes: dict[str, list[Any]] = field(default_factory=dict)
    constraints: dict[str, list[Any]] = field(default_factory=dict)
    restitution: Mapping[str, float] = field(default_factory=dict)
    friction: Mapping[str, float] = field(default_factory=dict)
    sweeps: int | None = None


def build(pymunk: Any, scene: Scene, joints: Mapping[str, PlanarJoint]) -> Space:
    """Builds all bodies and joints in a new space, with as much as the level gives."""
    built, is_tuned = Space(pymunk.Space()), scene.gives(TUNED)
    built.space.gravity = planar(scene.scenario.world.gravity_m_s2)
    own = {"collision_slop": SLOP_M, **dict(scene.settings.own)} if is_tuned else {}
    for name, value in own.items():
        setattr(built.space, name, value)
    built.restitution = scene.contacts.restitution_per_body("product", scene.engine)
    built.friction = scene.contacts.friction_per_body("product", scene.engine)
    for name in scene.scenario.bodies:
        _add_body(pymunk, built, scene, name)
    if scene.gives(COEFFICIENTS):
        for name, (category, mask) in scene.contacts.bits(scene.engine).items():
            for shape in built.shapes[name]:
                shape.filter = pymunk.ShapeFilter(categories=category, mask=mask)
    for name, joint in joints.items():
        parent, child = built.bodies[joint.parent], built.bodies[joint.child]
        built.constraints[name] = constraints_of(pymunk, joint, parent, child, exact=is_tuned)
        built.space.add(*built.constraints[name])
    if scene.variant:
        built.sweeps = VARIANTS[scene.variant].value
    elif is_tuned and joints:
        rows = [rows_of(constraint) for constraint in built.space.constraints]
        built.sweeps = sweeps_for(scene.engine, scene.scenario, built.bodies, rows)
    if built.sweeps is not None:
        built.space.iterations = built.sweeps
    return built


def _add_body(pymunk: Any, built: Space, scene: Scene, name: str) -> None:
    body = scene.scenario.bodies[name]
    if body.fixed:
        held = pymunk.Body(body_type=pymunk.Body.STATIC)
    else:
        held = pymunk.Body(body.mass_kg, scene.moments(name)[1])
    held.position = planar(body.position_m)
    held.angle = angle_of(body.orientation_wxyz)
    raised = 0.0 if scene.lands or not scene.gives(TUNED) else SLOP_M
    shapes = [_shape(pymunk, held, shape, raised) for shape in scene.shapes[name]]
    for shape in shapes if built.restitution else ():
        shape.elasticity, shape.friction = built.restitution[name], built.friction[name]
    built.bodies[name], built.shapes[name] = held, shapes
    built.space.add(held, *shapes)


def _shape(pymunk: Any, held: Any, shape: Shape, raised_m: float) -> Any:
    x, z = planar(shape.position_m)
    match shape.type:
        case "plane":
            nx, nz = planar(shape.normal)
            length = math.hypot(nx, nz)
            nx, nz = nx / length, nz / length
            # raised by the overlap that is allowed, what is drawn as touching is found to touch
            depth = BAR_RADIUS_M - raised_m
            cx, cz = x - nx * depth, z - nz * depth
            ends = [
                (cx + side * BAR_HALF_LENGTH_M * nz, cz - side * BAR_HALF_LENGTH_M * nx)
                for side in (-1, 1)
            ]
            return pymunk.Segment(held, *ends, BAR_RADIUS_M)
        case "sphere":
            return pymunk.Circle(held, shape.radius_m, (x, z))
        case _:
            assert shape.type == "box"
            if shape.orientation_wxyz[1] or shape.orientation_wxyz[3]:
                raise Unsupported("pymunk: a box is turned out of the plane")
            a, b = shape.size_m[0] / 2, shape.size_m[2] / 2
            turned = pymunk.Transform.identity().translated(x, z)
            turned = turned.rotated(angle_of(shape.orientation_wxyz))
            return pymunk.Poly(held, [(-a, -b), (a, -b), (a, b), (-a, b)], turned)
