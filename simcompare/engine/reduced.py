"""Base for engines in reduced coordinates: free bodies and joints hold them, all else follows."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from simcompare.engine.helps.recoil import Motion
from simcompare.engine.scene import Scene
from simcompare.engine.simulation import Simulation
from simcompare.engine.state import BodyState
from simcompare.model.rotations import quaternions_of, rotate, rotation_vector_of
from simcompare.model.scenario import MOVABLE
from simcompare.model.shapes import Vector
from simcompare.model.trajectory import BODY_SIGNALS, Array
from simcompare.model.vectors import Numbers


@dataclass(frozen=True)
class FreeCoordinates:
    """How an engine lays out the coordinates and rates of a free body.

    Attributes:
        orientation: quaternions "wxyz" or "xyzw", or rotation "vector".
        rotation_first: whether orientation and rate come before position and velocity.
        body_rates: whether the rate is in the body's frame; else in the world's.
    """

    orientation: Literal["wxyz", "xyzw", "vector"] = "wxyz"
    rotation_first: bool = False
    body_rates: bool = False

    @property
    def sizes(self) -> tuple[int, int]:
        """Numbers of coordinates and of rates."""
        return (6 if self.orientation == "vector" else 7), 6

    @property
    def position(self) -> slice:
        """Where the position is among the coordinates."""
        return slice(3, 6) if self.rotation_first else slice(0, 3)

    @property
    def velocity(self) -> slice:
        """Where the velocity is among the rates."""
        return slice(3, 6) if self.rotation_first else slice(0, 3)

    def encode(self, state: BodyState) -> tuple[list[float], list[float]]:
        """Coordinates and rates of a state."""
        w, x, y, z = state.orientation_wxyz
        turn: Numbers
        rate: Numbers = state.rate_rad_s
        match self.orientation:
            case "wxyz":
                turn = (w, x, y, z)
            case "xyzw":
                turn = (x, y, z, w)
            case _:
                turn = rotation_vector_of((w, x, y, z)).tolist()
        if self.body_rates:
            back = np.asarray([[w, -x, -y, -z]])
            rate = rotate(back, np.asarray([rate], dtype=float))[0].tolist()
        if self.rotation_first:
            return [*turn, *state.position_m], [*rate, *state.velocity_m_s]
        return [*state.position_m, *turn], [*state.velocity_m_s, *rate]

    def decode(self, q: Array, v: Array) -> dict[str, Array]:
        """Signals of a body from its coordinates (n, 6 or 7) and rates (n, 6)."""
        turn, rate = (q[:, :-3], v[:, :3]) if self.rotation_first else (q[:, 3:], v[:, 3:])
        match self.orientation:
            case "wxyz":
                orientation = turn.copy()
            case "xyzw":
                orientation = np.roll(turn, 1, axis=1)
            case _:
                orientation = quaternions_of(turn)
        return {
            "position_m": q[:, self.position].copy(),
            "orientation_wxyz": orientation,
            "velocity_m_s": v[:, self.velocity].copy(),
            "rate_rad_s": rotate(orientation, rate) if self.body_rates else rate.copy(),
        }


class ReducedSimulation(Simulation):
    """A simulation in an engine of reduced coordinates.

    An adapter writes ``get``, ``put``, ``take_steps`` and ``set_engine_step``, and of ``give``,
    ``push``, ``twist``, ``spin_of``, ``joint_force`` and ``contact_force`` what its features need;
    then ``held``, ``snapshot`` and ``take_back``. A faster ``row`` says in ``slots`` where it has
    the coordinates and rates of everything.
    """

    #: how free bodies are laid out
    FREE = FreeCoordinates()

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        #: free body or joint -> where its coordinates and its rates begin in a row
        self.slots: dict[str, tuple[int, int]] = {}
        column, (size, rates) = 0, self.FREE.sizes
        for name in self._free:
            self.slots[name] = (column, column + size)
            column += size + rates
        for name in self._joints:
            self.slots[name] = (column, column + 1)
            column += 2

    @abstractmethod
    def get(self, name: str) -> tuple[Numbers, Numbers]:
        """Coordinates and rates of a free body or a joint."""

    @abstractmethod
    def put(self, name: str, q: Numbers | None, v: Numbers) -> None:
        """Sets them; the coordinates stay where ``q`` is ``None``."""

    def spin_of(self, body: str) -> Numbers:
        """Rate of a body in its own frame [rad/s]; for armatures where joints have none."""
        raise NotImplementedError

    def row(self) -> Sequence[float]:
        """Coordinates and rates of all free bodies and joints; engines may have a faster one."""
        found: list[float] = []
        for name in (*self._free, *self._joints):
            for part in self.get(name):
                found += part
        return found

    def motions(self, rows: Array) -> dict[str, Array]:
        """Signals of the free bodies and of the joints."""
        found: dict[str, Array] = {}
        for name, joint in self._joints.items():
            for part, column in zip(MOVABLE[joint.type], self.slots[name], strict=True):
                found[f"{name}.{part}"] = rows[:, column].copy()
        for name in self._free:
            q, v = (
                rows[:, first : first + size]
                for first, size in zip(self.slots[name], self.FREE.sizes, strict=True)
            )
            found |= {f"{name}.{part}": values for part, values in self.FREE.decode(q, v).items()}
        return found

    def velocity_in(self, row: Sequence[float], body: str) -> Vector:
        """Stored velocity of a free body in a row."""
        first = self.slots[body][1] + self.FREE.velocity.start
        return row[first], row[first + 1], row[first + 2]

    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        """Position and stored velocity of a free body."""
        q, v = self.get(body)
        x, y, z = q[self.FREE.position]
        vx, vy, vz = v[self.FREE.velocity]
        return (x, y, z), (vx, vy, vz)

    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        """Adds to a free body's stored velocity."""
        rates = [*self.get(body)[1]]
        for i, change in zip(range(6)[self.FREE.velocity], change_m_s, strict=True):
            rates[i] += change
        self.put(body, None, rates)

    def place(self, body: str, state: BodyState) -> None:
        """Puts a free body into a state."""
        self.put(body, *self.FREE.encode(state))

    def place_joint(self, joint: str, position: float, rate: float) -> None:
        """Puts a joint to a coordinate and a rate."""
        self.put(joint, [position], [rate])

    def place_all(self) -> None:
        """Puts everything to the start of the scene."""
        for name, body in self._free.items():
            parts = (getattr(body, part) for part in BODY_SIGNALS)
            self.place(name, BodyState(*parts))
        for name, joint in self._joints.items():
            self.place_joint(name, 0.0, joint.rate)

    def joint_motions(self) -> tuple[Sequence[float], Sequence[float]]:
        """Coordinates and stored rates of the driven joints."""
        motions = [self.get(name) for name in self.driven or ()]
        return [q[0] for q, _ in motions], [v[0] for _, v in motions]

    def rotor_motions(self) -> list[Motion]:
        """How the bodies with armatures move now."""
        rotors = self.recoil.rotors if self.recoil else ()
        return [(self.get(rotor.joint)[1][0], self.spin_of(rotor.child)) for rotor in rotors]

    def snapshot(self) -> object:
        """All coordinates and rates; for engines that remember nothing else."""
        return {name: self.get(name) for name in (*self._free, *self._joints)}

    def take_back(self, snapshot: object) -> None:
        """Sets all coordinates and rates."""
        assert isinstance(snapshot, dict)
        for name, (q, v) in snapshot.items():
            self.put(name, q, v)
