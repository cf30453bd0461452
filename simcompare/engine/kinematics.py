"""Where bodies on joints are, from the motion of the free ones and the joints' coordinates.

Engines in reduced coordinates hold only those, and compute the same chain themselves; taking it
here once for a whole recording is cheaper than asking for every body in every step.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.model.rotations import conjugate, cross, multiply, quaternions_of, rotate
from simcompare.model.scenario import MOVABLE, Body, Joint, Scenario
from simcompare.model.sensor import Sensor
from simcompare.model.shapes import Quaternion, Shape, Vector
from simcompare.model.trajectory import Array
from simcompare.model.vectors import multiplied, plus, times, turned


@dataclass(frozen=True)
class Mount:
    """How a child sits on its parent where the joint's coordinate is 0.

    Attributes:
        position_m: the child's origin in the parent's frame.
        orientation_wxyz: the child's orientation in the parent's frame.
        anchor_m: the joint's anchor in the child's frame.
        axis: the joint's unit axis in the child's frame.
    """

    position_m: Vector
    orientation_wxyz: Quaternion
    anchor_m: Vector
    axis: Vector


def mount_of(scenario: Scenario, joint: Joint) -> Mount:
    """How a joint's child is drawn relative to its parent."""
    parent, child = scenario.bodies[joint.parent], scenario.bodies[joint.child]
    return _mount(
        (parent.position_m, parent.orientation_wxyz),
        (child.position_m, child.orientation_wxyz),
        joint.anchor_m,
        joint.axis,
    )


Placed = tuple[Vector, Quaternion]


def seen_from(base: Placed, body: Placed) -> Placed:
    """Position and orientation of a body in another's frame."""
    back = conjugate(_row(base[1]))
    away = np.subtract(body[0], base[0])[None]
    w, x, y, z = multiply(back, _row(body[1]))[0].tolist()
    return vector_of(rotate(back, away)[0]), (w, x, y, z)


@functools.lru_cache(maxsize=256)
def _mount(parent: Placed, child: Placed, anchor_m: Vector, joint_axis: Vector) -> Mount:
    """The same from plain values; a controlled run asks for it in every step."""
    position, orientation = seen_from(parent, child)
    to_child = conjugate(_row(orientation))
    anchor = rotate(to_child, np.subtract(anchor_m, position)[None])[0]
    axis = rotate(to_child, _unit(joint_axis)[None])[0]
    return Mount(position, orientation, vector_of(anchor), vector_of(axis))


def in_order(scenario: Scenario) -> dict[str, Joint]:
    """All joints, each after the one that carries its parent."""
    waiting, placed = dict(scenario.joints), {}
    carried = {joint.child for joint in waiting.values()}
    while waiting:
        ready = {n: joint for n, joint in waiting.items() if joint.parent not in carried}
        placed.update(ready)
        for name, joint in ready.items():
            carried.remove(joint.child)
            del waiting[name]
    return placed


def trees(scenario: Scenario) -> dict[str, list[str]]:
    """Joints below each body that no joint carries, each after the one that carries its parent."""
    below: dict[str, list[str]] = {}
    for name, joint in scenario.joints.items():
        below.setdefault(joint.parent, []).append(name)

    def walk(body: str) -> list[str]:
        found = []
        for name in below.get(body, ()):
            found += [name, *walk(scenario.joints[name].child)]
        return found

    carried = {joint.child for joint in scenario.joints.values()}
    return {body: walk(body) for body in scenario.bodies if body not in carried}


def carriers(scenario: Scenario, body: str) -> set[str]:
    """A body and all those that carry it through joints."""
    above = {joint.child: joint.parent for joint in scenario.joints.values()}
    found = {body}
    while body in above:
        body = above[body]
        found.add(body)
    return found


