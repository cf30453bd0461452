"""URDF: the moving mechanism alone, for simulators that bring their own floor and gravity.

What stands still and carries nothing (a floor, walls) is left out: whoever loads a robot into
CoppeliaSim, Gazebo or PyBullet puts it on a floor that is there. A fixed body that carries joints
is the base of the mechanism and is fixed to the link ``world``, as Gazebo and MoveIt know it. A
single free body is the root itself, so that every reader lets it move. Only more than one root
needs URDF's floating joint, which DART and ROS know, and PyBullet and Gazebo do not.

The frame of a URDF link is its joint's frame. Here it lies at the joint's anchor and is turned as
the body is, so inertia, shapes and axis keep the body's own axes.
"""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree as ET

from simcompare.engine.contacts import touching_pairs
from simcompare.engine.drives import JointLaw, laws_of
from simcompare.engine.kinematics import Mount, mount_of
from simcompare.exporters import parts
from simcompare.exporters.parts import Twin, add, number, numbers
from simcompare.model.scenario import Body, Joint, Scenario
from simcompare.model.shapes import Quaternion, Shape, Vector

WORLD = "world"
#: "no limit" where URDF demands one; small enough to be squared in single precision
UNLIMITED = "1e9"
#: the box that stands for a plane: edges along the plane and depth [m]
PLANE_EDGE_M, PLANE_DEPTH_M = 100.0, 1.0
_NO_TURN = (1.0, 0.0, 0.0, 0.0)


def write(scenario: Scenario) -> Twin:
    """The mechanism of a scenario as URDF.

    Raises:
        InputError: nothing moves, there is a ball joint, or a name that URDF keeps to itself.
    """
    kept = _kept(scenario)
    faults = parts.joint_faults(scenario, ball=False, limits=True)
    if not scenario.moving_bodies():
        faults.append("nothing in it moves, so there is no mechanism to write")
    parts.refuse(scenario, "urdf", faults)
    parts.check_names(scenario, "urdf", [WORLD])
    robot = ET.Element("robot", name=scenario.name)
    roots = _roots_on_world(scenario, kept)
    if roots:
        add(robot, "link", name=WORLD)
    mounts = {joint.child: mount_of(scenario, joint) for joint in scenario.joints.values()}
    for name, body in kept.items():
        origin = mounts[name].anchor_m if name in mounts else (0.0, 0.0, 0.0)
        _add_link(robot, name, body, origin)
    for name in roots:
        _add_root_joint(robot, scenario, name)
    laws = laws_of(scenario)
    for name, joint in scenario.joints.items():
        above = mounts[joint.parent].anchor_m if joint.parent in mounts else (0.0, 0.0, 0.0)
        place = parts.difference(joint.anchor_m, above)
        _add_joint(robot, (name, joint), (place, mounts[joint.child]), laws.get(name, JointLaw()))
    left_out = tuple(_left_out(scenario, kept))
    text = parts.finish(robot, scenario, "urdf", left_out)
    return Twin(scenario.name, "urdf", text, tuple(kept), tuple(scenario.joints), left_out)


def _kept(scenario: Scenario) -> dict[str, Body]:
    """Bodies that move, and fixed ones that carry them."""
    bases = {joint.parent for joint in scenario.joints.values()}
    return {n: body for n, body in scenario.bodies.items() if not body.fixed or n in bases}


def _roots_on_world(scenario: Scenario, kept: dict[str, Body]) -> list[str]:
    """Roots that hang on the link ``world``: all, or none if there is only one and it is free."""
    children = {joint.child for joint in scenario.joints.values()}
    roots = [name for name in kept if name not in children]
    return [] if len(roots) == 1 and not kept[roots[0]].fixed else roots


def _add_link(robot: ET.Element, name: str, body: Body, origin: Vector) -> None:
    """A link whose frame lies at ``origin`` in the body's frame and is turned like it."""
    link = add(robot, "link", name=name)
    mass, moments = parts.inertia_of(body)
    inertial = add(link, "inertial")
    _add_origin(inertial, parts.difference(body.center_of_mass_m, origin), _NO_TURN)
    add(inertial, "mass", value=number(mass))
    tensor = dict(zip(("ixx", "iyy", "izz"), map(number, moments), strict=True))
    add(inertial, "inertia", **tensor, ixy="0", ixz="0", iyz="0")
    for kind, shapes in (("visual", body.visual or body.shapes), ("collision", body.shapes)):
        for shape in shapes:
            for geometry, position, orientation in _geometries(shape):
                element = add(link, kind)
                _add_origin(element, parts.difference(position, origin), orientation)
                add(element, "geometry").append(geometry)


