"""A scene as Box2D's bodies, shapes and joints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from simcompare.kit import (
    COEFFICIENTS,
    TUNED,
    PlanarJoint,
    PlanarSlider,
    PlanarWeld,
    Scene,
    Shape,
    Unsupported,
    angle_of,
    direction,
    planar,
)

#: a plane is a box this long to either side and this thick [m]
PLANE_HALF_LENGTH_M, PLANE_THICKNESS_M = 100.0, 1.0
#: what a world is made with where everything is given: how hard overlapping bodies are pressed
#: apart [Hz], by default 30; and the speed to which all bodies are limited [m/s], by default 400
MADE_WITH = {"contact_hertz": 240.0, "maximum_linear_speed": 1e5}
#: what is set in it afterwards: slower impacts [m/s] would not bounce, and what rests would sleep
SET_AFTER = {"restitution_threshold": 0.0, "sleeping_enabled": False}
#: how stiff joints are there [Hz], as far as the substeps let them, and how much hinges and welds
#: are damped [1], by default 60 Hz and 2; and a spring that is none, as 0 would mean a rigid one
JOINT_HZ, HINGE_DAMPING, WELD_DAMPING, NO_SPRING_HZ = 500.0, 3.0, 40.0, 1e-9


def build(
    box2d: Any, scene: Scene, joints: dict[str, PlanarJoint], hertz: float
) -> tuple[Any, dict[str, Any], dict[str, list[Any]]]:
    """Builds all bodies and joints in a new world, with as much as the level gives.

    Args:
        box2d: the imported engine.
        scene: what is built.
        joints: all joints.
        hertz: stiffness of joints; 0 for the engine's own.

    Returns:
        The world, its bodies, and its joints, each with what brakes it as the last.
    """
    gravity, is_tuned = planar(scene.scenario.world.gravity_m_s2), scene.gives(TUNED)
    world = box2d.World(gravity=gravity, **(typed(scene, MADE_WITH) if is_tuned else {}))
    if not world.is_valid():
        raise Unsupported(f"{scene.engine} holds 128 worlds at most: close some simulations")
    for name, value in typed(scene, SET_AFTER).items() if is_tuned else ():
        setattr(world, name, value)
    surfaces = scene.contacts.surfaces("max", "root", scene.engine)
    bits = scene.contacts.bits(scene.engine, 64) if scene.gives(COEFFICIENTS) else {}
    bodies = {}
    for name in scene.scenario.bodies:
        definition = box2d.shape_def(material=box2d.surface_material(**surfaces[name]))
        if bits:
            definition.filter = box2d.make_filter(
                category_bits=bits[name][0], mask_bits=bits[name][1]
            )
        bodies[name] = _body(box2d, world, scene, name, definition)
    return world, bodies, {n: _joint(box2d, world, bodies, j, hertz) for n, j in joints.items()}


def typed(scene: Scene, values: Mapping[str, float]) -> dict[str, float]:
    """What is set of a world, some of it perhaps as somebody typed it in."""
    return {name: scene.settings.typed(name, value) for name, value in values.items()}


def rotation(box2d: Any, angle: float) -> Any:
    """A rotation; the engine's own cosine is wrong by up to a thousandth."""
    found = box2d.Rot()
    found.c, found.s = direction(angle)
    return found


def _body(box2d: Any, world: Any, scene: Scene, name: str, definition: Any) -> Any:
    body, kinds = scene.scenario.bodies[name], box2d.BodyType
    held = world.create_body(
        type=kinds.STATIC if body.fixed else kinds.DYNAMIC,
        position=planar(body.position_m),
        rotation=rotation(box2d, angle_of(body.orientation_wxyz)),
    )
    held.create_shapes(definition, [_shape(box2d, shape) for shape in scene.shapes[name]])
    if not body.fixed:  # else they would follow from the shapes
        inertia = box2d.MassData()
        inertia.mass, inertia.rotational_inertia = body.mass_kg, scene.moments(name)[1]
        held.mass_data = inertia
    return held


def _shape(box2d: Any, shape: Shape) -> Any:
    x, z = planar(shape.position_m)
    if shape.type == "sphere":
        return box2d.circle((x, z), shape.radius_m)
    if shape.type == "plane":
        (nx, nz), half = planar(shape.normal), PLANE_THICKNESS_M / 2
        below = half / math.hypot(nx, nz)
        # upside down: distances are taken from the first corner, which is to be on the surface
        turn, middle = rotation(box2d, math.atan2(nx, -nz)), (x - below * nx, z - below * nz)
        return box2d.box(PLANE_HALF_LENGTH_M, half, middle, turn)
    assert shape.type == "box"
    turn = rotation(box2d, angle_of(shape.orientation_wxyz))
    return box2d.box(shape.size_m[0] / 2, shape.size_m[2] / 2, (x, z), turn)


def _joint(
    box2d: Any, world: Any, bodies: dict[str, Any], joint: PlanarJoint, hertz: float
) -> list[Any]:
    """Makes a joint; its dry friction is a motor that stands still as long as it can.

    Only welds can be made stiffer than by default. Where that is asked for, a hinge is a weld
    without its angular spring.
    """
    pair, friction = (bodies[joint.parent], bodies[joint.child]), joint.law.friction
    place = {
        "local_anchor_a": joint.middle, "local_anchor_b": joint.child_middle,
        # by the engine's own arcus tangens, which is wrong by a ten-thousandth
        "reference_angle": box2d.relative_angle(pair[1].rotation, pair[0].rotation),
    }  # fmt: skip
    brake = {"enable_motor": bool(friction)}
    if isinstance(joint, PlanarSlider):
        along = {"local_axis_a": direction(joint.heading), "max_motor_force": friction}
        return [world.create_prismatic_joint(*pair, **place, **brake, **along)]
    if isinstance(joint, PlanarWeld):
        springs = {
            "linear_hertz": hertz, "linear_damping_ratio": WELD_DAMPING,
            "angular_hertz": hertz, "angular_damping_ratio": WELD_DAMPING,
        }  # fmt: skip
        return [world.create_weld_joint(*pair, **place, **springs)]
    if not hertz:
        return [world.create_revolute_joint(*pair, **place, **brake, max_motor_torque=friction)]
    springs = {
        "linear_hertz": hertz, "linear_damping_ratio": HINGE_DAMPING, "angular_hertz": NO_SPRING_HZ,
    }  # fmt: skip
    limits = {"max_torque": friction, "max_force": 0.0, "correction_factor": 0.0}
    brakes = [world.create_motor_joint(*pair, **limits)] if friction else []
    return [world.create_weld_joint(*pair, **place, **springs), *brakes]
