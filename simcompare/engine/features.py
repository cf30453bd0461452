"""What a scenario needs of an engine, derived from its content, and what an engine can do."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from simcompare.engine.drives import laws_of
from simcompare.model.scenario import Body, Scenario


class Feature(enum.StrEnum):
    """What a scenario may need of an engine; the value is how it is shown to people."""

    SPATIAL = "motion out of the x-z plane"
    FREE_BODY = "free bodies"
    PLANE = "plane shapes"
    SPHERE = "sphere shapes"
    BOX = "box shapes"
    CYLINDER = "cylinder shapes"
    CAPSULE = "capsule shapes"
    RESTITUTION = "restitution"
    FRICTION = "Coulomb friction between bodies"
    DRAG = "quadratic air drag"
    HINGE = "hinge joints"
    SLIDER = "slider joints"
    FIXED_JOINT = "fixed joints"
    BALL_JOINT = "ball joints"
    EFFORT = "torques and forces on joints"
    JOINT_FRICTION = "Coulomb friction of joints"
    ARMATURE = "armature of joints"
    JOINT_LIMIT = "limits of joints"
    FORCE_SENSOR = "forces through joints"
    CONTACT_FORCE = "contact forces"
    RAYS = "rays of range sensors"


#: what an engine of free rigid bodies in space can do
SPATIAL_RIGID_BODIES = frozenset(
    {
        Feature.SPATIAL, Feature.FREE_BODY, Feature.PLANE, Feature.SPHERE, Feature.BOX,
        Feature.CYLINDER, Feature.CAPSULE, Feature.RESTITUTION, Feature.FRICTION, Feature.DRAG,
    }
)  # fmt: skip

#: what an engine of articulated bodies can do besides
JOINTS_AND_FORCES = frozenset(
    {
        Feature.HINGE, Feature.SLIDER, Feature.FIXED_JOINT, Feature.EFFORT, Feature.JOINT_FRICTION,
        Feature.ARMATURE, Feature.FORCE_SENSOR, Feature.CONTACT_FORCE,
    }
)  # fmt: skip


@dataclass(frozen=True)
class Needs:
    """What a scenario needs.

    Attributes:
        required: without these it cannot be run.
        optional: without these it runs, and what is measured with them is not there.
    """

    required: frozenset[Feature]
    optional: frozenset[Feature]


def needs(scenario: Scenario) -> Needs:
    """Features that a scenario needs, derived from its content.

    Sensors of forces and of ranges are optional: they only feed measures.
    """
    found = {Feature.FREE_BODY} if scenario.moving_bodies() else set()
    for body in scenario.bodies.values():
        found.update(Feature[shape.type.upper()] for shape in body.shapes)
        if body.drag is not None and body.drag.factor_kg_m > 0:
            found.add(Feature.DRAG)
    for contact in scenario.contacts:
        if contact.restitution > 0:
            found.add(Feature.RESTITUTION)
        if contact.friction > 0:
            found.add(Feature.FRICTION)
    joints = {"hinge": Feature.HINGE, "slider": Feature.SLIDER, "ball": Feature.BALL_JOINT}
    found.update(joints.get(joint.type, Feature.FIXED_JOINT) for joint in scenario.joints.values())
    for law in laws_of(scenario).values():
        traits = (
            (law.is_driven, Feature.EFFORT),
            (law.friction, Feature.JOINT_FRICTION),
            (law.armature, Feature.ARMATURE),
        )
        found.update(feature for present, feature in traits if present)
    if any(j.lower is not None or j.upper is not None for j in scenario.joints.values()):
        found.add(Feature.JOINT_LIMIT)
    if not is_planar(scenario):
        found.add(Feature.SPATIAL)
    # the other sensors follow from the motion, whoever recorded it
    kinds = {
        "force": Feature.FORCE_SENSOR, "contact_force": Feature.CONTACT_FORCE,
        "time_of_flight": Feature.RAYS,
    }  # fmt: skip
    read = {kinds[s.type] for s in scenario.sensors.values() if s.type in kinds}
    return Needs(frozenset(found), frozenset(read))


def is_planar(scenario: Scenario) -> bool:
    """Whether all motion stays in the x-z plane, so that a two-dimensional engine can run it."""
    joints = scenario.joints.values()
    return (
        scenario.world.gravity_m_s2[1] == 0
        and all(_body_is_planar(body) for body in scenario.bodies.values())
        # a hinge must turn about y, a slider must not move along it
        and all(j.axis[0] == j.axis[2] == 0 for j in joints if j.type == "hinge")
        and all(j.axis[1] == 0 for j in joints if j.type == "slider")
        and all(j.type != "ball" for j in joints)
    )


def _body_is_planar(body: Body) -> bool:
    _, turned_x, _, turned_z = body.orientation_wxyz
    rate_x, _, rate_z = body.rate_rad_s
    sideways = (body.position_m[1], body.velocity_m_s[1], body.center_of_mass_m[1])
    return not any((turned_x, turned_z, rate_x, rate_z, *sideways)) and all(
        shape.position_m[1] == 0
        and (shape.type != "plane" or shape.normal[1] == 0)
        and (shape.type != "box" or not any(shape.orientation_wxyz[1::2]))
        for shape in body.shapes
    )
