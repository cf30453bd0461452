"""What PyBullet holds of a scene after it was built, beside what was set."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from simcompare.audit import Audit
from simcompare.backends._pybullet_parts import Scene
from simcompare.backends._pybullet_scene import MOST_SPEED, SWEEPS, inertia_of, is_iterated
from simcompare.drives import laws_of
from simcompare.kinematics import mount_of
from simcompare.pairs import touching_pairs
from simcompare.shapes import Shape


def audit_of(scene: Scene) -> Audit:
    """Reads back all that has a getter, and lists what has none."""
    audit = Audit("pybullet")
    _audit_world(audit, scene)
    for name in scene.scenario.moving_bodies():
        _audit_body(audit, scene, name)
    for name in scene.scenario.joints:
        _audit_mount(audit, scene, name)
    for name in scene.scenario.movable_joints():
        _audit_law(audit, scene, name)
    _audit_contacts(audit, scene)
    return audit


def _audit_world(audit: Audit, scene: Scene) -> None:
    held = scene.engine.getPhysicsEngineParameters(scene.client)
    step = scene.scenario.world.engine_step_s
    audit.add("engine step_s", step, "fixedTimeStep", (step, held["fixedTimeStep"]), "s")
    for axis, wanted in zip("xyz", scene.scenario.world.gravity_m_s2, strict=True):
        parameter = f"gravityAcceleration{axis.upper()}"
        audit.add(f"gravity_m_s2.{axis}", wanted, parameter, (wanted, held[parameter]), "m/s²")
    if is_iterated(scene.scenario):
        put = SWEEPS if scene.settings.gives_all else None
        values = (put, held["numSolverIterations"])
        audit.add("solver", None, "numSolverIterations", values, "1")


def _audit_body(audit: Audit, scene: Scene, name: str) -> None:
    engine, client, body = scene.engine, scene.client, scene.scenario.bodies[name]
    uid, link = scene.bodies[name]
    info = engine.getDynamicsInfo(uid, link, client)
    audit.add(f"{name}.mass_kg", body.mass_kg, "mass", (body.mass_kg, info[0]), "kg")
    put = inertia_of(scene.scenario, name, laws_of(scene.scenario)) or ()
    for axis, wanted, value, got in zip("123", body.inertia_kg_m2 or (), put, info[2], strict=True):
        note = "" if value == wanted else "with the armature of its hinge"
        quantity = f"{name}.inertia_kg_m2.{axis}"
        audit.add(quantity, wanted, "localInertiaDiagonal", (value, got), "kg·m²", note)
    if name in scene.scenario.free_bodies():
        position = engine.getBasePositionAndOrientation(uid, client)[0]
        for axis, wanted, got in zip("xyz", body.position_m, position, strict=True):
            audit.add(f"{name}.position_m.{axis}", wanted, "basePosition", (wanted, got), "m")
    for shape in body.shapes:
        parts = engine.getCollisionShapeData(uid, link, client)
        if len(parts) > 1:
            _audit_rims(audit, name, shape, parts)
            continue
        held = parts[0][3]
        # cylinders and capsules: length first
        order = {"plane": [], "sphere": held[:1], "box": held}.get(shape.type, [held[1], held[0]])
        audit.add_sizes(name, shape, "getCollisionShapeData", order)


def _audit_rims(audit: Audit, name: str, shape: Shape, parts: Sequence[Sequence[Any]]) -> None:
    """A cylinder's two rims: how large they are, and how far the outer sides are apart."""
    first, second = parts
    length = first[3][0] / 2 + second[3][0] / 2 + math.dist(first[5], second[5])
    for radius in (first[3][1], second[3][1]):
        audit.add_sizes(name, shape, "getCollisionShapeData of two rims", (radius, length))


def _audit_mount(audit: Audit, scene: Scene, name: str) -> None:
    """Where the joint sits on its parent, and about or along which axis it moves."""
    joint, (uid, link) = scene.scenario.joints[name], scene.joints[name]
    info = scene.engine.getJointInfo(uid, link, scene.client)
    _add_vector(audit, f"{name}.anchor_m", joint.anchor_m, "parentFramePos", info[14])
    if name in scene.scenario.movable_joints():
        axis = mount_of(scene.scenario, joint).axis
        _add_vector(audit, f"{name}.axis", axis, "jointAxis, in the child's frame", info[13])


