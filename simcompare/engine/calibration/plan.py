"""Which impacts an engine's numbers for restitution are sought for: the first ones of a scene."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from simcompare.engine.clearance import reach_m
from simcompare.engine.contacts import bouncing_pairs
from simcompare.model.rotations import matrix_of
from simcompare.model.scenario import Body, Contact, Scenario
from simcompare.model.settings import DropPlan
from simcompare.model.shapes import Plane, Shape
from simcompare.model.trajectory import Array

#: impact speed where the scene does not tell one [m/s]
UNKNOWN_SPEED_M_S = 1.0


@dataclass(frozen=True)
class _Approach:
    """How a pair first meets: speed along the normal [m/s], gravity along it [m/s²]."""

    speed_m_s: float
    gravity_m_s2: float
    note: str = ""


def drop_plans(scenario: Scenario) -> tuple[DropPlan, ...]:
    """One plan for each restitution above 0; of its pairs the fastest and the smallest counts."""
    found: dict[float, list[Contact]] = {}
    for contact in bouncing_pairs(scenario):
        found.setdefault(contact.restitution, []).append(contact)
    plans = []
    for restitution, contacts in found.items():
        movers = [_mover(scenario, contact) for contact in contacts]
        met = [_approach(scenario, contact) for contact in contacts]
        fastest = max(met, key=lambda approach: approach.speed_m_s)
        notes = [_unlike_a_drop(scenario, contact) for contact in contacts]
        plans.append(
            DropPlan(
                tuple(contact.pair for contact in contacts),
                restitution,
                fastest.speed_m_s,
                min(body.mass_kg or 1.0 for body in movers),
                min(_size_m(body) for body in movers),
                fastest.gravity_m_s2,
                scenario.world.engine_step_s,
                tuple(dict.fromkeys(note for note in (*notes, fastest.note) if note)),
            )
        )
    return tuple(plans)


def _mover(scenario: Scenario, contact: Contact) -> Body:
    bodies = [scenario.bodies[name] for name in contact.pair]
    return min((b for b in bodies if not b.fixed), key=lambda body: body.mass_kg or math.inf)


def _unlike_a_drop(scenario: Scenario, contact: Contact) -> str:
    """Why a sphere on a plane is not the very pair."""
    kinds = {tuple(shape.type for shape in scenario.bodies[name].shapes) for name in contact.pair}
    if kinds == {("sphere",), ("plane",)}:
        return ""
    return (
        f"the numbers for {'-'.join(contact.pair)} were found with a sphere of the smallest size on"
        " a plane; other shapes may bounce otherwise"
    )


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


def _approach(scenario: Scenario, contact: Contact) -> _Approach:
    """How a pair first meets, by the energy of its fall onto what is fixed."""
    first, second = (scenario.bodies[name] for name in contact.pair)
    for body, ground in ((first, second), (second, first)):
        if not body.fixed and ground.fixed:
            return _fall(scenario, contact, body, ground)
    way = np.array(second.position_m) - first.position_m
    length = float(np.linalg.norm(way))
    apart = np.array(first.velocity_m_s) - np.array(second.velocity_m_s)
    closing = float(apart @ way) / length if length else float(np.linalg.norm(apart))
    if closing > 0:
        return _Approach(closing, 0.0)
    return _Approach(UNKNOWN_SPEED_M_S, 0.0, _assumed(contact))


def _fall(scenario: Scenario, contact: Contact, body: Body, ground: Body) -> _Approach:
    gravity = np.array(scenario.world.gravity_m_s2)
    base = matrix_of(ground.orientation_wxyz)
    planes = [shape for shape in ground.shapes if isinstance(shape, Plane)]
    if planes:
        normal = base @ planes[0].normal / math.hypot(*planes[0].normal)
    elif gravity.any():
        normal = -gravity / np.linalg.norm(gravity)
    else:
        speed = math.hypot(*body.velocity_m_s)
        note = "" if speed else _assumed(contact)
        return _Approach(speed or UNKNOWN_SPEED_M_S, 0.0, note)
    pull = -float(normal @ gravity)
    gap = max(0.0, -_height_m(body, -normal) - _height_m(ground, normal))
    closing = float(normal @ np.array(body.velocity_m_s))
    squared = closing**2 + 2 * pull * gap
    if squared > 0:
        return _Approach(math.sqrt(squared), abs(pull))
    return _Approach(UNKNOWN_SPEED_M_S, abs(pull), _assumed(contact))


def _height_m(body: Body, direction: Array) -> float:
    """How far a body reaches in a direction, from the world's origin [m]."""
    turn = matrix_of(body.orientation_wxyz)
    heights = []
    for shape in body.shapes:
        reach = 0.0
        if not isinstance(shape, Plane):
            reach = reach_m(shape, matrix_of(shape.orientation_wxyz).T @ turn.T @ direction)
        heights.append(float(direction @ (turn @ shape.position_m + body.position_m)) + reach)
    return max(heights)


def _assumed(contact: Contact) -> str:
    return (
        f"the speed at which {' and '.join(contact.pair)} meet does not follow from the start;"
        f" {UNKNOWN_SPEED_M_S:g} m/s is assumed"
    )
