"""Joints as constraints between two of Chipmunk's bodies, each of which has its own coordinates.

The plane is the scenario's x-z; angles grow from x towards z, which is a negative turn about y.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from simcompare.audit import Audit
from simcompare.drives import JointLaw
from simcompare.errors import Unsupported
from simcompare.kinematics import mount_of
from simcompare.scenario import Joint, Scenario
from simcompare.trajectory import Array

if TYPE_CHECKING:
    from pymunk import Body, Constraint

#: how far a slider goes to either side of its parent [m]
GROOVE_HALF_LENGTH_M = 1000.0
#: motion of a body, at once or recorded: x, z, their rates, angle and its rate
Motion = Sequence[Array | float]
Point = tuple[float, float]


class Linkage(ABC):
    """One joint: its constraints, its coordinate, and efforts on it.

    Args:
        engine: the imported engine.
        bodies: the engine's bodies, by name.
        scenario: the scene.
        name: the joint's name in it.
        law: what acts on it.
        exact: whether its constraints are placed where they are solved exactly, and hold exactly;
            else they are placed at the joint's anchor and are as soft as the engine's own.
    """

    def __init__(
        self,
        engine: ModuleType,
        bodies: Mapping[str, Body],
        scenario: Scenario,
        name: str,
        law: JointLaw,
        exact: bool,
    ) -> None:
        self.name, self.law = name, law
        self.joint = joint = scenario.joints[name]
        self.fixed_parent = scenario.bodies[joint.parent].fixed
        self.parent, self.child = bodies[joint.parent], bodies[joint.child]
        self.turned = self.child.angle - self.parent.angle
        self.anchor = _planar(joint.anchor_m)
        self.child_anchor = _planar(mount_of(scenario, joint).anchor_m)
        #: force and torque of the next step on either body; shared by all joints of that body
        self.parent_load, self.child_load = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        #: whether its effort depends on the joint's motion
        self.senses = bool(law.stiffness or law.damping)
        #: which way the child turns in the plane while its coordinate grows
        self.sign = -math.copysign(1.0, self.joint.axis[1])
        self.constraints: list[Constraint] = self._constraints(engine, exact)
        for constraint in self.constraints:
            constraint.collide_bodies = False
            if exact:
                # the drift is corrected within one step, so that it stays of second order
                constraint.error_bias = 0.0

    @abstractmethod
    def _constraints(self, engine: ModuleType, exact: bool) -> list[Constraint]:
        """The constraints that make the joint, in the order in which they are solved."""

    def motion(self, step_s: float) -> tuple[float, float]:
        """Coordinate now, and its mean rate until the positions are advanced.

        Zero where no effort depends on them.
        """
        raise NotImplementedError

    def push(self, effort: float) -> None:
        """Adds an effort on the child, and its reaction on the parent, to their loads."""
        raise NotImplementedError

    def recorded(self, parent: Motion, child: Motion) -> tuple[Array, Array]:
        """Coordinates and rates from recorded motion of both bodies."""
        raise NotImplementedError

    def angle_of_child(self, coordinate: float) -> float:
        """Angle of the child where the joint has this coordinate and the parent is as it is."""
        del coordinate
        return float(self.parent.angle + self.turned)

    def audit(self, audit: Audit) -> None:
        """Compares what the constraints hold with the scenario."""
        gear = self.constraints[-1]
        audit.add(f"{self.name}.turn", None, "GearJoint.phase", (self.turned, gear.phase), "rad")

    def _point(self, audit: Audit, parameter: str, wanted: Point, held: Point) -> None:
        for axis, a, b in zip("xz", wanted, held, strict=True):
            audit.add(f"{self.name}.{axis}", None, parameter, (a, b), "m")


class Hinge(Linkage):
    """A pivot; the coordinate is the angle between both bodies, over any number of turns."""

    def _constraints(self, engine: ModuleType, exact: bool) -> list[Constraint]:
        del exact
        found = [engine.PivotJoint(self.parent, self.child, self.anchor, self.child_anchor)]
        if self.law.friction:
            found.append(engine.SimpleMotor(self.parent, self.child, 0.0))
            found[-1].max_force = self.law.friction
        return found

    def motion(self, step_s: float) -> tuple[float, float]:
        del step_s
        if not self.senses:
            return 0.0, 0.0
        parent, child, sign = self.parent, self.child, self.sign
        turn, rate = child.angle - parent.angle - self.turned, child.angular_velocity
        return sign * turn, sign * (rate - parent.angular_velocity)

    def push(self, effort: float) -> None:
        torque = self.sign * effort
        self.child_load[2] += torque
        self.parent_load[2] -= torque

    def recorded(self, parent: Motion, child: Motion) -> tuple[Array, Array]:
        angle, rate = child[4] - parent[4] - self.turned, child[5] - parent[5]
        return np.asarray(self.sign * angle), np.asarray(self.sign * rate)

    def angle_of_child(self, coordinate: float) -> float:
        return float(self.parent.angle + self.turned + self.sign * coordinate)

    def audit(self, audit: Audit) -> None:
        pivot = self.constraints[0]
        self._point(audit, "PivotJoint.anchor_a", self.anchor, pivot.anchor_a)
        self._point(audit, "PivotJoint.anchor_b", self.child_anchor, pivot.anchor_b)
        if self.law.friction:
            values = (self.law.friction, self.constraints[1].max_force)
            audit.add(
                f"{self.name}.friction", self.law.friction, "SimpleMotor.max_force", values, "N·m"
            )


class Slider(Linkage):
    """A groove and a gear; the coordinate is the distance along an axis that the parent carries.

    A groove multiplies by a full mass matrix what it then projects on its normal. That is right
    only where the matrix is diagonal along and across the groove: where the groove passes through
    the centre of mass of the one body, and the point in it lies beside that of the other.
    """

    def _constraints(self, engine: ModuleType, exact: bool) -> list[Constraint]:
        x, z = _planar(self.joint.axis)
        if math.hypot(x, z) == 0:
            raise Unsupported(f"pymunk: {self.name} slides out of the plane")
        self._heading = math.atan2(z, x)
        self._along = along = _direction(self.parent.angle + self._heading)
        away = self.child.position - self.parent.position
        self._start = along[0] * away[0] + along[1] * away[1]
        self._zero = along[0] * self.child.position[0] + along[1] * self.child.position[1]
        #: distance of the child's centre from the axis through the parent's
        self._beside = along[0] * away[1] - along[1] * away[0]
        if self.law.armature:
            raise Unsupported(f"pymunk has no armature, and {self.name}, a slider, has one")
        found = [self._groove(engine, exact)]
        if self.law.friction:
            found.append(self._brake(engine))
        return [*found, engine.GearJoint(self.parent, self.child, self.turned, 1.0)]

    def _groove(self, engine: ModuleType, exact: bool) -> Constraint:
        carrier, other = self.parent, self.child
        if not exact:
            ends, point = _line(self.anchor, self._heading), self.child_anchor
        elif self.fixed_parent or carrier.moment >= other.moment:
            ends = _line((0.0, 0.0), self._heading)
            point = _across(self._heading - self.turned, -self._beside)
        else:  # the heavier to turn carries the groove: the solution converges faster
            carrier, other = other, carrier
            ends = _line((0.0, 0.0), self._heading - self.turned)
            point = _across(self._heading, self._beside)
        self._groove_points = (*ends, point)
        return engine.GrooveJoint(carrier, other, *self._groove_points)

    def is_at_its_end(self) -> bool:
        """Whether the groove ends here, beyond which it would hold the body."""
        away = self.child.position - self.parent.position
        return math.hypot(*away) > 0.999 * GROOVE_HALF_LENGTH_M

    def _brake(self, engine: ModuleType) -> Constraint:
        """Coulomb friction: a groove across the axis that gives way, and never pulls back."""
        beside = _across(self._heading - self.turned, -self._beside)
        ends = _line((0.0, 0.0), self._heading + math.pi / 2)
        brake = engine.GrooveJoint(self.parent, self.child, *ends, beside)
        brake.max_force, brake.max_bias = self.law.friction, 0.0
        return brake

    def motion(self, step_s: float) -> tuple[float, float]:
        parent, child = self.parent, self.child
        if self.fixed_parent:
            if not self.senses:
                return 0.0, 0.0
            (x, z), (cx, cz), (vx, vz) = self._along, child.position, child.velocity
            return x * cx + z * cz - self._zero, x * vx + z * vz
        (px, pz), (cx, cz), (vx, vz), (ux, uz) = (
            parent.position, child.position, child.velocity, parent.velocity
        )  # fmt: skip
        dx, dz, angle = cx - px, cz - pz, parent.angle + self._heading
        x, z = _direction(angle)
        # the axis as it will be when the force acts
        self._along = ahead_x, ahead_z = _direction(angle + step_s * parent.angular_velocity)
        turning = ((ahead_x - x) * dx + (ahead_z - z) * dz) / step_s
        rate = turning + ahead_x * (vx - ux) + ahead_z * (vz - uz)
        return x * dx + z * dz - self._start, rate

    def push(self, effort: float) -> None:
        x, z = self._along
        load, reaction = self.child_load, self.parent_load
        load[0] += effort * x
        load[1] += effort * z
        # both on one line, which passes through the child's centre and beside the parent's
        reaction[0] -= effort * x
        reaction[1] -= effort * z
        reaction[2] += effort * self._beside

    def recorded(self, parent: Motion, child: Motion) -> tuple[Array, Array]:
        dx, dz, vx, vz = (c - p for c, p in zip(child[:4], parent[:4], strict=True))
        angle = np.asarray(parent[4]) + self._heading
        x, z = np.cos(angle), np.sin(angle)
        rate = x * vx + z * vz + np.asarray(parent[5]) * (x * dz - z * dx)
        return np.asarray(x * dx + z * dz - self._start), np.asarray(rate)

    def audit(self, audit: Audit) -> None:
        super().audit(audit)
        groove, (first, second, point) = self.constraints[0], self._groove_points
        self._point(audit, "GrooveJoint.groove_a", first, groove.groove_a)
        self._point(audit, "GrooveJoint.groove_b", second, groove.groove_b)
        self._point(audit, "GrooveJoint.anchor_b", point, groove.anchor_b)
        if self.law.friction:
            values = (self.law.friction, self.constraints[1].max_force)
            audit.add(
                f"{self.name}.friction", self.law.friction, "GrooveJoint.max_force", values, "N",
                "a groove across the axis",
            )  # fmt: skip


class Weld(Linkage):
    """A pivot and a gear."""

    def _constraints(self, engine: ModuleType, exact: bool) -> list[Constraint]:
        self._points = self.anchor, self.child_anchor
        if exact:
            # between both centres, where pivot and gear do not disturb each other
            a, b = self.parent.moment, self.child.moment
            share = 1.0 if self.fixed_parent else a / (a + b)
            x, z = self.child.position - self.parent.position
            self._points = (
                _turned((share * x, share * z), -self.parent.angle),
                _turned(((share - 1) * x, (share - 1) * z), -self.child.angle),
            )
        return [
            engine.PivotJoint(self.parent, self.child, *self._points),
            engine.GearJoint(self.parent, self.child, self.turned, 1.0),
        ]

    def audit(self, audit: Audit) -> None:
        super().audit(audit)
        pivot = self.constraints[0]
        self._point(audit, "PivotJoint.anchor_a", self._points[0], pivot.anchor_a)
        self._point(audit, "PivotJoint.anchor_b", self._points[1], pivot.anchor_b)


#: what makes each type of joint
LINKAGES: Mapping[str, type[Linkage]] = {"hinge": Hinge, "slider": Slider, "fixed": Weld}


def armature_of(joints: Mapping[str, Joint], laws: Mapping[str, JointLaw], body: str) -> float:
    """Reflected inertia [kg·m²] of the hinge that carries a body."""
    carrying = (name for name, joint in joints.items() if joint.child == body)
    return sum(laws[n].armature for n in carrying if n in laws and joints[n].type == "hinge")


def _planar(vector: Sequence[float]) -> Point:
    return vector[0], vector[2]


def _direction(angle: float) -> Point:
    return math.cos(angle), math.sin(angle)


def _turned(vector: Point, angle: float) -> Point:
    (c, s), (x, z) = _direction(angle), vector
    return c * x - s * z, s * x + c * z


def _across(heading: float, distance: float) -> Point:
    """A point at a distance to the left of a line through the origin."""
    x, z = _direction(heading)
    return -distance * z, distance * x


def _line(middle: Point, heading: float) -> tuple[Point, Point]:
    x, z = _direction(heading)
    first, second = (
        (middle[0] + side * GROOVE_HALF_LENGTH_M * x, middle[1] + side * GROOVE_HALF_LENGTH_M * z)
        for side in (-1, 1)
    )
    return first, second