def _add_vector(
    audit: Audit, quantity: str, wanted: Sequence[float], parameter: str, held: Sequence[float]
) -> None:
    for axis, a, b in zip("xyz", wanted, held, strict=True):
        clean = a if abs(a - b) < 1e-12 else b  # rounding about 0 is no difference
        audit.add(f"{quantity}.{axis}", a, parameter, (a, clean), "")


def _audit_law(audit: Audit, scene: Scene, name: str) -> None:
    """What acts on a joint. Springs and dampers are efforts, which PyBullet does not remember."""
    law, (uid, link) = laws_of(scene.scenario)[name], scene.joints[name]
    for part, value in (("stiffness", law.stiffness), ("damping", law.damping)):
        if value:
            note = "an effort, given anew before each step"
            audit.add(f"{name}.{part}", value, "TORQUE_CONTROL", (value, None), "SI", note)
    if law.friction or scene.restitution:
        note = "the most that a motor towards rest gives; it has no getter"
        put = (law.friction, None)
        audit.add(f"{name}.friction", law.friction, "VELOCITY_CONTROL force", put, "SI", note)
    else:
        note = "the motor that PyBullet puts on every joint was left on; it has no getter"
        audit.add(f"{name}.friction", 0.0, "VELOCITY_CONTROL force", (None, None), "SI", note)
    held = scene.engine.getJointInfo(uid, link, scene.client)[6]
    values = (0.0 if scene.settings.gives_all else None, held)
    audit.add(f"{name}.jointDamping", None, "jointDamping", values, "SI", "damping is an effort")
    if law.armature:
        _audit_armature(audit, scene, name, law.armature)


def _audit_armature(audit: Audit, scene: Scene, name: str, armature: float) -> None:
    scenario, child = scene.scenario, scene.scenario.joints[name].child
    own = scenario.bodies[child].inertia_kg_m2 or ()
    put = inertia_of(scenario, child, laws_of(scenario)) or ()
    held = scene.engine.getDynamicsInfo(*scene.bodies[child], scene.client)[2]
    for wanted, value, got in zip(own, put, held, strict=True):
        if value != wanted:
            parameter = f"localInertiaDiagonal of {child}"
            note = "added to the child's moment; assisted gives the reaction to the parent"
            audit.add(f"{name}.armature", armature, parameter, (value, got), "kg·m²", note)


def _audit_contacts(audit: Audit, scene: Scene) -> None:
    for contact in touching_pairs(scene.scenario):
        for name in contact.pair:
            info = scene.engine.getDynamicsInfo(*scene.bodies[name], scene.client)
            note = "Bullet multiplies the two" if scene.restitution else "engine's default"
            pair = "-".join(contact.pair)
            values = (scene.restitution.get(name), info[5])
            quantity = f"{pair} restitution"
            parameter = f"restitution of {name}"
            audit.add(quantity, contact.restitution, parameter, values, "1", note)
            values = (scene.friction.get(name), info[1])
            parameter = f"lateralFriction of {name}"
            audit.add(f"{pair} friction", contact.friction, parameter, values, "1", note)
    given = dict(_NO_GETTER)
    if any(contact.restitution > 0 for contact in scene.scenario.contacts):
        given |= _NO_GETTER_BOUNCING
    for parameter, (value, default) in given.items():
        note = "PyBullet has no getter for it"
        put = value if scene.settings.gives_all else None
        if put is None:
            note += "; left at its default" + (f" of {default:g}" if default else "")
        audit.add(
            "contact",
            None,
            parameter,
            (put, None),
            "",
            note,
        )


#: what is set where everything is given and cannot be read back: value, and PyBullet's default
_NO_GETTER: dict[str, tuple[float, float | None]] = {
    "contactSlop": (0.0, 1e-5),
    "restitutionVelocityThreshold": (0.0, 0.2),
    "linearDamping": (0.0, 0.04),
    "angularDamping": (0.0, 0.04),
    "contactProcessingThreshold": (0.0, None),
    "maxJointVelocity": (MOST_SPEED, 100.0),
}
#: the same where something bounces
_NO_GETTER_BOUNCING: dict[str, tuple[float, float | None]] = {
    "erp": (0.0, 0.2),
    "contactERP": (0.0, 0.2),
}
