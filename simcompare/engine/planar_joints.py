"""Joints between bodies that each have coordinates of their own, in the x-z plane.

Angles grow from x towards z, which is a negative turn about y.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence

import numpy as np

from simcompare.engine.scene import Scene, SceneJoint
from simcompare.model.scenario import Body
from simcompare.model.trajectory import Array

#: motion of a body: x, z, their rates, angle and its rate
PlanarMotion = tuple[float, float, float, float, float, float]
#: the same, at once or recorded
Recorded = Sequence[Array | float]
Point = tuple[float, float]


class PlanarJoint(ABC):
    """One joint: its coordinate, and efforts on it.

    Args:
        scene: what it is a part of.
        joint: the joint.
        read: gives the motion of a body now.

    Attributes:
        name: its name.
        is_fixed: whether its parent is fixed to the world.
        turned: angle of the child less that of the parent, as they are drawn.
        anchor: its place in the parent's frame; ``child_anchor`` in the child's.
        middle: a place where it can be solved as well; of a weld one where forces do not turn the
            bodies against each other, so that a solver finds force and torque one after the other;
            in the parent's frame, ``child_middle`` in the child's.
        law: all that acts on it.
        parent: body that carries it; ``child`` the one that it carries.
        sign: which way the child turns in the plane while the coordinate grows.
        senses: whether its effort depends on its motion.
    """

    def __init__(
        self, scene: Scene, joint: SceneJoint, read: Callable[[str], PlanarMotion]
    ) -> None:
        bodies, self.name, self.law = scene.scenario.bodies, joint.name, joint.law
        self.parent, self.child, self.read = joint.joint.parent, joint.joint.child, read
        parent, child = bodies[self.parent], bodies[self.child]
        self.is_fixed = parent.fixed
        self.turned = angle_of(child.orientation_wxyz) - angle_of(parent.orientation_wxyz)
        self.anchor = planar(joint.joint.anchor_m)
        self.child_anchor = planar(joint.mount.anchor_m)
        self.middle, self.child_middle = self.anchor, self.child_anchor
        self.sign = -math.copysign(1.0, joint.joint.axis[1])
        self.senses = bool(joint.given.stiffness or joint.given.damping)
        self._draw(scene, joint, parent, child)

    def _draw(self, scene: Scene, joint: SceneJoint, parent: Body, child: Body) -> None:
        """Takes what it needs of how both bodies are drawn."""
        return

    @abstractmethod
    def motion(self, ahead_s: float) -> tuple[float, float]:
        """Coordinate now, and its mean rate until forces act, in a time; 0 where unneeded."""

    @abstractmethod
    def loads(self, effort: float, ahead_s: float) -> dict[str, tuple[float, float, float]]:
        """Force along x and z, and torque, that an effort puts on each of both bodies in a time."""

    @abstractmethod
    def recorded(self, parent: Recorded, child: Recorded) -> tuple[Array, Array]:
        """Coordinates and rates from recorded motion of both bodies."""

    def angle_of_child(self, coordinate: float) -> float:
        """Angle of the child where the joint has this coordinate and the parent is as it is."""
        del coordinate
        return self.read(self.parent)[4] + self.turned


class PlanarHinge(PlanarJoint):
    """The coordinate is the angle between both bodies, over any number of turns."""

    def motion(self, ahead_s: float) -> tuple[float, float]:
        del ahead_s
        if not self.senses:
            return 0.0, 0.0
        *_, angle, rate = self.read(self.child)
        *_, base, spin = self.read(self.parent)
        return self.sign * (angle - base - self.turned), self.sign * (rate - spin)

    def loads(self, effort: float, ahead_s: float) -> dict[str, tuple[float, float, float]]:
        torque = self.sign * effort
        return {self.child: (0.0, 0.0, torque), self.parent: (0.0, 0.0, -torque)}

    def recorded(self, parent: Recorded, child: Recorded) -> tuple[Array, Array]:
        angle, rate = child[4] - parent[4] - self.turned, child[5] - parent[5]
        return np.asarray(self.sign * angle), np.asarray(self.sign * rate)

    def angle_of_child(self, coordinate: float) -> float:
        return self.read(self.parent)[4] + self.turned + self.sign * coordinate


class PlanarSlider(PlanarJoint):
    """The coordinate is the distance along an axis that the parent carries.

    Attributes:
        heading: angle of the axis in the parent's frame.
        beside: distance of the child's centre from the axis through the parent's.
    """

    def _draw(self, scene: Scene, joint: SceneJoint, parent: Body, child: Body) -> None:
        x, z = planar(joint.joint.axis)
        self.heading = math.atan2(z, x)
        self._along = along = direction(angle_of(parent.orientation_wxyz) + self.heading)
        place, base = planar(child.position_m), planar(parent.position_m)
        away = place[0] - base[0], place[1] - base[1]
        self.start = along[0] * away[0] + along[1] * away[1]
        self._zero = along[0] * place[0] + along[1] * place[1]
        self.beside = along[0] * away[1] - along[1] * away[0]

    def motion(self, ahead_s: float) -> tuple[float, float]:
        if not self.senses:
            return 0.0, 0.0
        cx, cz, vx, vz, _, _ = self.read(self.child)
        if self.is_fixed:
            x, z = self._along
            return x * cx + z * cz - self._zero, x * vx + z * vz
        px, pz, ux, uz, angle, spin = self.read(self.parent)
        dx, dz = cx - px, cz - pz
        x, z = direction(angle + self.heading)
        ahead_x, ahead_z = direction(angle + self.heading + ahead_s * spin)
        moved = (ahead_x - x) * dx + (ahead_z - z) * dz
        turning = moved / ahead_s if ahead_s else spin * (x * dz - z * dx)
        rate = turning + ahead_x * (vx - ux) + ahead_z * (vz - uz)
        return x * dx + z * dz - self.start, rate

    def loads(self, effort: float, ahead_s: float) -> dict[str, tuple[float, float, float]]:
        if not self.is_fixed:  # the axis as it will be when the force acts
            *_, angle, spin = self.read(self.parent)
            self._along = direction(angle + self.heading + ahead_s * spin)
        x, z = self._along
        # both on one line, which passes through the child's centre and beside the parent's
        return {
            self.child: (effort * x, effort * z, 0.0),
            self.parent: (-(effort * x), -(effort * z), effort * self.beside),
        }

    def recorded(self, parent: Recorded, child: Recorded) -> tuple[Array, Array]:
        dx, dz, vx, vz = (c - p for c, p in zip(child[:4], parent[:4], strict=True))
        angle = np.asarray(parent[4]) + self.heading
        x, z = np.cos(angle), np.sin(angle)
        rate = x * vx + z * vz + np.asarray(parent[5]) * (x * dz - z * dx)
        return np.asarray(x * dx + z * dz - self.start), np.asarray(rate)


class PlanarWeld(PlanarJoint):
    """A joint without a coordinate."""

    def _draw(self, scene: Scene, joint: SceneJoint, parent: Body, child: Body) -> None:
        (x, z), (base_x, base_z) = planar(child.position_m), planar(parent.position_m)
        away, share = (x - base_x, z - base_z), 1.0
        if not self.is_fixed:
            inertia, other = scene.moments(self.parent)[1], scene.moments(self.child)[1]
            share = inertia / (inertia + other)
        angle, base = angle_of(child.orientation_wxyz), angle_of(parent.orientation_wxyz)
        self.middle = turned_by((share * away[0], share * away[1]), -base)
        self.child_middle = turned_by(((share - 1) * away[0], (share - 1) * away[1]), -angle)

    def motion(self, ahead_s: float) -> tuple[float, float]:
        raise NotImplementedError

    def loads(self, effort: float, ahead_s: float) -> dict[str, tuple[float, float, float]]:
        raise NotImplementedError

    def recorded(self, parent: Recorded, child: Recorded) -> tuple[Array, Array]:
        raise NotImplementedError


KINDS: dict[str, type[PlanarJoint]] = {
    "hinge": PlanarHinge, "slider": PlanarSlider, "fixed": PlanarWeld,
}  # fmt: skip


def angle_of(orientation_wxyz: Sequence[float]) -> float:
    """Angle in the plane of a turn about y; from x towards z is positive here."""
    return -2 * math.atan2(orientation_wxyz[2], orientation_wxyz[0])


def planar(vector: Sequence[float]) -> Point:
    """What a vector has in the plane."""
    return vector[0], vector[2]


def direction(angle: float) -> Point:
    """Unit vector at an angle."""
    return math.cos(angle), math.sin(angle)


def turned_by(vector: Point, angle: float) -> Point:
    """A vector turned by an angle."""
    (c, s), (x, z) = direction(angle), vector
    return c * x - s * z, s * x + c * z
