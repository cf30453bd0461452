"""Coordinates of joints between bodies in space that each have coordinates of their own.

All of it is plain numbers: a joint is looked at in every step, and numpy would take longer.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np

from simcompare.engine.scene import Scene, SceneJoint
from simcompare.engine.state import BodyState
from simcompare.engine.turns import Turned
from simcompare.model.rotations import matrix_of
from simcompare.model.scenario import Body
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import Array
from simcompare.model.vectors import cross, dot, minus, multiplied, plus, times, turned, x_turned_to


class Link(ABC):
    """One movable joint.

    Args:
        joint: as the scene has it.
        parent: the body that carries it.

    Attributes:
        name: the joint's name.
        parent: name of the body that carries it.
        child: name of the body that it carries.
        axis: unit axis in the child's frame.
        ground: motion of a parent that is fixed; ``None`` where it moves.
        turned: how far a hinge had turned when it was last looked at.
    """

    def __init__(self, joint: SceneJoint, parent: Body) -> None:
        self.name, self.parent, self.child = joint.name, joint.joint.parent, joint.joint.child
        self.axis: Vector = joint.mount.axis
        self._mounted = joint.mount.orientation_wxyz
        still = (0.0, 0.0, 0.0)
        placed = (parent.position_m, parent.orientation_wxyz)
        self.ground = BodyState(*placed, still, still) if parent.fixed else None
        self.turned = Turned(0.0, joint.joint.rate)

    @abstractmethod
    def look(self, parent: BodyState, child: BodyState, time_s: float) -> tuple[float, float]:
        """Coordinate and stored rate now.

        Args:
            parent: motion of the body that carries the joint.
            child: motion of the body that it carries.
            time_s: time on a clock that ``begin`` sets to 0.
        """

    def begin(self, coordinate: float, rate: float) -> None:
        """Begins anew from a coordinate, which tells how many turns were made."""
        self.turned = Turned(coordinate, rate)


class Hinge(Link):
    """A joint that turns, over any number of turns."""

    def look(self, parent: BodyState, child: BodyState, time_s: float) -> tuple[float, float]:
        """Angle and stored rate; the turn is the one that is closest to where it must be."""
        base = multiplied(parent.orientation_wxyz, self._mounted)
        (bw, bx, by, bz), (w, x, y, z) = base, child.orientation_wxyz
        a, b, c = self.axis
        # the relative rotation, of which only the part about the axis is wanted
        cosine = bw * w + bx * x + by * y + bz * z
        sine = (
            a * (bw * x - w * bx - (by * z - bz * y))
            + b * (bw * y - w * by - (bz * x - bx * z))
            + c * (bw * z - w * bz - (bx * y - by * x))
        )
        axis = turned(child.orientation_wxyz, self.axis)
        rate = dot(axis, minus(child.rate_rad_s, parent.rate_rad_s))
        self.turned = self.turned.later(2 * math.atan2(sine, cosine), rate, time_s)
        return self.turned.angle, rate


class Slider(Link):
    """A joint that shifts along an axis of its parent."""

    def __init__(self, joint: SceneJoint, parent: Body) -> None:
        super().__init__(joint, parent)
        self._parent_axis = times(1 / math.hypot(*joint.joint.axis), joint.joint.axis)
        self._start = dot(self._parent_axis, joint.mount.position_m)

    def look(self, parent: BodyState, child: BodyState, time_s: float) -> tuple[float, float]:
        """Distance from where it was drawn, and its rate as the parent turns below it."""
        del time_s
        axis = turned(parent.orientation_wxyz, self._parent_axis)
        away = minus(child.position_m, parent.position_m)
        moved = minus(child.velocity_m_s, parent.velocity_m_s)
        rate = dot(axis, minus(moved, cross(parent.rate_rad_s, away)))
        return dot(axis, away) - self._start, rate


def link_of(joint: SceneJoint, parent: Body) -> Link:
    """What reads a movable joint."""
    return (Hinge if joint.joint.type == "hinge" else Slider)(joint, parent)


def mobility(
    scene: Scene, joint: SceneJoint, parent: BodyState, child: BodyState
) -> tuple[Array, Array]:
    """How much impulses through a joint move its two bodies against each other.

    Args:
        scene: the scene.
        joint: one of its joints.
        parent: motion of the body that carries it.
        child: motion of the body that it carries.

    Returns:
        The axes (3, 3) of the joint's frame in the world's, of which the first is its own; and the
        matrix from impulses to changes of speed, first about those of them about which the child
        cannot turn, then along those along which it cannot shift.
    """
    mounted = multiplied(parent.orientation_wxyz, joint.mount.orientation_wxyz)
    axes = matrix_of(multiplied(mounted, x_turned_to(joint.mount.axis))).T
    turning, along = (axes[int(joint.joint.type == kind) :] for kind in ("hinge", "slider"))
    anchor = plus(child.position_m, turned(child.orientation_wxyz, joint.mount.anchor_m))
    first, count = len(turning), len(turning) + len(along)
    found = np.zeros((count, count))
    for name, state in ((joint.joint.parent, parent), (joint.joint.child, child)):
        mass = scene.scenario.bodies[name].mass_kg
        if mass is None:  # it is fixed
            continue
        levers = np.vstack((turning, np.cross(minus(anchor, state.position_m), along)))
        levers = levers @ matrix_of(state.orientation_wxyz)
        found += levers @ np.linalg.solve(scene.inertia(name), levers.T)
        found[first:, first:] += np.eye(len(along)) / mass
    return axes, found
