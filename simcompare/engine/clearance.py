"""How far bodies are from what they may touch, as they are drawn."""

from __future__ import annotations

import math

from simcompare.engine.contacts import touching_pairs
from simcompare.model.rotations import matrix_of
from simcompare.model.scenario import Body, Scenario
from simcompare.model.shapes import Plane, Shape, Vector
from simcompare.model.trajectory import Array
from simcompare.model.vectors import dot

_AXES: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def starts_in_flight(scenario: Scenario) -> bool:
    """Whether no body can touch another within the first engine steps: all are clear of planes."""
    if scenario.joints:
        return False
    bodies = scenario.bodies
    for contact in touching_pairs(scenario):
        for mover, ground in (contact.pair, contact.pair[::-1]):
            if bodies[mover].fixed:
                continue
            planes = [shape for shape in bodies[ground].shapes if isinstance(shape, Plane)]
            if not bodies[ground].fixed or len(planes) < len(bodies[ground].shapes):
                return False
            if min(clearance_m(bodies[mover], bodies[ground], p) for p in planes) <= _first_path_m(
                scenario, bodies[mover]
            ):
                return False
    return True


def clearance_m(body: Body, ground: Body, plane: Plane) -> float:
    """Height of a body's lowest point above a plane at the start [m]."""
    base = matrix_of(ground.orientation_wxyz)
    normal = base @ plane.normal / math.hypot(*plane.normal)
    origin = base @ plane.position_m + ground.position_m
    turn = matrix_of(body.orientation_wxyz)
    heights = [
        normal @ (turn @ shape.position_m + body.position_m - origin)
        - reach_m(shape, matrix_of(shape.orientation_wxyz).T @ turn.T @ normal)
        for shape in body.shapes
        if not isinstance(shape, Plane)
    ]
    return float(min(heights))


def reach_m(shape: Shape, direction: Vector | Array) -> float:
    """How far a shape reaches from its centre, at most, in a direction of its own frame [m]."""
    x, y, z = (abs(float(component)) for component in direction)
    match shape.type:
        case "sphere":
            return shape.radius_m
        case "box":
            return dot((x, y, z), shape.size_m) / 2
        case "cylinder":
            return math.hypot(x, y) * shape.radius_m + z * shape.length_m / 2
        case "capsule":
            return shape.radius_m + z * shape.length_m / 2
        case _:
            return math.inf


def _first_path_m(scenario: Scenario, body: Body) -> float:
    """Longest way of any point of a body in the first two engine steps [m]."""
    time_s = 2 * scenario.world.engine_step_s
    size = max(
        math.hypot(*shape.position_m) + sum(reach_m(shape, axis) for axis in _AXES)
        for shape in body.shapes
    )
    speed = math.hypot(*body.velocity_m_s) + math.hypot(*body.rate_rad_s) * size
    return speed * time_s + math.hypot(*scenario.world.gravity_m_s2) * time_s**2
