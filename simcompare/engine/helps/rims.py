"""Other collision shapes in place of those that an engine handles badly.

Where an engine finds one point at a time of a cylinder on a plane, at an end that it picks by
rounding, a wheel would be driven now at its left edge and now at its right. Two thin discs with
rounded edges touch a plane just where the whole cylinder does, and give a point each. Where it
finds the corners of a box on a plane one in each step, a box that lands flat turns; on a large box
in place of the plane it finds all of them at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from simcompare.engine.contacts import touching_pairs
from simcompare.model.scenario import Scenario
from simcompare.model.shapes import Box, Cylinder, Plane, Shape
from simcompare.model.vectors import plus


@dataclass(frozen=True)
class Rims:
    """What is built in place of what.

    Attributes:
        margin_m: by which the engine rounds the edges of a cylinder; discs are twice as thick.
        floor_m: edges of the box that is a floor for boxes.
        softness: constraint force mixing of contacts where there are rims, in steps over the mass
            of all bodies, so that the two rims of a wheel share its load evenly, which else the
            order would decide in which they are found.
    """

    margin_m: float = 1.0e-3
    floor_m: float = 1000.0
    softness: float = 0.05


def other_shapes(scenario: Scenario, rims: Rims | None) -> dict[str, tuple[Shape, ...]]:
    """Shapes of every body that is built of others than its own."""
    found: dict[str, tuple[Shape, ...]] = {}
    for name, body in scenario.bodies.items() if rims is not None else ():
        assert rims is not None
        first, kinds = next(iter(body.shapes), None), _kinds_on(scenario, name)
        if isinstance(first, Cylinder) and kinds == {"plane"}:
            if min(first.radius_m, first.length_m / 2) > rims.margin_m:
                found[name] = _discs(first, rims.margin_m)
        elif isinstance(first, Plane) and kinds == {"box"}:
            found[name] = (_floor(first, rims.floor_m),)
    return found


def softness_of(scenario: Scenario, rims: Rims | None) -> float:
    """Constraint force mixing of all contacts, 0 where no cylinder is built as rims.

    A contact that carries the weight of all bodies sinks by about g·dt² for it.
    """
    moving = scenario.moving_bodies()
    if rims is None or not set(other_shapes(scenario, rims)) & set(moving):
        return 0.0
    mass = sum(body.mass_kg or 0.0 for body in moving.values())
    return rims.softness * scenario.world.engine_step_s / mass


def _kinds_on(scenario: Scenario, body: str) -> set[str]:
    """Kinds of shape that can touch a body."""
    return {
        shape.type
        for contact in touching_pairs(scenario)
        if body in contact.pair
        for other in set(contact.pair) - {body}
        for shape in scenario.bodies[other].shapes
    }


def _discs(shape: Cylinder, margin_m: float) -> tuple[Cylinder, Cylinder]:
    """Two discs as thick as their margins on both sides: rings about the ends of the cylinder."""
    w, x, y, z = shape.orientation_wxyz
    axis = (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))
    aside = shape.length_m / 2 - margin_m
    first, second = (
        shape.model_copy(
            update={
                "length_m": 2 * margin_m,
                "position_m": plus(
                    shape.position_m, (side * axis[0], side * axis[1], side * axis[2])
                ),
            }
        )
        for side in (-aside, aside)
    )
    return first, second


def _floor(shape: Plane, edge_m: float) -> Box:
    """A box whose upper side is in the plane."""
    x, y, z = (component / math.hypot(*shape.normal) for component in shape.normal)
    # half of a turn about what lies between the normal and z turns z into the normal
    between, half = (x, y, z + 1) if z > -1 else (1.0, 0.0, 0.0), edge_m / 2
    a, b, c = (component / math.hypot(*between) for component in between)
    return Box(
        type="box",
        size_m=(edge_m, edge_m, edge_m),
        position_m=plus(shape.position_m, (-x * half, -y * half, -z * half)),
        orientation_wxyz=(0.0, a, b, c),
    )