def add_children(
    scenario: Scenario,
    signals: dict[str, Array],
    count: int,
    only: Collection[str] | None = None,
) -> None:
    """Adds the motion of every body on a joint whose motion is not among the signals.

    Args:
        scenario: the scene.
        signals: motions of bodies, and coordinates and rates of joints; is added to.
        count: number of samples.
        only: the bodies that are asked for, with all that carry them; ``None``: all.
    """
    if only is not None and not only:
        return
    for name, joint in in_order(scenario).items():
        if f"{joint.child}.position_m" in signals or (only is not None and joint.child not in only):
            continue
        above = _motion(signals, scenario.bodies[joint.parent], joint.parent, count)
        coordinate, rate = (
            signals[f"{name}.{part}"] if joint.type in MOVABLE else np.zeros(count)
            for part in MOVABLE.get(joint.type, ("", ""))
        )
        moved = _follow(mount_of(scenario, joint), joint, above, (coordinate, rate))
        for part, values in zip(_PARTS, moved, strict=True):
            signals[f"{joint.child}.{part}"] = values


_PARTS = ("position_m", "orientation_wxyz", "velocity_m_s", "rate_rad_s")
_Motion = tuple[Array, Array, Array, Array]


def _motion(signals: Mapping[str, Array], body: Body, name: str, count: int) -> _Motion:
    if body.fixed:
        position, orientation = body.position_m, body.orientation_wxyz
        still = np.zeros((count, 3))
        return np.tile(position, (count, 1)), np.tile(orientation, (count, 1)), still, still
    p, o, v, r = (signals[f"{name}.{part}"] for part in _PARTS)
    return p, o, v, r


def _follow(mount: Mount, joint: Joint, above: _Motion, moved: tuple[Array, Array]) -> _Motion:
    """Motion of a child from its parent's, and the joint's coordinate and rate."""
    position, orientation, velocity, rate = above
    coordinate, speed = (values[:, None] for values in moved)
    drawn = _unit(joint.axis)[None]
    axis = rotate(orientation, drawn)
    arm = np.subtract(mount.position_m, joint.anchor_m)[None]
    turned = orientation
    if joint.type == "hinge":
        turn = quaternions_of(coordinate * drawn)
        arm = rotate(turn, arm)
        turned = multiply(orientation, turn)
    from_anchor = rotate(orientation, arm)
    anchor = rotate(orientation, np.array([joint.anchor_m]))
    away = anchor + from_anchor
    own = np.zeros_like(position)
    spin = rate
    if joint.type == "hinge":
        own, spin = cross(axis * speed, from_anchor), rate + axis * speed
    elif joint.type == "slider":
        away, own = away + axis * coordinate, axis * speed
    child = multiply(turned, np.array([mount.orientation_wxyz]))
    return position + away, child, velocity + cross(rate, away) + own, spin


def placed_on(
    scenario: Scenario, sensor: Sensor, count: int, signals: Mapping[str, Array]
) -> tuple[Array, Array]:
    """World position (n, 3) and orientation (n, 4) of a sensor on a body."""
    assert sensor.body is not None
    body = scenario.bodies[sensor.body]
    if body.fixed:
        position, orientation = (
            np.tile(part, (count, 1)) for part in (body.position_m, body.orientation_wxyz)
        )
    else:
        position = signals[f"{sensor.body}.position_m"]
        orientation = signals[f"{sensor.body}.orientation_wxyz"]
    place = position + rotate(orientation, np.array([sensor.position_m]))
    return place, multiply(orientation, np.array([sensor.orientation_wxyz]))


def placed_shapes(body: Body, shapes: Sequence[Shape]) -> list[Shape]:
    """Shapes of a body: in its frame, or in the world's where it is fixed.

    Normals of planes have length 1.
    """
    place, turn = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    if body.fixed:
        place, turn = body.position_m, body.orientation_wxyz
    found = list[Shape]()
    for shape in shapes:
        moved: dict[str, object] = {"position_m": plus(place, turned(turn, shape.position_m))}
        if shape.type == "plane":
            moved["normal"] = turned(turn, times(1 / math.hypot(*shape.normal), shape.normal))
        else:
            moved["orientation_wxyz"] = multiplied(turn, shape.orientation_wxyz)
        found.append(shape.model_copy(update=moved))
    return found


def _unit(axis: Vector) -> Array:
    return np.asarray(axis, dtype=float) / float(np.linalg.norm(axis))


def _row(quaternion: Quaternion) -> Array:
    return np.asarray([quaternion], dtype=float)


def vector_of(values: Array) -> Vector:
    """Three numbers as a plain tuple."""
    x, y, z = values.tolist()
    return x, y, z
