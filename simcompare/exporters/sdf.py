"""SDF: the whole world for Gazebo, with floor, gravity, step and contact.

Written so that readers of SDF 1.5 to 1.9 take the same out of it: no frames are named, a link's
pose is in its model's frame, a joint's pose in its child's and an axis in the joint's. Gazebo
Classic 11 and all of the newer Gazebo read 1.7; capsules came with 1.8. Sensors are there, but
Gazebo reads them only in a world that loads its sensor systems, and efforts need systems too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal
from xml.etree import ElementTree as ET

import numpy as np

from simcompare.engine.contacts import touching_pairs
from simcompare.engine.drives import JointLaw, laws_of
from simcompare.engine.kinematics import Mount, mount_of
from simcompare.engine.range_sensing import HALF_VIEW_RAD, REACH_M, rays_of
from simcompare.exporters import parts
from simcompare.exporters.parts import Twin, add, number, numbers
from simcompare.model.scenario import Body, Joint, Scenario
from simcompare.model.sensor import Sensor
from simcompare.model.shapes import Quaternion, Shape, Vector

#: SDF's own "no limit"; older readers want to see it
UNLIMITED = "1e16"
#: the part of an endless plane that is drawn [m]
PLANE_EDGE_M = 100.0
_KINDS = {"hinge": "revolute", "slider": "prismatic", "fixed": "fixed", "ball": "ball"}
#: our sensors as SDF's
_SENSORS = {
    "accelerometer": "imu", "gyroscope": "imu", "imu": "imu", "barometer": "air_pressure",
    "time_of_flight": "gpu_ray",
}  # fmt: skip
_HELD_SENSORS = (*_SENSORS, "force")
#: a camera, by which Gazebo casts rays, sees nothing nearer [m]
_NEAREST_M = 0.01
_NO_TURN = (1.0, 0.0, 0.0, 0.0)


def write(scenario: Scenario) -> Twin:
    """The world of a scenario as SDF.

    Raises:
        InputError: a name that SDF keeps to itself, or limits of a joint that cannot have any.
    """
    parts.refuse(scenario, "sdf", parts.joint_faults(scenario, ball=True, limits=True))
    parts.check_names(scenario, "sdf", ["world"])
    bodies = scenario.bodies.values()
    capsules = any(s.type == "capsule" for body in bodies for s in (*body.shapes, *body.visual))
    root = ET.Element("sdf", version="1.8" if capsules else "1.7")
    world = add(root, "world", name=scenario.name)
    _add_physics(world, scenario)
    surfaces = _Surfaces(scenario)
    for members in _models(scenario):
        _add_model(world, scenario, members, surfaces)
    left_out = tuple(_left_out(scenario, surfaces))
    text = parts.finish(root, scenario, "sdf", left_out)
    return Twin(
        scenario.name, "sdf", text, tuple(scenario.bodies), tuple(scenario.joints), left_out
    )


def _add_physics(world: ET.Element, scenario: Scenario) -> None:
    step = scenario.world.engine_step_s
    add(world, "gravity", numbers(scenario.world.gravity_m_s2))
    physics = add(world, "physics", name="physics", type="ode")
    add(physics, "max_step_size", number(step))
    add(physics, "real_time_factor", "1")
    add(physics, "real_time_update_rate", number(1 / step))
    sun = add(world, "light", name="sun", type="directional")  # without it Gazebo shows little
    _add_pose(sun, (0.0, 0.0, 10.0), _NO_TURN)
    add(sun, "direction", "-0.5 0.1 -0.9")


def _models(scenario: Scenario) -> Iterator[list[str]]:
    """Names of the bodies that joints hold together, their root first."""
    parents = {joint.child: joint.parent for joint in scenario.joints.values()}

    def root_of(name: str) -> str:
        while name in parents:
            name = parents[name]
        return name

    for root in scenario.bodies:
        if root not in parents:
            others = [name for name in parents if name != root and root_of(name) == root]
            yield [root, *others]


def _add_model(
    world: ET.Element, scenario: Scenario, members: list[str], surfaces: _Surfaces
) -> None:
    """A model, named after its root and placed where that is drawn."""
    root = members[0]
    base = scenario.bodies[root]
    joints = {n: joint for n, joint in scenario.joints.items() if joint.child in members}
    model = add(world, "model", name=root, canonical_link=root)
    if base.fixed and not joints:
        add(model, "static", "true")
    if surfaces.inside(members):
        add(model, "self_collide", "true")
    _add_pose(model, base.position_m, base.orientation_wxyz)
    for name in members:
        _add_link(model, scenario, (root, name), surfaces)
    if base.fixed and joints:
        taken = [*scenario.bodies, *scenario.joints]
        name = parts.free_name(f"world_to_{root}", taken)
        _add_ends(add(model, "joint", name=name, type="fixed"), "world", root)
    laws = laws_of(scenario)
    for name, joint in joints.items():
        element = _add_joint(model, name, joint, mount_of(scenario, joint))
        if joint.type in ("hinge", "slider"):
            _add_axis(element, joint, mount_of(scenario, joint), laws[name])
        for sensor_name, sensor in scenario.sensors.items():
            if sensor.type == "force" and sensor.joint == name:
                _add_sensor(element, scenario, sensor_name, sensor)


def _add_link(
    model: ET.Element, scenario: Scenario, names: tuple[str, str], surfaces: _Surfaces
) -> None:
    root, name = names
    base, body = scenario.bodies[root], scenario.bodies[name]
    link = add(model, "link", name=name)
    if name != root:
        _add_pose(link, *parts.seen_from(base, body))
    if not body.fixed:
        _add_inertial(link, body)
    for kind, shapes in (("visual", body.visual or body.shapes), ("collision", body.shapes)):
        for i, shape in enumerate(shapes):
            element = add(link, kind, name=f"{kind}_{i}")
            _add_shape(element, shape)
            if kind == "collision" and name in surfaces.friction:
                _add_surface(element, surfaces.friction[name], surfaces.restitution[name])
    for sensor_name, sensor in scenario.sensors.items():
        if sensor.type in _SENSORS and sensor.body == name and sensor.geometry != "rectilinear":
            _add_sensor(link, scenario, sensor_name, sensor)


def _add_inertial(link: ET.Element, body: Body) -> None:
    mass, moments = parts.inertia_of(body)
    inertial = add(link, "inertial")
    _add_pose(inertial, body.center_of_mass_m, _NO_TURN)
    add(inertial, "mass", number(mass))
    tensor = add(inertial, "inertia")
    for axes, moment in zip(("ixx", "iyy", "izz"), moments, strict=True):
        add(tensor, axes, number(moment))
    for axes in ("ixy", "ixz", "iyz"):
        add(tensor, axes, "0")


def _add_shape(element: ET.Element, shape: Shape) -> None:
    orientation = _NO_TURN if shape.type == "plane" else shape.orientation_wxyz
    _add_pose(element, shape.position_m, orientation)
    geometry = add(add(element, "geometry"), shape.type)
    match shape.type:
        case "plane":
            add(geometry, "normal", numbers(shape.normal))
            add(geometry, "size", numbers((PLANE_EDGE_M, PLANE_EDGE_M)))
        case "sphere":
            add(geometry, "radius", number(shape.radius_m))
        case "box":
            add(geometry, "size", numbers(shape.size_m))
        case _:
            add(geometry, "radius", number(shape.radius_m))
            add(geometry, "length", number(shape.length_m))


def _add_surface(collision: ET.Element, friction: float, restitution: float) -> None:
    surface = add(collision, "surface")
    coefficients = add(add(surface, "friction"), "ode")
    add(coefficients, "mu", number(friction))
    add(coefficients, "mu2", number(friction))
    bounce = add(surface, "bounce")
    add(bounce, "restitution_coefficient", number(restitution))
    add(bounce, "threshold", "0")  # the default of 1e5 m/s lets nothing bounce


def _add_joint(model: ET.Element, name: str, joint: Joint, mount: Mount) -> ET.Element:
    element = add(model, "joint", name=name, type=_KINDS[joint.type])
    _add_pose(element, mount.anchor_m, _NO_TURN)
    _add_ends(element, joint.parent, joint.child)
    return element


def _add_ends(joint: ET.Element, parent: str, child: str) -> None:
    add(joint, "parent", parent)
    add(joint, "child", child)


def _add_axis(element: ET.Element, joint: Joint, mount: Mount, law: JointLaw) -> None:
    axis = add(element, "axis")
    add(axis, "xyz", numbers(mount.axis))
    limit = add(axis, "limit")
    add(limit, "lower", f"-{UNLIMITED}" if joint.lower is None else number(joint.lower))
    add(limit, "upper", UNLIMITED if joint.upper is None else number(joint.upper))
    dynamics = add(axis, "dynamics")
    add(dynamics, "damping", number(law.damping))
    add(dynamics, "friction", number(law.friction))
    add(dynamics, "spring_reference", number(law.rest))
    add(dynamics, "spring_stiffness", number(law.stiffness))


def _add_sensor(parent: ET.Element, scenario: Scenario, name: str, sensor: Sensor) -> None:
    kind = _SENSORS.get(sensor.type, "force_torque")
    element = add(parent, "sensor", name=name, type=kind)
    if sensor.type == "force":
        reading = add(element, "force_torque")
        add(reading, "frame", "child")
        add(reading, "measure_direction", "parent_to_child")
    else:
        _add_pose(element, sensor.position_m, sensor.orientation_wxyz)
    if sensor.zones is not None:
        _add_scan(element, sensor, sensor.zones)
    add(element, "always_on", "true")
    add(element, "update_rate", number(1 / scenario.world.step_s))


def _add_scan(element: ET.Element, sensor: Sensor, zones: int) -> None:
    """Rays that are even in angle, one in the middle of each column and row."""
    ray = add(element, "ray")
    scan, far = add(ray, "scan"), HALF_VIEW_RAD * (1 - 1 / zones)
    for way in ("horizontal", "vertical"):
        line = add(scan, way)
        add(line, "samples", str(zones))
        add(line, "resolution", "1")
        add(line, "min_angle", number(-far))
        add(line, "max_angle", number(far))
    reach = add(ray, "range")
    add(reach, "min", number(_NEAREST_M))
    add(reach, "max", number(sensor.reach_m or REACH_M))


def _differences_of_rays(scenario: Scenario) -> Iterator[str]:
    """What rays that SDF can say are, beside those of range sensors."""
    for name, sensor in scenario.range_sensors().items():
        if sensor.geometry == "rectilinear":
            what = f"sensor {name}: time_of_flight of {sensor.body}"
            yield f"{what} with the geometry rectilinear; rays of SDF are even in angle"
            continue
        ours, _ = rays_of(sensor)
        # theirs rise about the axis from left to right after they turn
        turn, rise = np.arctan2(ours[:, 1], ours[:, 0]), np.arctan2(ours[:, 2], ours[:, 0])
        along = (np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise))
        off = np.arccos(np.clip(np.sum(ours * np.column_stack(along), axis=1), -1, 1)).max()
        yield (
            f"sensor {name}: its rays as those of a lidar, in the corners {math.degrees(off):.1f}°"
            " beside ours; it tells distances along the ray, from the right and from below, and"
            " sees what is drawn"
        )


def _add_pose(element: ET.Element, position: Vector, orientation: Quaternion) -> None:
    if parts.is_nothing(position, orientation):
        return
    add(element, "pose", numbers((*position, *parts.roll_pitch_yaw(orientation))))


def _left_out(scenario: Scenario, surfaces: _Surfaces) -> Iterator[str]:
    yield from surfaces.differences()
    yield from parts.armatures(scenario)
    yield from parts.drives(scenario)
    yield from parts.motion_at_start(scenario)
    yield from parts.drag(scenario)
    yield from _differences_of_rays(scenario)
    yield from parts.sensors(scenario, _HELD_SENSORS)


class _Surfaces:
    """Friction and restitution of each body, from which simulators make those of a pair.

    Gazebo takes the smaller friction of two bodies. For restitution its engines take the smaller
    one or the product. A moving body holds the largest value of its pairs and a fixed one 1: then
    both rules give what is asked for. Where that is not so, :meth:`differences` says it.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._pairs = touching_pairs(scenario)
        self._fixed = {name for name, body in scenario.bodies.items() if body.fixed}
        self.friction = self._per_body("friction")
        self.restitution = self._per_body("restitution")

    def inside(self, members: list[str]) -> bool:
        """Whether two of these bodies are to touch."""
        return any(set(contact.pair) <= set(members) for contact in self._pairs)

    def differences(self) -> Iterator[str]:
        """Pairs that get another value than the scenario's."""
        for contact in self._pairs:
            first, second = contact.pair
            for prop, values in (("friction", self.friction), ("restitution", self.restitution)):
                wanted = getattr(contact, prop)
                smaller = min(values[first], values[second])
                product = values[first] * values[second]
                if abs(smaller - wanted) > 1e-12 or abs(product - wanted) > 1e-12:
                    yield (
                        f"{prop} of {first} and {second} is {wanted:g}: the smaller value of the"
                        f" two bodies (Gazebo) is {smaller:g}, the product {product:g}"
                    )

    def _per_body(self, prop: Literal["friction", "restitution"]) -> dict[str, float]:
        largest: dict[str, float] = {}
        for contact in self._pairs:
            for name in contact.pair:
                largest[name] = max(largest.get(name, 0.0), getattr(contact, prop))
        for name in self._fixed & set(largest):
            pairs = [contact for contact in self._pairs if name in contact.pair]
            others = [sum(largest[n] for n in c.pair if n != name) for c in pairs]
            if others == [getattr(contact, prop) for contact in pairs]:
                largest[name] = max(1.0, largest[name])
        return largest
