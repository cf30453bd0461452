"""Joints as constraints between two of Chipmunk's bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from simcompare.kit import PlanarHinge, PlanarJoint, PlanarSlider, Point, Row, direction, row_of

#: how far a slider goes to either side of its parent [m]
GROOVE_HALF_LENGTH_M = 1000.0


def constraints_of(
    pymunk: Any, joint: PlanarJoint, parent: Any, child: Any, *, exact: bool
) -> list[Any]:
    """The constraints that make a joint, in the order in which they are solved.

    Args:
        pymunk: the imported engine.
        joint: the joint.
        parent: Chipmunk's body that carries it.
        child: the body that it carries.
        exact: whether they are placed where they are solved exactly, and hold exactly; else they
            are placed at the joint's anchor and are as soft as the engine's own.
    """
    if isinstance(joint, PlanarSlider):
        found = _slider(pymunk, joint, parent, child, exact)
    elif isinstance(joint, PlanarHinge):
        found = [pymunk.PivotJoint(parent, child, joint.anchor, joint.child_anchor)]
        if joint.law.friction:
            found.append(pymunk.SimpleMotor(parent, child, 0.0))
            found[-1].max_force = joint.law.friction
    else:
        drawn, solved = (joint.anchor, joint.child_anchor), (joint.middle, joint.child_middle)
        points = solved if exact else drawn
        found = [
            pymunk.PivotJoint(parent, child, *points),
            pymunk.GearJoint(parent, child, joint.turned, 1.0),
        ]
    for constraint in found:
        constraint.collide_bodies = False
        if exact:
            # the drift is corrected within one step, so that it stays of second order
            constraint.error_bias = 0.0
    return found


def _slider(pymunk: Any, joint: PlanarSlider, parent: Any, child: Any, exact: bool) -> list[Any]:
    """A groove and a gear.

    A groove multiplies by a full mass matrix what it then projects on its normal. That is right
    only where the matrix is diagonal along and across the groove: where the groove passes through
    the centre of mass of the one body, and the point in it lies beside that of the other.
    """
    carrier, other, beside = parent, child, joint.beside
    if not exact:
        ends, point = _line(joint.anchor, joint.heading), joint.child_anchor
    elif joint.is_fixed or carrier.moment >= other.moment:
        ends = _line((0.0, 0.0), joint.heading)
        point = _across(joint.heading - joint.turned, -beside)
    else:  # the heavier to turn carries the groove: the solution converges faster
        carrier, other = child, parent
        ends = _line((0.0, 0.0), joint.heading - joint.turned)
        point = _across(joint.heading, beside)
    found = [pymunk.GrooveJoint(carrier, other, *ends, point)]
    if joint.law.friction:
        # a groove across the axis that gives way, and never pulls back
        across = _line((0.0, 0.0), joint.heading + math.pi / 2)
        point = _across(joint.heading - joint.turned, -beside)
        found.append(pymunk.GrooveJoint(parent, child, *across, point))
        found[-1].max_force, found[-1].max_bias = joint.law.friction, 0.0
    return [*found, pymunk.GearJoint(parent, child, joint.turned, 1.0)]


def rows_of(constraint: Any) -> list[Row]:
    """Velocities that a constraint lets vanish."""
    a, b, kind = constraint.a, constraint.b, type(constraint).__name__
    if kind == "PivotJoint":
        point = b.local_to_world(constraint.anchor_b)
        return [row_of(a, b, point, along) for along in ((1.0, 0.0), (0.0, 1.0))]
    if kind == "GrooveJoint":
        along = (constraint.groove_b - constraint.groove_a).normalized()
        across = along.perpendicular().rotated(a.angle)
        return [row_of(a, b, b.local_to_world(constraint.anchor_b), across)]
    return [[(a, 0.0, 0.0, -1.0), (b, 0.0, 0.0, 1.0)]]  # gears and motors


def is_at_its_end(parent: Sequence[float], child: Sequence[float]) -> bool:
    """Whether the groove of a slider ends here, beyond which it would hold the body."""
    return math.hypot(child[0] - parent[0], child[1] - parent[1]) > 0.999 * GROOVE_HALF_LENGTH_M


def _across(heading: float, distance: float) -> Point:
    """A point at a distance to the left of a line through the origin."""
    x, z = direction(heading)
    return -distance * z, distance * x


def _line(middle: Point, heading: float) -> tuple[Point, Point]:
    x, z = direction(heading)
    first, second = (
        (middle[0] + side * GROOVE_HALF_LENGTH_M * x, middle[1] + side * GROOVE_HALF_LENGTH_M * z)
        for side in (-1, 1)
    )
    return first, second
