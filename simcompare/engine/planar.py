"""Base for planar engines, in which every body has coordinates of its own.

The scenario's x-z plane is the engine's x-y plane; angles grow from x towards z, which is a
negative turn about y.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from simcompare.engine.helps import half_step_start
from simcompare.engine.helps.momentum import MomentumForces
from simcompare.engine.helps.recoil import Motion
from simcompare.engine.planar_joints import (
    KINDS,
    PlanarJoint,
    PlanarMotion,
    Point,
    Recorded,
    angle_of,
    turned_by,
)
from simcompare.engine.scene import Scene
from simcompare.engine.simulation import Simulation
from simcompare.engine.state import BodyState, State
from simcompare.engine.turns import nearest_turn
from simcompare.model.scenario import MOVABLE
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import Array


class PlanarSimulation(Simulation):
    """A simulation in a planar engine.

    An adapter writes ``get``, ``put``, ``load``, ``take_steps`` and ``set_engine_step``; then
    ``forget`` where its engine remembers something, the tables of what it holds, and of
    ``constraint_force``, ``contact_force`` and ``contact_impulse`` what its features need.

    Attributes:
        linkages: all joints, each after the one that carries its parent.
    """

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        fixed = {n: body for n, body in self.scenario.bodies.items() if body.fixed}
        self._still = {
            name: _still(body.position_m, body.orientation_wxyz) for name, body in fixed.items()
        }
        self.linkages = {
            name: KINDS[joint.joint.type](scene, joint, self.motion_now)
            for name, joint in scene.joints.items()
        }
        #: body -> where its velocity begins in a row
        self._velocities = {name: 6 * i + 2 for i, name in enumerate(self._bodies)}
        self._driven = [self.linkages[name] for name in self.driven or ()]
        self._rotors = [self.linkages[r.joint] for r in (self.recoil.rotors if self.recoil else ())]
        tells_magnitudes = "magnitude" in scene.traits.wrong_reactions
        self._momentum = (
            MomentumForces(self.scenario, self._force_sensors) if tells_magnitudes else None
        )

    # --- hooks of an engine -------------------------------------------------------------------

    @abstractmethod
    def get(self, body: str) -> PlanarMotion:
        """Motion of a moving body, its angle over any number of turns."""

    @abstractmethod
    def put(self, body: str, motion: PlanarMotion) -> None:
        """Puts a moving body into a motion."""

    @abstractmethod
    def load(self, body: str, fx: float, fz: float, torque: float) -> None:
        """Adds a force at a moving body's centre, and a torque, during the next engine step."""

    def constraint_force(self, joint: str) -> Sequence[float]:
        """Force [N] that a joint put on its child in the last engine step, in the world's frame.

        Efforts that were given in the step are no part of it.
        """
        raise NotImplementedError

    def contact_impulse(self, body: str) -> tuple[float, float]:
        """Sum of all impulses [N·s] of contacts on a body in the last engine step."""
        raise NotImplementedError

    # --- what follows -------------------------------------------------------------------------

    def motion_now(self, body: str) -> PlanarMotion:
        """Motion of any body."""
        return self._still.get(body) or self.get(body)

    @property
    def ahead_s(self) -> float:
        """Time from the positions before a step until its forces act [s]."""
        return self.lead * self.step_now_s

    def place_all(self) -> None:
        """Puts everything to the start of the scene."""
        for name, state in self.scene.starts.items():
            self.place(name, state)

    def place(self, body: str, state: BodyState) -> None:
        (x, _, z), (vx, _, vz) = state.position_m, state.velocity_m_s
        self.put(body, (x, z, vx, vz, angle_of(state.orientation_wxyz), -state.rate_rad_s[1]))

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        """Nothing is left to do: its bodies are placed, all with coordinates of their own."""

    def set_state(self, state: State) -> None:
        """Puts all bodies into a state; joints keep the number of turns that they have made."""
        super().set_state(state)
        for name, joint in self.linkages.items():
            self.place(joint.child, state.bodies[joint.child])
            coordinate, _ = state.joints.get(name, (0.0, 0.0))
            x, z, vx, vz, angle, rate = self.get(joint.child)
            # an orientation does not tell how many turns the joint has made
            angle = nearest_turn(angle, joint.angle_of_child(coordinate))
            self.put(joint.child, (x, z, vx, vz, angle, rate))

    def row(self) -> Sequence[float]:
        """Motion of all moving bodies."""
        found: tuple[float, ...] = ()
        for name in self._bodies:
            found += self.get(name)
        return found

    def motions(self, rows: Array) -> dict[str, Array]:
        """Signals of all moving bodies, and of the joints."""
        found: dict[str, Array] = {}
        zero, columns = np.zeros(len(rows)), dict[str, Recorded]()
        for i, name in enumerate(self._bodies):
            x, z, vx, vz, angle, rate = columns[name] = list(rows[:, 6 * i : 6 * i + 6].T)
            # turning from x to z is negative about y, which points away from the viewer
            half = -angle / 2
            found[f"{name}.position_m"] = np.column_stack((x, zero, z))
            found[f"{name}.orientation_wxyz"] = np.column_stack(
                (np.cos(half), zero, np.sin(half), zero)
            )
            found[f"{name}.velocity_m_s"] = np.column_stack((vx, zero, vz))
            found[f"{name}.rate_rad_s"] = np.column_stack((zero, -rate, zero))
        for name, joint in self._joints.items():
            parent = columns.get(joint.parent) or self._still[joint.parent]
            moved = self.linkages[name].recorded(parent, columns[joint.child])
            for part, values in zip(MOVABLE[joint.type], moved, strict=True):
                found[f"{name}.{part}"] = values
        return found

    def velocity_in(self, row: Sequence[float], body: str) -> Vector:
        first = self._velocities[body]
        return row[first], 0.0, row[first + 1]

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        x, z, vx, vz, _, _ = self.get(body)
        return (x, 0.0, z), (vx, 0.0, vz)

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        x, z, vx, vz, angle, rate = self.get(body)
        self.put(body, (x, z, vx + change_m_s[0], vz + change_m_s[2], angle, rate))

    def push(self, body: str, force: Vector) -> None:
        self.load(body, force[0], force[2], 0.0)

    def twist(self, body: str, torque: Vector) -> None:
        self.load(body, 0.0, 0.0, -torque[1])

    def give(self, efforts: Sequence[float]) -> None:
        sums: dict[str, tuple[float, float, float]] = {}
        for joint, effort in zip(self._driven, efforts, strict=True):
            for body, (fx, fz, torque) in joint.loads(effort, self.ahead_s).items():
                x, z, t = sums.get(body, (0.0, 0.0, 0.0))
                sums[body] = (x + fx, z + fz, t + torque)
        for body, load in sums.items():
            if body not in self._still:
                self.load(body, *load)

    def joint_motions(self) -> tuple[Sequence[float], Sequence[float]]:
        motions = [joint.motion(self.ahead_s) for joint in self._driven]
        return [q for q, _ in motions], [v for _, v in motions]

    def rotor_motions(self) -> list[Motion]:
        found: list[Motion] = []
        for joint in self._rotors:
            spin, base = self.motion_now(joint.child)[5], self.motion_now(joint.parent)[5]
            found.append((joint.sign * (spin - base), (0.0, -spin, 0.0)))
        return found

    def mark(self) -> None:
        if self._momentum is not None:
            self._momentum.mark(self)

    def joint_force(self, joint: str) -> Vector:
        linkage = self.linkages[joint]
        if self._momentum is not None:
            fx, fz = self._momentum.force(self, joint, self.step_now_s)
        else:
            fx, fz = self._driven_force(joint, linkage)
        x, z = turned_by((fx, fz), -self.get(linkage.child)[4])
        return x, 0.0, z

    def _driven_force(self, joint: str, linkage: PlanarJoint) -> Point:
        """Force of the constraint and of the effort that was given besides; world's frame."""
        fx, fz = self.constraint_force(joint)
        if self._drive is not None and joint in self._drive.names:  # on a hinge it is a torque only
            effort = self._drive.given[self._drive.names.index(joint)]
            along_x, along_z, _ = linkage.loads(effort, self.ahead_s)[linkage.child]
            fx, fz = fx + along_x, fz + along_z
        return fx, fz

    def snapshot(self) -> object:
        """All motions; what the engine remembers besides is lost by who goes on and comes back."""
        motions = {name: self.get(name) for name in self._bodies}
        self.take_back(motions)
        return motions

    def take_back(self, snapshot: object) -> None:
        """Puts all bodies into their motions."""
        assert isinstance(snapshot, dict)
        self.forget()
        for name, motion in snapshot.items():
            self.put(name, motion)

    # --- a start half a step ahead, see ``helps.half_step_start`` -----------------------------

    def begin_after(self) -> None:
        half_step_start.begin_after(self)

    def take_step_that_ends_at(self, index: int, *, last: bool) -> None:
        """Takes the engine step before another one, the last time to stay."""
        if self._drive is not None:
            self._drive.go_to(index - 1, None)
        if last:
            self.mark()
        self.advance(1)
        if self.recoil is not None:
            self.recoil.look(self.rotor_motions())
            self.recoil.begin(self.recoil.felt)
        if last and self._force_sensors:
            self._first_forces = self.forces()

    def note_rates_before(self) -> None:
        """Tells what drives the joints that the present rates are those of a step before."""
        if self._drive is not None:
            self._drive.go_to(self.index, self.joint_motions()[1])


def _still(position_m: Vector, orientation_wxyz: Sequence[float]) -> PlanarMotion:
    """Motion of a fixed body."""
    return position_m[0], position_m[2], 0.0, 0.0, angle_of(orientation_wxyz), 0.0
