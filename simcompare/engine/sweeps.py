"""How often a solver must go over constraints in the plane until they hold.

One that solves them one after the other uses the method of Gauss and Seidel: in each sweep the
error falls by the largest eigenvalue of a matrix that follows from masses and places of the
constraints. Sweeps that suffice for bodies of like masses let a heavy body on a light one run away.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from simcompare.engine.contacts import touching_pairs
from simcompare.errors import Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.shapes import Plane, Shape, Sphere
from simcompare.model.trajectory import Array


class PlanarBody(Protocol):
    """What has to be known of a body."""

    mass: float
    moment: float
    position: Any
    rotation_vector: Any

    def local_to_world(self, point: tuple[float, float]) -> Any:  # noqa: ANN401
        """A point of the body in the world."""


#: what is left of an error after one step; what remains falls further in the next steps
LEFT = 1e-6
#: the engine's own number is 10; more than the most would take a millisecond
MIN_SWEEPS, MAX_SWEEPS = 50, 10000

#: a velocity that vanishes, by the body: along x, along z, and of turning
Row = list[tuple[PlanarBody, float, float, float]]


def sweeps_for(
    engine: str,
    scenario: Scenario,
    bodies: Mapping[str, PlanarBody],
    constraints: Sequence[Sequence[Row]],
) -> int:
    """Sweeps after which ``LEFT`` of an error is left where bodies are as they are drawn.

    Args:
        engine: its name, for the message.
        scenario: the scene.
        bodies: the engine's bodies.
        constraints: the velocities that each of them lets vanish.

    Raises:
        Unsupported: they are too many.
    """
    blocks = [
        *([row] for row in _contact_rows(scenario, bodies)),
        *(list(rows) for rows in constraints),
    ]
    moving = [bodies[name] for name in scenario.moving_bodies()]
    jacobian = np.array([_dense(row, moving) for block in blocks for row in block])
    weights = np.concatenate([(1 / body.mass, 1 / body.mass, 1 / body.moment) for body in moving])
    system = jacobian * weights @ jacobian.T
    solved, first = np.zeros_like(system), 0
    for block in blocks:
        end = first + len(block)
        solved[first:end, :end] = system[first:end, :end]
        first = end
    rates = np.abs(np.linalg.eigvals(np.eye(len(system)) - np.linalg.solve(solved, system)))
    # 1 belongs to constraints that say the same twice; how they share their force moves nothing
    rate = float(rates[rates < 1 - 1e-9].max(initial=0.0))
    needed = math.ceil(math.log(LEFT) / math.log(rate)) if rate > 0 else 0
    if needed > MAX_SWEEPS:
        raise Unsupported(
            f"{engine} solves joints and contacts one after the other, in {MAX_SWEEPS} sweeps at"
            f" most; with masses as different as those of {', '.join(scenario.moving_bodies())} it"
            f" needs {needed}"
        )
    return max(MIN_SWEEPS, needed)


def row_of(a: PlanarBody, b: PlanarBody, point: Sequence[float], along: Sequence[float]) -> Row:
    """That two bodies do not move against each other in a point, along a direction."""
    x, z = along
    found: Row = []
    for body, sign in ((a, -1.0), (b, 1.0)):
        rx, rz = point[0] - body.position[0], point[1] - body.position[1]
        found.append((body, sign * x, sign * z, sign * (rx * z - rz * x)))
    return found


def _contact_rows(scenario: Scenario, bodies: Mapping[str, PlanarBody]) -> Iterator[Row]:
    """Contacts of bodies in their lowest points, normal and, with friction, tangential."""
    for contact in touching_pairs(scenario):
        for name, other in (contact.pair, contact.pair[::-1]):
            if scenario.bodies[name].fixed:
                continue
            for shape in scenario.bodies[name].shapes:
                x, z = bodies[name].local_to_world((shape.position_m[0], shape.position_m[2]))
                nx, nz = _normal(scenario.bodies[other].shapes, bodies[other], (x, z))
                reach = shape.radius_m if isinstance(shape, Sphere) else 0.0
                point = (x - reach * nx, z - reach * nz)
                for direction in ((nx, nz), (-nz, nx))[: 2 if contact.friction else 1]:
                    yield row_of(bodies[other], bodies[name], point, direction)
            break


def _normal(
    shapes: Sequence[Shape], body: PlanarBody, point: tuple[float, float]
) -> Sequence[float]:
    """Normal of a body's plane; if it has none, the direction from its centre to a point."""
    for shape in shapes:
        if isinstance(shape, Plane):
            length = math.hypot(shape.normal[0], shape.normal[2])
            x, z = shape.normal[0] / length, shape.normal[2] / length
            c, s = body.rotation_vector
            return c * x - s * z, s * x + c * z
    x, z = point[0] - body.position[0], point[1] - body.position[1]
    length = math.hypot(x, z)
    return (x / length, z / length) if length > 0 else (0.0, 1.0)


def _dense(row: Row, moving: Sequence[PlanarBody]) -> Array:
    found = np.zeros(3 * len(moving))
    for body, x, z, turn in row:
        if body in moving:
            i = 3 * moving.index(body)
            found[i : i + 3] += (x, z, turn)
    return found
