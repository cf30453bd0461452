"""Which impacts an engine's numbers for restitution are sought for: the first ones of a scene."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.landing import clearance_m
from simcompare.pairs import touching_pairs
from simcompare.rotations import matrix_of
from simcompare.scenario import Body, Contact, Scenario
from simcompare.shapes import Plane, Shape

#: impact speed where the scene does not tell one [m/s]
UNKNOWN_SPEED_M_S = 1.0


@dataclass(frozen=True)
class DropPlan:
    """One drop of a sphere on a fixed plane, which stands for the pairs of one restitution.

    Attributes:
        pairs: names of the bodies of each pair.
        restitution: Newton's coefficient that is wanted.
        speed_m_s: of the first impact.
        mass_kg: of the body that moves, the lighter one of two.
        size_m: its smallest size.
        gravity_m_s2: magnitude.
        step_s: the engine's step.
    """

    pairs: tuple[tuple[str, str], ...]
    restitution: float
    speed_m_s: float
    mass_kg: float
    size_m: float
    gravity_m_s2: float
    step_s: float


def drop_plans(scenario: Scenario) -> tuple[DropPlan, ...]:
    """One plan for each restitution above 0; of its pairs the fastest and the smallest counts."""
    found: dict[float, list[Contact]] = {}
    for contact in touching_pairs(scenario):
        if contact.restitution > 0:
            found.setdefault(contact.restitution, []).append(contact)
    gravity = math.hypot(*scenario.world.gravity_m_s2)
    plans = []
    for restitution, contacts in found.items():
        movers = [_mover(scenario, contact) for contact in contacts]
        plans.append(
            DropPlan(
                tuple(contact.pair for contact in contacts),
                restitution,
                max(_speed_m_s(scenario, contact) for contact in contacts),
                min(body.mass_kg or 1.0 for body in movers),
                min(_size_m(body) for body in movers),
                gravity,
                scenario.world.engine_step_s,
            )
        )
    return tuple(plans)


def _mover(scenario: Scenario, contact: Contact) -> Body:
    bodies = [scenario.bodies[name] for name in contact.pair]
    return min((b for b in bodies if not b.fixed), key=lambda body: body.mass_kg or math.inf)


def _size_m(body: Body) -> float:
    """Smallest edge or diameter of all shapes of a body [m]."""
    return min(_edge_m(shape) for shape in body.shapes if not isinstance(shape, Plane))


def _edge_m(shape: Shape) -> float:
    match shape.type:
        case "plane":
            return math.inf
        case "sphere" | "capsule":
            return 2 * shape.radius_m
        case "box":
            return min(shape.size_m)
        case _:
            return min(2 * shape.radius_m, shape.length_m)


def _speed_m_s(scenario: Scenario, contact: Contact) -> float:
    """Speed at which a pair first meets, by the energy of its free fall onto a plane."""
    first, second = (scenario.bodies[name] for name in contact.pair)
    for body, ground in ((first, second), (second, first)):
        planes = [shape for shape in ground.shapes if isinstance(shape, Plane)]
        if body.fixed or not ground.fixed or not planes:
            continue
        base = matrix_of(ground.orientation_wxyz)
        normal = base @ planes[0].normal / math.hypot(*planes[0].normal)
        pull = -float(normal @ np.array(scenario.world.gravity_m_s2))
        gap = max(0.0, clearance_m(body, ground, planes[0]))
        closing = float(normal @ np.array(body.velocity_m_s))
        squared = closing**2 + 2 * pull * gap
        if squared > 0:
            return math.sqrt(squared)
    apart = np.array(first.velocity_m_s) - np.array(second.velocity_m_s)
    return float(np.linalg.norm(apart)) or UNKNOWN_SPEED_M_S
