"""Landing on impacts: the engine's own steps are cut so that one of them ends just before contact.

A time-stepping engine detects an impact up to one step late, so its bounce depends on where within
the step the impact falls, and some engines take the bounce speed from the velocity after gravity
has acted for a whole step, e·(1 + g·dt/v). Both errors are proportional to the step in which the
impact happens. So a recorded step that contains an impact is divided into ``parts`` equal parts;
flights inside it take as many parts at once as are certainly free of contact, the impact itself one
part at a time. All partial steps are whole multiples of one part, so an engine never changes its
step while two bodies touch (pymunk scales the impulses that it remembers by the ratio of steps).

Semi-implicit Euler stores velocities half a step away from positions (v_k belongs to t_k + s·dt
with ``stagger`` s = -1/2, or +1/2 where positions are advanced first). Changing the step from dt to
dt' therefore moves the stored velocity by a·s·(dt' - dt); without that the parabola breaks and the
restitution is biased by up to g·dt/v.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from simcompare.engine.contacts import bouncing_pairs
from simcompare.errors import Unsupported
from simcompare.model.scenario import Scenario
from simcompare.model.shapes import Plane, Sphere, Vector
from simcompare.model.vectors import dot


class Steppable(Protocol):
    """What is landed: a simulation whose step can be changed."""

    def motion_of(self, body: str) -> tuple[Vector, Vector]:
        """Position [m] and velocity [m/s] of a body at the same instant."""

    def use_step(self, step_s: float, resting: frozenset[str]) -> None:
        """Changes the engine's step [s]; moves the stored velocities of bodies not at rest."""

    def advance(self, count: int) -> None:
        """Takes engine steps of the present length."""


@dataclass(frozen=True)
class ContactSteps:
    """How an engine is stepped through an impact.

    Attributes:
        stagger: stored velocities belong to t_k + stagger·dt.
        contact_step_s: longest step during an impact [s].
        frequency_rad_s: √(k/m) of the contact where it is a spring, ``None`` for impulses.
        rest_step_s: longest step while a body rests on another [s]; ``None``: the whole step.
        chunk: engine steps that are taken in one native call during an impact.
        ahead: part of a step by which an engine feels a contact before it is there.
    """

    stagger: float
    contact_step_s: float
    frequency_rad_s: float | None = None
    rest_step_s: float | None = None
    chunk: int = 1
    ahead: float = 0.0


@dataclass(frozen=True)
class Approach:
    """A sphere above a fixed plane: its gap and its closing speed along the plane's normal."""

    body: str
    normal: Vector
    offset_m: float
    gravity_m_s2: float
    drag_per_m: float

    def gap_m(self, position_m: Vector) -> float:
        """Distance of the sphere's surface from the plane [m]; negative when they overlap."""
        return dot(self.normal, position_m) - self.offset_m

    def free_time_s(self, gap_m: float, velocity_m_s: Vector) -> float:
        """Lower bound of the time to contact [s] from a positive gap.

        Drag is bounded by its present value: it slows a rising ball and never speeds a falling one.
        """
        closing = -dot(self.normal, velocity_m_s)
        speed_squared = dot(velocity_m_s, velocity_m_s)
        pull = max(self.gravity_m_s2, 0.0) + self.drag_per_m * speed_squared
        root = math.sqrt(closing * closing + 2 * pull * gap_m)
        if closing + root <= 0:
            return math.inf
        return 2 * gap_m / (closing + root) if closing > 0 else (root - closing) / max(pull, 1e-300)


def approaches(scenario: Scenario) -> tuple[list[Approach], list[str]]:
    """Pairs whose impacts can be landed on, and why where those of a scenario cannot.

    Either all impacts of a scenario are landed on or none is: a step that changes for one pair
    while another touches would change the motion of that one.
    """
    bouncing = [contact for contact in scenario.contacts if contact.restitution > 0]
    if not bouncing:
        return [], []
    found = [_sphere_on_plane(scenario, *contact.pair) for contact in bouncing]
    landable = [approach for approach in found if approach is not None]
    moving = [body for body in scenario.moving_bodies().values() if body.shapes]
    if len(landable) == len(bouncing) and len(moving) < 2 and not scenario.joints:
        return landable, []
    return [], [
        "impacts are not landed on, which is possible only for a single sphere on fixed planes:"
        " restitutions carry the engine's own error at this step, which can be large"
    ]


def refuse(engine: str, scenario: Scenario) -> None:
    """Refuses scenes whose impacts can neither be landed on nor be taken in fine steps.

    Raises:
        Unsupported: several bodies bounce, or one on a joint.
    """
    moving = [body for body in scenario.moving_bodies().values() if body.shapes]
    if (
        bouncing_pairs(scenario)
        and (scenario.joints or len(moving) > 1)
        and not approaches(scenario)[0]
    ):
        raise Unsupported(
            f"{engine}: impacts are landed on only where a single free body bounces, since a step"
            " that is cut for one pair would change the motion of another; the level tuned shows"
            " the engine itself"
        )