def _geometries(shape: Shape) -> Iterator[tuple[ET.Element, Vector, Quaternion]]:
    """URDF's shapes that make up one of ours, with their poses in the body's frame."""
    if shape.type == "plane":
        position, orientation = parts.pose_of_plane(shape)
        depth = parts.turned(orientation, (0.0, 0.0, PLANE_DEPTH_M / 2))
        size = numbers((PLANE_EDGE_M, PLANE_EDGE_M, PLANE_DEPTH_M))
        yield ET.Element("box", size=size), parts.difference(position, depth), orientation
        return
    pose = shape.position_m, shape.orientation_wxyz
    match shape.type:
        case "sphere":
            yield ET.Element("sphere", radius=number(shape.radius_m)), *pose
        case "box":
            yield ET.Element("box", size=numbers(shape.size_m)), *pose
        case _:
            radius, length = number(shape.radius_m), number(shape.length_m)
            yield ET.Element("cylinder", radius=radius, length=length), *pose
    if shape.type == "capsule":  # no such shape in the standard, but these three are one
        for half in (-shape.length_m / 2, shape.length_m / 2):
            end = parts.turned(shape.orientation_wxyz, (0.0, 0.0, -half))
            at = parts.difference(shape.position_m, end)
            yield ET.Element("sphere", radius=radius), at, shape.orientation_wxyz


def _add_root_joint(robot: ET.Element, scenario: Scenario, name: str) -> None:
    """Holds a fixed body in the world, or lets a free one start where it is drawn."""
    body = scenario.bodies[name]
    called = parts.free_name(f"{WORLD}_to_{name}", scenario.joints)
    kind = "fixed" if body.fixed else "floating"
    joint = add(robot, "joint", name=called, type=kind)
    _add_ends(joint, WORLD, name)
    _add_origin(joint, body.position_m, body.orientation_wxyz)


def _add_joint(
    robot: ET.Element, named: tuple[str, Joint], at: tuple[Vector, Mount], law: JointLaw
) -> None:
    """A joint at a place in its parent's link frame."""
    name, joint = named
    place, mount = at
    limited = joint.lower is not None or joint.upper is not None
    kind = {"hinge": "revolute" if limited else "continuous", "slider": "prismatic"}
    element = add(robot, "joint", name=name, type=kind.get(joint.type, "fixed"))
    _add_ends(element, joint.parent, joint.child)
    _add_origin(element, place, mount.orientation_wxyz)
    if joint.type == "fixed":
        return
    add(element, "axis", xyz=numbers(mount.axis))
    if limited or joint.type == "slider":
        lower = f"-{UNLIMITED}" if joint.lower is None else number(joint.lower)
        upper = UNLIMITED if joint.upper is None else number(joint.upper)
        add(element, "limit", lower=lower, upper=upper, effort=UNLIMITED, velocity=UNLIMITED)
    add(element, "dynamics", damping=number(law.damping), friction=number(law.friction))


def _add_ends(joint: ET.Element, parent: str, child: str) -> None:
    add(joint, "parent", link=parent)
    add(joint, "child", link=child)


def _add_origin(element: ET.Element, position: Vector, orientation: Quaternion) -> None:
    if parts.is_nothing(position, orientation):
        return
    turn = numbers(parts.roll_pitch_yaw(orientation))
    add(element, "origin", xyz=numbers(position), rpy=turn)


def _left_out(scenario: Scenario, kept: dict[str, Body]) -> Iterator[str]:
    roots = _roots_on_world(scenario, kept)
    yield from _about_roots(scenario, kept, roots)
    for name, body in kept.items():
        if any(shape.type == "plane" for shape in body.shapes):
            yield f"plane of {name}: a box of {PLANE_EDGE_M:g} m by {PLANE_EDGE_M:g} m instead"
    yield (
        f"the world: gravity {parts.short(scenario.world.gravity_m_s2)} m/s²,"
        f" steps of {scenario.world.engine_step_s:g} s"
    )
    for name, joint in scenario.movable_joints().items():
        if joint.stiffness:
            unit = "N·m/rad" if joint.type == "hinge" else "N/m"
            yield f"spring of the joint {name}: {joint.stiffness:g} {unit} about {joint.rest:g}"
    yield from parts.armatures(scenario)
    yield from parts.drives(scenario)
    yield from map(parts.contact_sentence, touching_pairs(scenario))
    yield from parts.motion_at_start(scenario)
    yield from parts.drag(scenario)
    yield from parts.sensors(scenario)


def _about_roots(scenario: Scenario, kept: dict[str, Body], roots: list[str]) -> Iterator[str]:
    for name in scenario.bodies:
        if name not in kept:
            yield f"{name}: stands still and carries nothing; use the simulator's own"
    children = {joint.child for joint in scenario.joints.values()}
    for name, body in kept.items():
        if name in children or body.fixed:
            continue
        if name in roots:
            yield f"floating joint of {name}: PyBullet takes it for fixed, Gazebo refuses it"
        else:
            yield (
                f"place of {name} at the start: {parts.short(body.position_m)} m,"
                f" orientation (w x y z) {parts.short(body.orientation_wxyz)}"
            )
