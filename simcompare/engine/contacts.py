"""Who touches whom, and with what: one plan of contacts for all engines.

A scenario states restitution and friction for pairs of bodies. Many engines hold them per body and
combine the two values by a rule of their own; :mod:`combination` finds values that give what is
wanted, or says that there are none. Who may touch is told by pairs, or as bits where an engine
filters by these.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

from simcompare.engine.combination import Rule, per_body
from simcompare.errors import Unsupported
from simcompare.model.scenario import Contact, Scenario
from simcompare.model.settings import COEFFICIENTS, Settings

#: two numbers for a spring that bounces, and two for its friction
Springs = tuple[tuple[float, float], tuple[float, float]]


def touching_pairs(scenario: Scenario) -> list[Contact]:
    """Contact of every pair that can touch and that the scenario says something about.

    That is: with shapes, not both fixed, not jointed, and named if both move.
    """
    named = {frozenset(contact.pair): contact for contact in scenario.contacts}
    jointed = {frozenset((joint.parent, joint.child)) for joint in scenario.joints.values()}
    shaped = [(name, body.fixed) for name, body in scenario.bodies.items() if body.shapes]
    found = []
    for (first, is_fixed), (second, is_fixed_too) in combinations(shaped, 2):
        if is_fixed and is_fixed_too:
            continue
        pair = frozenset((first, second))
        if pair in jointed:
            continue
        if pair in named:
            found.append(named[pair])
        elif is_fixed or is_fixed_too:
            found.append(Contact(pair=(first, second)))
    return found


def bouncing_pairs(scenario: Scenario) -> list[Contact]:
    """Those of them that bounce."""
    if not any(contact.restitution > 0 for contact in scenario.contacts):
        return []
    return [contact for contact in touching_pairs(scenario) if contact.restitution > 0]


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


@dataclass(frozen=True)
class Pair:
    """Two bodies that can touch.

    Attributes:
        bodies: their names.
        restitution: Newton's coefficient that the scenario states.
        friction: Coulomb's, likewise.
        numbers: what stands for the restitution in the engine: one coefficient, or the two numbers
            of a spring and damper; a spring that does not bounce has the one number 0.
        friction_spring: the same for its friction where that is a spring too and a help asks for
            it.
    """

    bodies: tuple[str, str]
    restitution: float
    friction: float
    numbers: tuple[float, ...]
    friction_spring: tuple[float, float] | None = None

    @property
    def name(self) -> str:
        """Both names in one."""
        return "-".join(self.bodies)


@dataclass(frozen=True)
class ContactPlan:
    """Contacts of a scene at one level.

    Attributes:
        scenario: the scene.
        touching: pairs that can touch and of which the scenario says something.
        apart: pairs that must not touch; at the level "default" those on one joint, and the engine
            decides of all others.
        are_given: whether restitution and friction are given to the engine.
    """

    scenario: Scenario
    touching: tuple[Pair, ...]
    apart: tuple[tuple[str, str], ...]
    are_given: bool

    @property
    def bounces(self) -> bool:
        """Whether any contact that the scenario names has a restitution."""
        return any(contact.restitution > 0 for contact in self.scenario.contacts)

    def may_touch(self) -> Iterator[tuple[str, str, Pair | None]]:
        """All pairs of bodies with shapes that may touch at this level; the first one moves.

        With each is what the scenario says of it, ``None`` where that is nothing.
        """
        bodies = {name: body for name, body in self.scenario.bodies.items() if body.shapes}
        apart = {frozenset(pair) for pair in self.apart}
        known = {frozenset(pair.bodies): pair for pair in self.touching}
        for names in combinations(bodies, 2):
            first, second = sorted(names, key=lambda name: bodies[name].fixed)
            if not bodies[first].fixed and frozenset(names) not in apart:
                yield first, second, known.get(frozenset(names))

    def restitution_per_body(self, rule: Rule, engine: str) -> dict[str, float]:
        """Values whose combinations are the numbers of the pairs; none where none are given.

        Raises:
            Unsupported: no values give them.
        """
        wanted = {pair.bodies: pair.numbers[0] for pair in self.touching}
        return (
            per_body(self.scenario, wanted, "restitution", rule, engine) if self.are_given else {}
        )

    def friction_per_body(self, rule: Rule, engine: str) -> dict[str, float]:
        """The same for friction.

        Raises:
            Unsupported: no values give them.
        """
        wanted = {pair.bodies: pair.friction for pair in self.touching}
        return per_body(self.scenario, wanted, "friction", rule, engine) if self.are_given else {}

    def surfaces(
        self, restitution: Rule, friction: Rule, engine: str
    ) -> dict[str, dict[str, float]]:
        """Both values of every body, by name; none of them where none are given.

        Raises:
            Unsupported: no values give the numbers of the pairs.
        """
        bounce = self.restitution_per_body(restitution, engine)
        grip = self.friction_per_body(friction, engine)
        return {
            name: {"restitution": bounce[name], "friction": grip[name]} if self.are_given else {}
            for name in self.scenario.bodies
        }

    def by_first_rule(
        self, kind: Literal["restitution", "friction"], rules: Sequence[Rule], engine: str
    ) -> tuple[Rule, dict[str, float]]:
        """Values by the first of an engine's rules by which there are any, and that rule.

        Raises:
            Unsupported: no rule gives all pairs; told is what is wrong with the last one.
        """
        values = self.restitution_per_body if kind == "restitution" else self.friction_per_body
        *others, last = rules
        for rule in others:
            with contextlib.suppress(Unsupported):
                return rule, values(rule, engine)
        return last, values(last, engine)

    def bits(self, engine: str, width: int = 32) -> dict[str, tuple[int, int]]:
        """Category and mask of every body, so that moving bodies touch only where they are named.

        Two bodies touch where each one's category is in the other's mask. Moving bodies that may
        touch others have a bit of their own; all others share one, and so do fixed bodies.

        Raises:
            Unsupported: there are more bodies than bits.
        """
        bodies, alone, fixed = self.scenario.bodies, 1, 2
        partners: dict[str, set[str]] = {}
        for pair in self.touching:
            first, second = pair.bodies
            if not (bodies[first].fixed or bodies[second].fixed):
                partners.setdefault(first, set()).add(second)
                partners.setdefault(second, set()).add(first)
        own = {name: fixed << i for i, name in enumerate(partners, start=1)}
        if len(own) > width - 2:
            raise Unsupported(
                f"{engine} keeps at most {width - 2} moving bodies apart that may touch others,"
                f" not {len(own)}"
            )
        everything = (1 << width) - 1
        return {
            name: (fixed, everything)
            if body.fixed
            else (own.get(name, alone), fixed | sum(own[n] for n in partners.get(name, ())))
            for name, body in bodies.items()
        }


def plan_contacts(
    scenario: Scenario, settings: Settings, springs: Mapping[tuple[str, str], Springs]
) -> ContactPlan:
    """The contacts of a scene, with as much of them as the level gives.

    Args:
        scenario: the scene.
        settings: level and numbers.
        springs: numbers that a help asks for in place of those of the settings.
    """
    touching = []
    for contact in touching_pairs(scenario):
        numbers, sideways = springs.get(contact.pair, (settings.numbers_of(contact), None))
        touching.append(
            Pair(contact.pair, contact.restitution, contact.friction, numbers, sideways)
        )
    given = settings.gives(COEFFICIENTS)
    apart = untouching_pairs(scenario) if given else jointed_pairs(scenario)
    return ContactPlan(scenario, tuple(touching), tuple(apart), given)