def slips_at_impact(scenario: Scenario) -> bool:
    """Whether any free body moves sideways or turns at the start, so that it may slip."""
    return any(
        any(body.rate_rad_s)
        or math.hypot(*np.cross(body.velocity_m_s, scenario.world.gravity_m_s2))
        for body in scenario.free_bodies().values()
    )


def finely_stepped(scenario: Scenario, step_s: float) -> Scenario:
    """The scene in engine steps of at most ``step_s``, if it has bounces that are not landed on."""
    bounces = any(contact.restitution > 0 for contact in scenario.contacts)
    parts = math.ceil(scenario.world.engine_step_s / step_s - 1e-9)
    if not bounces or parts < 2 or approaches(scenario)[0]:
        return scenario
    world = scenario.world.model_copy(update={"substeps": scenario.world.substeps * parts})
    return scenario.model_copy(update={"world": world})


def _sphere_on_plane(scenario: Scenario, first: str, second: str) -> Approach | None:
    for mover, ground in ((first, second), (second, first)):
        body, base = scenario.bodies[mover], scenario.bodies[ground]
        if body.fixed or not base.fixed or len(body.shapes) != 1 or len(base.shapes) != 1:
            continue
        sphere, plane = body.shapes[0], base.shapes[0]
        centred = isinstance(sphere, Sphere) and sphere.position_m == body.center_of_mass_m
        if not (centred and isinstance(sphere, Sphere) and isinstance(plane, Plane)):
            continue
        if base.orientation_wxyz != (1.0, 0.0, 0.0, 0.0):
            continue
        length = math.hypot(*plane.normal)
        normal = (plane.normal[0] / length, plane.normal[1] / length, plane.normal[2] / length)
        origin = tuple(a + b for a, b in zip(base.position_m, plane.position_m, strict=True))
        assert body.mass_kg is not None
        drag = body.drag.factor_kg_m / body.mass_kg if body.drag else 0.0
        return Approach(
            mover,
            normal,
            dot(normal, origin) + sphere.radius_m,
            -dot(normal, scenario.world.gravity_m_s2),
            drag,
        )
    return None


class Landing:
    """Advances a simulation by recorded steps and lands on the impacts within them.

    Args:
        pairs: the pairs that are watched.
        step_s: recorded step [s].
        steps: how the engine is stepped through an impact.
    """

    def __init__(self, pairs: list[Approach], step_s: float, steps: ContactSteps) -> None:
        self.pairs = pairs
        self.parts = max(1, math.ceil(step_s / steps.contact_step_s - 1e-9))
        self.part_s = step_s / self.parts
        self._chunk, self._ahead = steps.chunk, steps.ahead
        rest = self.parts if steps.rest_step_s is None else int(steps.rest_step_s / self.part_s)
        self._rest_parts = min(max(1, rest), self.parts)
        pull = max((abs(pair.gravity_m_s2) for pair in pairs), default=0.0)
        # slower than this, a hop lasts less than an eighth of a recorded step: the body rests
        self._rest_speed = max(pull * step_s / 16, 2 * pull * self.part_s * steps.chunk)
        if steps.frequency_rad_s is None:
            self._rest_depth = math.inf
        else:
            # a spring rests only where it is not compressed: its turning point has no speed either
            omega = steps.frequency_rad_s
            self._rest_depth = 2 * (pull / omega**2 + self._rest_speed / omega)

    def free_steps(self, simulation: Steppable) -> int:
        """Recorded steps that are certainly free of contact from here on."""
        parts, touching, _ = self._look(simulation)
        return 0 if touching else int(min(parts, 1e15)) // self.parts

    def step(self, simulation: Steppable) -> None:
        """Advances by one recorded step, in parts where a contact falls into it."""
        left = self.parts
        while left:
            free, touching, resting = self._look(simulation)
            if touching and not resting:
                taken = min(self._chunk, left)
                simulation.use_step(self.part_s, frozenset())
                simulation.advance(taken)
            elif touching:
                size = int(min(self._rest_parts, free, left))
                taken = size * (left // size if math.isinf(free) else 1)
                simulation.use_step(size * self.part_s, resting)
                simulation.advance(taken // size)
            else:
                taken = int(min(free, left))
                simulation.use_step(taken * self.part_s, frozenset())
                simulation.advance(1)
            left -= taken

    def _look(self, simulation: Steppable) -> tuple[float, bool, frozenset[str]]:
        """Parts free of contact for the pairs in flight, whether any touches, and who rests.

        ``resting`` is empty as soon as one pair is in an impact.
        """
        free, touching, impact = math.inf, False, False
        resting = set()
        for pair in self.pairs:
            position, velocity = simulation.motion_of(pair.body)
            gap = pair.gap_m(position)
            if gap > 0:
                free_s = pair.free_time_s(gap, velocity) / (1 + self._ahead)
                parts = free_s / self.part_s - 1
                if parts >= 1:
                    free = min(free, parts)
                    continue
            touching = True
            slow = abs(dot(pair.normal, velocity)) <= self._rest_speed
            if slow and abs(gap) <= self._rest_depth:
                resting.add(pair.body)
            else:
                impact = True
        return free, touching, frozenset() if impact else frozenset(resting)
