"""Collision shapes of PyBullet, and those that take the place of what it handles badly."""

from __future__ import annotations

import math

from simcompare.backends._pybullet_parts import Scene
from simcompare.helps import RIMS
from simcompare.pairs import touching_pairs
from simcompare.shapes import Cylinder, Plane, Quaternion, Vector

#: collision margin [m] of the shapes that PyBullet makes; it rounds the edges of cylinders
MARGIN_M = 1.0e-3
#: edges of the box that is a floor for boxes [m]
FLOOR_M = 1000.0


def shape_of(scene: Scene, body: str, origin: Vector) -> int:
    """Collision shape of a body whose origin is at ``origin`` in the link's frame; -1 for none."""
    engine, shapes = scene.engine, scene.scenario.bodies[body].shapes
    if not shapes:
        return -1
    shape = shapes[0]
    position = plus(origin, shape.position_m)
    if isinstance(shape, Cylinder) and has_rims(scene, body):
        return _rims(scene, shape, position)
    if _is_other_floor(scene, body) and isinstance(shape, Plane):
        return _floor(scene, shape, position)
    size: dict[str, object]
    match shape.type:
        case "plane":
            kind, size = engine.GEOM_PLANE, {"planeNormal": shape.normal}
        case "sphere":
            kind, size = engine.GEOM_SPHERE, {"radius": shape.radius_m}
        case "box":
            kind, size = engine.GEOM_BOX, {"halfExtents": [e / 2 for e in shape.size_m]}
        case "cylinder":
            kind, size = engine.GEOM_CYLINDER, _round(shape.radius_m, shape.length_m)
        case _:
            kind, size = engine.GEOM_CAPSULE, _round(shape.radius_m, shape.length_m)
    if shape.type != "plane":
        size["collisionFrameOrientation"] = xyzw(shape.orientation_wxyz)
    uid: int = engine.createCollisionShape(
        kind, collisionFramePosition=position, physicsClientId=scene.client, **size
    )
    return uid


def has_rims(scene: Scene, body: str) -> bool:
    """Whether a body's cylinder is built as its two rims.

    Bullet finds one point at a time of a cylinder on a plane, at an end that it picks by rounding,
    so a wheel would be driven now at its left edge and now at its right. Bullet's own cylinder has
    edges that are rounded by its margin; the two rings that make these edges touch a plane just
    where the whole cylinder does, and give a point each.
    """
    shapes = scene.scenario.bodies[body].shapes
    return (
        scene.settings.takes(RIMS)
        and bool(shapes)
        and isinstance(shapes[0], Cylinder)
        and min(shapes[0].radius_m, shapes[0].length_m / 2) > MARGIN_M
        and _kinds_on(scene, body) == {"plane"}
    )


def takes_other_shapes(scene: Scene) -> bool:
    """Whether any body is built of other shapes than its own."""
    return any(has_rims(scene, name) or _is_other_floor(scene, name) for name in scene.bodies)


def _is_other_floor(scene: Scene, body: str) -> bool:
    shapes = scene.scenario.bodies[body].shapes
    return bool(shapes) and isinstance(shapes[0], Plane) and is_floor_of_boxes(scene, body)


def is_floor_of_boxes(scene: Scene, body: str) -> bool:
    """Whether a body's plane is built as the upper side of a large box.

    Bullet finds the corners of a box on a plane in as many steps, on a box all of them at once.
    """
    return scene.settings.takes(RIMS) and _kinds_on(scene, body) == {"box"}


def _kinds_on(scene: Scene, body: str) -> set[str]:
    """Kinds of shape that can touch a body."""
    return {
        shape.type
        for contact in touching_pairs(scene.scenario)
        if body in contact.pair
        for other in set(contact.pair) - {body}
        for shape in scene.scenario.bodies[other].shapes
    }


def _floor(scene: Scene, shape: Plane, position: Vector) -> int:
    """A box whose upper side is in the plane."""
    x, y, z = (component / math.hypot(*shape.normal) for component in shape.normal)
    # half of a turn about what lies between the normal and z turns z into the normal
    between, half = (x, y, z + 1) if z > -1 else (1.0, 0.0, 0.0), FLOOR_M / 2
    uid: int = scene.engine.createCollisionShape(
        scene.engine.GEOM_BOX,
        halfExtents=(half, half, half),
        collisionFramePosition=minus(position, (x * half, y * half, z * half)),
        collisionFrameOrientation=(*(c / math.hypot(*between) for c in between), 0.0),
        physicsClientId=scene.client,
    )
    return uid


def _rims(scene: Scene, shape: Cylinder, position: Vector) -> int:
    """Two discs as thick as their margins on both sides: rings about the ends of the cylinder."""
    w, x, y, z = shape.orientation_wxyz
    axis = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    aside = shape.length_m / 2 - MARGIN_M
    uid: int = scene.engine.createCollisionShapeArray(
        shapeTypes=[scene.engine.GEOM_CYLINDER] * 2,
        radii=[shape.radius_m] * 2,
        lengths=[2 * MARGIN_M] * 2,
        collisionFramePositions=[
            plus(position, (side * axis[0], side * axis[1], side * axis[2]))
            for side in (-aside, aside)
        ],
        collisionFrameOrientations=[xyzw(shape.orientation_wxyz)] * 2,
        physicsClientId=scene.client,
    )
    return uid


def _round(radius_m: float, length_m: float) -> dict[str, object]:
    return {"radius": radius_m, "height": length_m}


def xyzw(orientation_wxyz: Quaternion) -> Quaternion:
    """A quaternion in PyBullet's order."""
    w, x, y, z = orientation_wxyz
    return x, y, z, w


def plus(one: Vector, other: Vector) -> Vector:
    """Sum of two vectors."""
    x, y, z = (a + b for a, b in zip(one, other, strict=True))
    return x, y, z


def minus(one: Vector, other: Vector) -> Vector:
    """Difference of two vectors."""
    x, y, z = (a - b for a, b in zip(one, other, strict=True))
    return x, y, z
