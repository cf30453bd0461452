"""Motion of free bodies as landing needs it: velocity at the instant of the position, and drag."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

from simcompare.engine.helps import CENTRED_EFFORTS
from simcompare.engine.helps.centred_efforts import drag_at
from simcompare.engine.scene import Scene
from simcompare.model.scenario import Body
from simcompare.model.shapes import Vector


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
        self._dragged = any(has_drag(body) for body in self._bodies.values())
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

    def drag_forces(self) -> list[tuple[str, Vector]]:
        """Drag [N] on every body that has it, at velocities of the instant at which it acts."""
        forces = []
        later = self.scene.traits.positions_first or self.inner_steps > 1
        centred = self.settings.takes(CENTRED_EFFORTS) and later
        for name, body in self._bodies.items():
            if not has_drag(body):
                continue
            assert body.drag is not None
            if centred:
                _, velocity = self.stored_motion(name)
                change, ahead_s = self._free_acceleration(name, velocity), self._engine_step_s / 2
                forces.append((name, drag_at(body, velocity, change, ahead_s)))
                continue
            _, (vx, vy, vz) = self.motion_of(name)
            scale = -body.drag.factor_kg_m * math.sqrt(vx * vx + vy * vy + vz * vz)
            forces.append((name, (scale * vx, scale * vy, scale * vz)))
        return forces

    def _free_acceleration(self, name: str, velocity: Vector) -> Vector:
        body = self._bodies[name]
        gx, gy, gz = self.scenario.world.gravity_m_s2
        if not has_drag(body):
            return gx, gy, gz
        assert body.drag is not None
        assert body.mass_kg is not None
        vx, vy, vz = velocity
        per_mass = body.drag.factor_kg_m / body.mass_kg * math.sqrt(vx * vx + vy * vy + vz * vz)
        return gx - per_mass * vx, gy - per_mass * vy, gz - per_mass * vz


def has_drag(body: Body) -> bool:
    """Whether air drag acts on a body."""
    return body.drag is not None and body.drag.factor_kg_m > 0
