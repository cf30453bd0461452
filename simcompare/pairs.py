"""Contact per pair, for engines that hold it per body and multiply the two values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations

from simcompare.errors import Unsupported
from simcompare.scenario import Contact, Scenario
from simcompare.settings import Settings


def touching_pairs(scenario: Scenario) -> list[Contact]:
    """Contact of every pair that can touch and that the scenario says something about.

    That is: with shapes, not both fixed, not jointed, and named if both move.
    """
    named = {frozenset(contact.pair) for contact in scenario.contacts}
    jointed = {frozenset((joint.parent, joint.child)) for joint in scenario.joints.values()}
    found = []
    for (first, a), (second, b) in combinations(scenario.bodies.items(), 2):
        can_touch = a.shapes and b.shapes and not (a.fixed and b.fixed)
        pair = frozenset((first, second))
        told = a.fixed or b.fixed or pair in named
        if can_touch and told and pair not in jointed:
            found.append(scenario.contact_of(first, second))
    return found


def jointed_pairs(scenario: Scenario) -> list[tuple[str, str]]:
    """Pairs of bodies that a joint connects; they never touch."""
    return [(joint.parent, joint.child) for joint in scenario.joints.values()]


def untouching_pairs(scenario: Scenario) -> list[tuple[str, str]]:
    """Pairs that are not to touch: jointed ones, and moving ones that no contact names."""
    named = {frozenset(contact.pair) for contact in scenario.contacts}
    moving = [name for name, body in scenario.moving_bodies().items() if body.shapes]
    jointed = jointed_pairs(scenario)
    known = {frozenset(pair) for pair in jointed}
    return jointed + [
        pair
        for pair in combinations(moving, 2)
        if frozenset(pair) not in named and frozenset(pair) not in known
    ]


def restitution_per_body(scenario: Scenario, settings: Settings, engine: str) -> dict[str, float]:
    """Per-body coefficients of restitution for an engine that multiplies the two of a pair.

    Raises:
        Unsupported: no such values exist.
    """
    values = {c.pair: settings.numbers_of(c)[0] for c in touching_pairs(scenario)}
    return _factors(scenario, values, "restitution", engine)


def friction_per_body(scenario: Scenario, engine: str) -> dict[str, float]:
    """Per-body coefficients of friction for an engine that multiplies the two of a pair.

    Raises:
        Unsupported: no such values exist.
    """
    values = {c.pair: c.friction for c in touching_pairs(scenario)}
    return _factors(scenario, values, "friction", engine)


def _factors(
    scenario: Scenario, pairs: Mapping[tuple[str, str], float], prop: str, engine: str
) -> dict[str, float]:
    """Per-body values whose products are those of the pairs.

    Fixed bodies hold 1 and moving bodies the value of their pairs with fixed ones, so what is set
    is what the scenario says; two bodies that touch nothing fixed share theirs equally.
    """
    values = {name: 1.0 for name, body in scenario.bodies.items() if body.fixed}
    for pair, wanted in pairs.items():
        moving = [name for name in pair if not scenario.bodies[name].fixed]
        if len(moving) == 1:
            values.setdefault(moving[0], wanted)
    for pair, wanted in pairs.items():
        _share(values, pair, wanted)
    for name in scenario.bodies:  # those that touch nothing
        values.setdefault(name, 0.0)
    for (first, second), wanted in pairs.items():
        if abs(wanted - values[first] * values[second]) > 1e-12:
            raise Unsupported(
                f"{engine} holds {prop} per body and multiplies: no values give"
                f" {first}-{second} = {wanted:g} together with the other pairs"
            )
    return values


def _share(values: dict[str, float], pair: tuple[str, str], wanted: float) -> None:
    """Gives the bodies of a pair that have no value yet one that fits."""
    first, second = pair
    if first not in values and second not in values:
        values[first] = values[second] = math.sqrt(wanted)
    for name, other in ((first, second), (second, first)):
        if name not in values:
            values[name] = wanted / values[other] if values[other] > 0 else 0.0


def refuse_offsets(scenario: Scenario, engine: str, shapes: int | None = None) -> None:
    """Refuses what a backend does not build: offset centres of mass, and more shapes than it can.

    Raises:
        Unsupported: a body has one; names it.
    """
    for name, body in scenario.bodies.items():
        if any(body.center_of_mass_m):
            raise Unsupported(f"{engine}: the centre of mass of {name} is not at its origin")
        if shapes is not None and len(body.shapes) > shapes:
            raise Unsupported(f"{engine}: {name} has more than {shapes} shape")
