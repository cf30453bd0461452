"""Base for engines in space with maximal coordinates: each body has its own, joints only bind them.

Coordinates of joints follow from the motion of two bodies. An orientation does not tell how many
turns a hinge has made; they are counted here.
"""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from collections.abc import Sequence

from simcompare.engine.free_motion import DragLaw
from simcompare.engine.helps.recoil import Motion
from simcompare.engine.read_back import Held, HeldValues, Quantity, unreadable
from simcompare.engine.scene import Scene
from simcompare.engine.simulation import Simulation
from simcompare.engine.spatial_joints import Link, Slider, link_of
from simcompare.engine.state import BodyState, State
from simcompare.engine.stateful import Saved
from simcompare.errors import SimulationDiverged
from simcompare.model.scenario import MOVABLE
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import BODY_SIGNALS, Array
from simcompare.model.vectors import cross, minus, plus, times, turned, turned_back

#: no effort or drag is larger [N, N·m]; where numbers overflow, an engine may end the process
ABSURD_EFFORT = 1e30


class SpatialSimulation(Simulation):
    """A simulation in an engine of maximal coordinates in space.

    An adapter writes ``get``, ``put``, ``take_steps`` and ``set_engine_step``, and of ``push``,
    ``turn``, ``reaction`` and ``contact_force`` what its features need; then the tables of what it
    holds. Where its engine remembers more than the motion of the bodies, ``snapshot`` and
    ``take_back``; where its joints take efforts themselves, ``exert``. Once the bodies are there,
    it calls ``place_all``.
    """

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        self._links: dict[str, Link] = {
            name: link_of(scene.joints[name], self.scenario.bodies[joint.parent])
            for name, joint in self._joints.items()
        }
        self._driven = [self._links[name] for name in self.driven or ()]
        self._rotors = [self._links[r.joint] for r in (self.recoil.rotors if self.recoil else ())]
        #: body -> where its velocity begins in a row
        self._velocities = {name: 13 * i + 7 for i, name in enumerate(self._bodies)}
        self._clock_s = 0.0
        self._acts |= bool(self._links)  # so that all steps are taken on that clock
        sensed = {sensor.joint for sensor in self._force_sensors.values()}
        #: joint whose force is read -> its child, and that one's orientation before the step
        self._sensed: dict[str, tuple[str, Sequence[float]]] = {
            name: (joint.child, (1.0, 0.0, 0.0, 0.0))
            for name, joint in self.scenario.joints.items()
            if name in sensed
        }

    # --- hooks of an engine -------------------------------------------------------------------

    @abstractmethod
    def get(self, body: str) -> BodyState:
        """Motion of a moving body, in the world's frame."""

    @abstractmethod
    def put(self, body: str, state: BodyState) -> None:
        """Sets it."""

    def turn(self, body: str, torque: Vector) -> None:
        """Turns a body during the next engine step; in the world's frame [N·m]."""
        raise NotImplementedError

    def reaction(self, joint: str) -> Vector:
        """Force of a joint itself on its child in the last engine step [N], in the world's frame.

        Its friction is a part of it; an effort that was given to it is not.
        """
        raise NotImplementedError

    def exert(self, joint: str, effort: float) -> None:
        """Lets an effort act on both bodies of a joint during the next engine step.

        A force acts on one line, which goes through the child's centre: what misses the parent's
        turns the parent.
        """
        link = self._links[joint]
        child = self.get(link.child)
        given = times(effort, turned(child.orientation_wxyz, link.axis))
        back, is_slider = times(-1, given), isinstance(link, Slider)
        (self.push if is_slider else self.turn)(link.child, given)
        if link.ground is not None:
            return
        if is_slider:
            arm = minus(child.position_m, self.get(link.parent).position_m)
            self.push(link.parent, back)
            self.turn(link.parent, cross(arm, back))
        else:
            self.turn(link.parent, back)

    # --- what follows from them ---------------------------------------------------------------

    def act(self) -> None:
        """Gives all that acts in the next engine step, whose end the clock of turns then shows."""
        super().act()
        self._clock_s += self.step_now_s

    def row(self) -> Sequence[float]:
        """Motion of all moving bodies, then coordinate and rate of all movable joints."""
        states = {name: self.get(name) for name in self._bodies}
        found: list[float] = []
        for state in states.values():
            found += state.position_m
            found += state.orientation_wxyz
            found += state.velocity_m_s
            found += state.rate_rad_s
        for link in self._links.values():
            parent = link.ground or states[link.parent]
            found += link.look(parent, states[link.child], self._clock_s)
        return found

    def motions(self, rows: Array) -> dict[str, Array]:
        """Signals of all bodies and joints."""
        found: dict[str, Array] = {}
        column = 0
        for name in self._bodies:
            for part, width in BODY_SIGNALS.items():
                found[f"{name}.{part}"] = rows[:, column : column + width].copy()
                column += width
        for name, joint in self._joints.items():
            for part in MOVABLE[joint.type]:
                found[f"{name}.{part}"] = rows[:, column].copy()
                column += 1
        return found

    def _look(self, link: Link) -> tuple[float, float]:
        return link.look(link.ground or self.get(link.parent), self.get(link.child), self._clock_s)

    def velocity_in(self, row: Sequence[float], body: str) -> Vector:
        """Stored velocity of a free body in a row."""
        first = self._velocities[body]
        return row[first], row[first + 1], row[first + 2]

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        """Position and stored velocity of a free body."""
        state = self.get(body)
        (x, y, z), (u, v, w) = state.position_m, state.velocity_m_s
        return (x, y, z), (u, v, w)

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        """Adds to a free body's stored velocity."""
        state = self.get(body)
        changed = plus(state.velocity_m_s, change_m_s)
        self.put(body, dataclasses.replace(state, velocity_m_s=changed))

    def give(self, efforts: Sequence[float]) -> None:
        """Lets the efforts of the driven joints act in the next engine step."""
        for link, effort in zip(self._driven, efforts, strict=True):
            self._refuse_absurd(link.name, effort)
            self.exert(link.name, effort)

    def drag_law(self, body: str) -> DragLaw:
        """Drag on a body."""
        law = super().drag_law(body)

        def force(vx: float, vy: float, vz: float) -> Vector:
            found = law(vx, vy, vz)
            self._refuse_absurd(body, max(found, key=abs))
            return found

        return force

    def _refuse_absurd(self, name: str, effort: float) -> None:
        if not abs(effort) < ABSURD_EFFORT:
            raise SimulationDiverged(
                f"what acts on {name} went beyond {ABSURD_EFFORT:g} N or N·m; try a smaller --step"
            )

    def twist(self, body: str, torque: Vector) -> None:
        """Turns a body during the next engine step; in its own frame."""
        self.turn(body, turned(self.get(body).orientation_wxyz, torque))

    def joint_motions(self) -> tuple[Sequence[float], Sequence[float]]:
        """Coordinates and stored rates of the driven joints."""
        coordinates, rates = zip(*(self._look(link) for link in self._driven), strict=True)
        return coordinates, rates

    def rotor_motions(self) -> list[Motion]:
        """How the bodies with armatures move now."""
        found: list[Motion] = []
        for link in self._rotors:
            child = self.get(link.child)
            _, rate = link.look(link.ground or self.get(link.parent), child, self._clock_s)
            found.append((rate, turned_back(child.orientation_wxyz, child.rate_rad_s)))
        return found

    def mark(self) -> None:
        """Notes how children are turned while forces act on them, at the start of a step."""
        for name, (child, _) in self._sensed.items():
            self._sensed[name] = (child, self.get(child).orientation_wxyz)

    def joint_force(self, joint: str) -> Vector:
        """Force of a joint's parent on its child, its effort included, in the child's frame."""
        found = turned_back(self._sensed[joint][1], self.reaction(joint))
        drive, link = self._drive, self._links.get(joint)
        if drive is not None and joint in drive.names and isinstance(link, Slider):
            effort = drive.given[drive.names.index(joint)]
            return plus(found, times(effort, link.axis))
        return found

    # --- what it holds ------------------------------------------------------------------------

    def held(self, quantity: Quantity) -> HeldValues | None:
        """What the engine holds, as it is asked for.

        Tables of an adapter have anchors and axes in the world's frame, as they are drawn, and
        leave out what is the same in all such engines.
        """
        held = super().held(quantity)
        if held is None:
            return self._held_of_any(quantity)
        if not isinstance(held, Held) or held.value is None:
            return held
        if quantity.kind == "inertia_kg_m2" and self.scene.armature_on(quantity.of):
            note = "with the armature of its joint about the joint's axis"
            return dataclasses.replace(held, note=note)
        if quantity.owner == "joint" and isinstance(held.value, Sequence):
            joint, bodies = self.scene.joints[quantity.of].joint, self.scenario.bodies
            parent, child = bodies[joint.parent], bodies[joint.child]
            value: Sequence[float] = held.value  # type: ignore[assignment]
            # no more can be told of it than of where it is in the world
            slack = self.scene.traits.precision * max(map(abs, value))
            if quantity.kind == "anchor_m":
                note = held.note
                seen = turned_back(parent.orientation_wxyz, minus(value, parent.position_m))
            else:
                note, seen = "in the child's frame", turned_back(child.orientation_wxyz, value)
            both = zip(seen, quantity.value, strict=True)
            told = [wanted if abs(part - wanted) <= slack else part for part, wanted in both]
            return dataclasses.replace(held, value=told, note=note)
        return held

    def _held_of_any(self, quantity: Quantity) -> HeldValues | None:
        """What all such engines hold, or do not: of joints only hinges keep an anchor."""
        if quantity.kind == "position_m":
            return Held("position", self.get(quantity.of).position_m)
        if quantity.kind == "anchor_m" and self.scene.joints[quantity.of].joint.type != "hinge":
            return unreadable("anchor", "its bodies are bound as they are drawn")
        return None

    def read_back_start(self, engine: str) -> None:
        """Compares the initial motion that the engine holds with the scenario's."""
        self.check()  # before a step in which numbers overflow
        super().read_back_start(engine)

    # --- states -------------------------------------------------------------------------------

    def place(self, body: str, state: BodyState) -> None:
        """Puts a free body into a state."""
        self.put(body, state)

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        """Takes over how many turns a joint has made; ``set_state`` puts its child in place."""
        self._links[joint].begin(position, rate)

    def place_all(self) -> None:
        """Puts everything to the start of the scene."""
        for name, state in self.scene.starts.items():
            self.put(name, state)
        for name, joint in self._joints.items():
            self.place_joint(name, 0.0, joint.rate)
        self._first = self.snapshot()

    def forget(self) -> None:
        """Goes back to the start, where the engine had nothing to remember."""
        self.take_back(self._first)

    def set_state(self, state: State) -> None:
        """Puts everything into a state; bodies on joints are where it says that they are."""
        super().set_state(state)
        for name in self._bodies:
            if name not in self._free:
                self.put(name, state.bodies[name])
        self._clock_s = 0.0

    def save(self) -> Saved:
        """A token of the present state, which also knows the turns of all joints."""
        saved = super().save()
        turns = {name: link.turned for name, link in self._links.items()}
        return dataclasses.replace(saved, snapshot=(saved.snapshot, turns, self._clock_s))

    def restore(self, saved: Saved) -> None:
        """Goes back to a state that ``save`` gave."""
        assert isinstance(saved.snapshot, tuple)
        snapshot, turns, self._clock_s = saved.snapshot
        super().restore(dataclasses.replace(saved, snapshot=snapshot))
        for name, link in self._links.items():
            link.turned = turns[name]

    def snapshot(self) -> object:
        """Motion of all bodies; for engines that remember nothing else."""
        return {name: self.get(name) for name in self._bodies}

    def take_back(self, snapshot: object) -> None:
        """Sets the motion of all bodies."""
        assert isinstance(snapshot, dict)
        for name, state in snapshot.items():
            self.put(name, state)
