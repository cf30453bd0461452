"""Motion of free bodies as landing needs it: velocity at the instant of the position, and drag."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from simcompare.engine.helps import CENTRED_EFFORTS
from simcompare.engine.scene import Scene
from simcompare.model.scenario import Body
from simcompare.model.shapes import Vector

#: called as law(vx, vy, vz) with the stored velocity [m/s]; returns the force [N]
DragLaw = Callable[[float, float, float], Vector]


class FreeMotion(ABC):
    """The part of a simulation that knows how stored velocities belong to positions.

    Args:
        scene: what was built.

    Attributes:
        inner_steps: into how many the engine itself divides each of its steps; set before
            ``__init__``. What is given to it acts in all of them, velocities are stored half an
            inner step away from positions, and forces that are read are those of the last one. (The
            scenario's substeps are whole steps of the engine, between two samples.)
    """

    inner_steps: int = 1

    def __init__(self, scene: Scene) -> None:
        self.scene, self.scenario, self.settings = scene, scene.scenario, scene.settings
        scenario = self.scenario
        self._bodies = scenario.moving_bodies()
        self._free = scenario.free_bodies()
        self._dragged = _drags(self._bodies)
        self._gravity = scenario.world.gravity_m_s2
        self._stagger = 0.0
        self._engine_step_s = scenario.world.engine_step_s

    @property
    def step_now_s(self) -> float:
        """The engine step that is taken next [s]."""
        return self._engine_step_s or self.scenario.world.engine_step_s

    @abstractmethod
    def advance(self, count: int) -> None:
        """Takes ``count`` engine steps of the present length, with drag and drive in each."""

    @abstractmethod
    def set_engine_step(self, step_s: float) -> None:
        """Sets the length of the engine's step [s]."""

    @abstractmethod
    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        """Position [m] and stored velocity [m/s] of a free body."""

    @abstractmethod
    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        """Adds to a free body's stored velocity [m/s]."""

    def use_step(self, step_s: float, resting: frozenset[str]) -> None:
        """Changes the engine's step; moves the stored velocities of all bodies not at rest."""
        if step_s == self._engine_step_s:
            return
        change_s = self._stagger * (step_s - self._engine_step_s)
        for name in self._free:
            if name not in resting:
                _, velocity = self.stored_motion(name)
                ax, ay, az = self._free_acceleration(name, velocity)
                self.add_velocity(name, (ax * change_s, ay * change_s, az * change_s))
        self.set_engine_step(step_s)
        self._engine_step_s = step_s

    def motion_of(self, body: str) -> tuple[Vector, Vector]:
        """Position [m] and velocity [m/s] of a body at the same instant."""
        position, (vx, vy, vz) = self.stored_motion(body)
        ax, ay, az = self._free_acceleration(body, (vx, vy, vz))
        lead_s = -self._stagger * self._engine_step_s
        return position, (vx + ax * lead_s, vy + ay * lead_s, vz + az * lead_s)

    def velocity_in(self, row: Sequence[float], body: str) -> Vector:
        """Stored velocity [m/s] of a free body in a row that was recorded just now."""
        del row
        return self.stored_motion(body)[1]

    def drag_law(self, body: str) -> DragLaw:
        """Drag on a body from its stored velocity, for engine steps of the present length."""
        (factor, slowing), (gx, gy, gz) = self._dragged[body], self._gravity
        ahead_s = -self._stagger * self._engine_step_s
        if self._centres_drag:
            ahead_s = self._engine_step_s / 2

        def force(vx: float, vy: float, vz: float) -> Vector:
            slow = slowing * math.sqrt(vx * vx + vy * vy + vz * vz)
            x = vx + (gx - slow * vx) * ahead_s
            y = vy + (gy - slow * vy) * ahead_s
            z = vz + (gz - slow * vz) * ahead_s
            scale = -factor * math.sqrt(x * x + y * y + z * z)
            return scale * x, scale * y, scale * z

        return force

    @property
    def _centres_drag(self) -> bool:
        """Whether drag acts later than at the positions before a step, and is taken there."""
        later = self.scene.traits.positions_first or self.inner_steps > 1
        return later and self.settings.takes(CENTRED_EFFORTS)

    def _free_acceleration(self, name: str, velocity: Vector) -> Vector:
        gx, gy, gz = self._gravity
        drag = self._dragged.get(name)
        if drag is None:
            return gx, gy, gz
        vx, vy, vz = velocity
        slowing = drag.slowing_1_m * math.sqrt(vx * vx + vy * vy + vz * vz)
        return gx - slowing * vx, gy - slowing * vy, gz - slowing * vz


class _Drag(NamedTuple):
    """Drag on a body over the square of its speed, and the acceleration by it."""

    factor_kg_m: float
    slowing_1_m: float


def _drags(bodies: Mapping[str, Body]) -> dict[str, _Drag]:
    """Drag on every body that has it."""
    found = {}
    for name, body in bodies.items():
        if body.drag is not None and body.drag.factor_kg_m > 0:
            assert body.mass_kg is not None
            factor = body.drag.factor_kg_m
            found[name] = _Drag(factor, factor / body.mass_kg)
    return found
