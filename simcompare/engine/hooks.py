"""What an engine is asked to do; an adapter, or the base that it stands on, does it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from simcompare.engine.helps.reactions import acting_force
from simcompare.engine.helps.recoil import Motion
from simcompare.engine.read_back import Held, HeldValues, Quantity, Table, unreadable
from simcompare.engine.short_turns import refuse_slowed
from simcompare.engine.stateful import StatefulMotion
from simcompare.errors import SimulationDiverged
from simcompare.model.audit import Audit
from simcompare.model.sensor import Sensor
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import Array

#: numbers of this size [SI] are no motion any more
ABSURD = 1e8


class EngineHooks(StatefulMotion):
    """The hooks of an engine; those of features that it lacks are never called.

    Attributes:
        take_step: takes one engine step, where an engine has it as a function.
        efforts_last: whether efforts that were given act in every step until others are given.
    """

    efforts_last = False

    take_step: Callable[[], object]
    #: pairs whose contact forces are read, and the widest gap at which a contact acts [m]
    _pairs: Mapping[frozenset[str], tuple[str, str]]
    _widest_gap_m: float
    #: tables that were asked for, while all of them are; by kind and name of what they are of
    _told: dict[tuple[str, str], Table] | None = None

    def set_up(self) -> None:
        """Builds the scene where that may fail with the engine open; ``close`` follows then."""
        return

    def take_steps(self, count: int) -> None:
        """Takes ``count`` engine steps of the present length, with nothing given in them."""
        step = self.take_step
        for _ in range(count):
            step()

    def give(self, efforts: Sequence[float]) -> None:
        """Puts efforts on the driven joints for the next engine step."""
        raise NotImplementedError

    def push(self, body: str, force: Vector) -> None:
        """Pushes a body at its centre of mass during the next engine step; world frame [N]."""
        raise NotImplementedError

    def twist(self, body: str, torque: Vector) -> None:
        """Turns a body during the next engine step; in its own frame [N·m]."""
        raise NotImplementedError

    def joint_motions(self) -> tuple[Sequence[float], Sequence[float]]:
        """Coordinates and stored rates of the driven joints."""
        raise NotImplementedError

    def rotor_motions(self) -> list[Motion]:
        """How the bodies with armatures move now."""
        raise NotImplementedError

    def origin_of(self, body: str) -> Vector:
        """World position of any moving body [m], as the engine itself has it."""
        return self.stored_motion(body)[0]

    def reason_lacking(self, sensor: Sensor) -> str:
        """Why an engine does not give what a force sensor reads, empty where it does."""
        del sensor
        return ""

    def joint_force(self, joint: str) -> Vector:
        """Force of a joint's parent on its child in the last engine step, in the child's frame."""
        raise NotImplementedError

    def contact_force(self, first: str, second: str) -> float:
        """Sum of the normal forces between two bodies in the last engine step [N]."""
        return acting_force(self.contact_points(first, second), self._widest_gap_m)

    def contact_points(self, first: str, second: str) -> Iterable[tuple[float, float]]:
        """Normal force [N] and gap [m] of each of their points of contact.

        For engines that leave old forces on points that are too far apart to act.
        """
        raise NotImplementedError

    def contact_forces(self) -> Mapping[frozenset[str], float]:
        """The same for every pair that is sensed and touched; engines that list them all do it."""
        return {pair: self.contact_force(*sensed) for pair, sensed in self._pairs.items()}

    def cast_rays(
        self, origin_m: Vector, directions: Array, without_body: str, reach_m: float
    ) -> Sequence[float] | Array:
        """How far rays go in the engine, as its bodies are now, until they meet one.

        It changes nothing of what comes after.

        Args:
            origin_m: where all of them begin, outside of all other bodies; in the world's frame.
            directions: unit vectors (n, 3) in the world's frame.
            without_body: the body whose shapes they pass through; empty for none.
            reach_m: how far they go.

        Returns:
            Distances along the rays (n,) [m]; ``inf`` where nothing is met.
        """
        raise NotImplementedError

    def held_of_world(self) -> Table:
        """What the engine holds of step and gravity."""
        return {}

    def held_of_body(self, body: str) -> Table:
        """What it holds of a moving body: mass, moments of inertia, place, sizes."""
        del body
        return {}

    def held_of_joint(self, joint: str) -> Table:
        """What it holds of a joint: anchor, axis, and of what acts on it."""
        del joint
        return {}

    def held_of_pair(self, first: str, second: str) -> Table:
        """What it holds of restitution and friction of a pair."""
        del first, second
        return {}

    def held(self, quantity: Quantity) -> HeldValues | None:
        """What the engine holds of something that was asked for; ``None`` is a fault."""
        found = self._table_of(quantity).get(quantity.kind) or self._held_of_law(quantity)
        if quantity.kind != "size_m" or found is None or isinstance(found, Held):
            return found
        return found[quantity.index] if quantity.index < len(found) else None

    def answers(self, asked: Iterable[Quantity]) -> list[tuple[Quantity, HeldValues | None]]:
        """What the engine holds of all that is asked for; each table is asked for once."""
        self._told = {}
        try:
            return [(quantity, self.held(quantity)) for quantity in asked]
        finally:
            self._told = None

    def _table_of(self, quantity: Quantity) -> Table:
        told, key = self._told, (quantity.owner, quantity.of)
        if told is None or key not in told:
            match quantity.owner:
                case "world":
                    table = self.held_of_world()
                case "body":
                    table = self.held_of_body(quantity.of)
                case "joint":
                    table = self.held_of_joint(quantity.of)
                case _:
                    table = self.held_of_pair(*quantity.bodies)
            if told is None:
                return table
            told[key] = table
        return told[key]

    def _held_of_law(self, quantity: Quantity) -> Held | None:
        """What is given as an effort in each step or as a moment of inertia, and nowhere else."""
        if quantity.owner != "joint" or quantity.kind not in (
            "stiffness",
            "damping",
            "rest",
            "armature",
        ):
            return None
        if quantity.kind == "armature" and not self.scene.traits.has_armature:
            return unreadable("moment of inertia", "added to the child's, where it is read back")
        joint = self.scene.joints[quantity.of]
        is_given = getattr(joint.given, quantity.kind) == getattr(joint.law, quantity.kind)
        return unreadable("effort", "given anew in each step") if is_given else None

    def own_parameters(self, audit: Audit) -> None:
        """Adds what was set in the engine besides, to the audit."""
        return

    def check(self) -> None:
        """Raises ``SimulationDiverged`` where numbers are no motion, or turns are slowed down."""
        row = np.asarray(self.row(), dtype=float)
        if (np.abs(row) < ABSURD).all():
            if self.scene.traits.most_turn_rad is not None:
                now = self.motions(row[None])
                refuse_slowed(self.scene, now, self.step_now_s, np.array([self.time_s]))
            return
        found = self.motions(row[None])
        wrong = [n for n, values in found.items() if not (np.abs(values) < ABSURD).all()]
        raise SimulationDiverged(
            f"{', '.join(wrong)} went beyond {ABSURD:g} by t = {self.time_s:g} s; try a smaller"
            " --step"
        )

    def mark(self) -> None:
        """Notes what forces are worked out from, before the last engine step of a recorded one."""
        return
