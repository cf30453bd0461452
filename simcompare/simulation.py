"""One open scene in an engine: the stepping form, and the recording loop built on it."""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare.audit import Audit, AuditRow
from simcompare.errors import Unsupported
from simcompare.landing import ContactSteps, Landing, approaches
from simcompare.scenario import Body, Scenario
from simcompare.shapes import Vector
from simcompare.trajectory import BODY_SIGNALS, Array, Trajectory


@dataclass(frozen=True)
class BodyState:
    """Motion of one body: position [m], orientation wxyz, velocity [m/s], rate [rad/s]; world."""

    position_m: tuple[float, ...]
    orientation_wxyz: tuple[float, ...]
    velocity_m_s: tuple[float, ...]
    rate_rad_s: tuple[float, ...]


@dataclass(frozen=True)
class State:
    """State of a simulation after a whole number of recorded steps.

    Attributes:
        time_s: time since the scenario's start [s].
        bodies: motion of every moving body.
        velocity_step_s: engine step to which the stored velocities belong [s]; see ``landing``.
    """

    time_s: float
    bodies: Mapping[str, BodyState]
    velocity_step_s: float = field(default=0.0)


class Simulation(ABC):
    """An opened scene. Engines implement the small hooks; everything else is here.

    Args:
        scenario: the scene.
        audit: what the backend set and read back.
        steps: how the engine is stepped through an impact; ``None`` takes the step as it is.
    """

    wall_s: Mapping[str, float]

    def __init__(
        self, scenario: Scenario, audit: Sequence[AuditRow], steps: ContactSteps | None
    ) -> None:
        self.scenario = scenario
        self.audit = tuple(audit)
        self.notes: tuple[str, ...] = ()
        self.wall_s = {}
        self._bodies = scenario.moving_bodies()
        self._count = 0
        self._stagger = 0.0
        self._landing: Landing | None = None
        self._engine_step_s = scenario.world.step_s
        if steps is not None:
            self._prepare_landing(steps)

    def _prepare_landing(self, steps: ContactSteps) -> None:
        pairs, notes = approaches(self.scenario)
        self.notes = tuple(notes)
        if not pairs:
            return
        self._landing = Landing(pairs, self.scenario.world.step_s, steps)
        self._stagger = steps.stagger
        # the scenario's initial velocities are not staggered: they belong to a step of length zero
        self._engine_step_s = 0.0
        self.notes += (
            f"a recorded step with an impact in it is divided into {self._landing.parts} parts"
            f" of {self._landing.part_s:.3g} s; flights take whole steps",
        )

    # --- hooks of an engine -------------------------------------------------------------------

    @abstractmethod
    def advance(self, count: int) -> None:
        """Takes ``count`` engine steps of the present length, with drag applied in each."""

    @abstractmethod
    def set_engine_step(self, step_s: float) -> None:
        """Sets the length of the engine's step [s]."""

    @abstractmethod
    def stored_motion(self, body: str) -> tuple[Vector, Vector]:
        """Position [m] and stored velocity [m/s] of a body."""

    @abstractmethod
    def add_velocity(self, body: str, change_m_s: Vector) -> None:
        """Adds to a body's stored velocity [m/s]."""

    @abstractmethod
    def place(self, body: str, state: BodyState) -> None:
        """Puts a body into a state."""

    @abstractmethod
    def row(self) -> Sequence[float]:
        """Everything that is recorded now, in the engine's own layout and as cheap as possible."""

    @abstractmethod
    def signals(self, rows: Array) -> dict[str, Array]:
        """Turns rows (n, k) of the engine's layout into the signals of a trajectory."""

    def record(self, count: int) -> list[Sequence[float]] | Array:
        """Takes ``count`` whole recorded steps free of impacts and returns their rows.

        Engines override this with their tightest loop.
        """
        rows = []
        for _ in range(count):
            self.advance(1)
            rows.append(self.row())
        return rows

    def check(self) -> None:
        """Raises ``SimulationDiverged`` if the engine has warned of wrong numbers."""
        return

    def close(self) -> None:
        """Releases what the engine holds."""
        return

    def read_back_start(self, engine: str) -> None:
        """Compares the initial motion that the engine holds with the scenario's.

        Raises:
            ReadBackMismatch: they differ; every component that does is named.
        """
        audit = Audit(engine, relative=1e-6)
        for name, held in self.state.bodies.items():
            body = self._bodies[name]
            for part in BODY_SIGNALS:
                wanted, got = getattr(body, part), getattr(held, part)
                for axis, a, b in zip("wxyz"[-len(wanted) :], wanted, got, strict=True):
                    clean = a if abs(a - b) < 1e-12 else b  # rounding about 0 is no difference
                    audit.add(f"{name}.{part}.{axis}", a, "state", (a, clean), "")
        audit.finish()

    # --- the stepping form --------------------------------------------------------------------

    @property
    def time_s(self) -> float:
        """Time since the scenario's start [s]."""
        return self._count * self.scenario.world.step_s

    def step(self, inputs: Mapping[str, float] | None = None) -> None:
        """Advances by one recorded step.

        Args:
            inputs: values of the scenario's inputs during this step.

        Raises:
            Unsupported: inputs are given and this engine has no actuators.
        """
        if inputs:
            raise Unsupported(f"no actuator takes the inputs {', '.join(inputs)}")
        if self._landing is None:
            self.advance(1)
        elif self._landing.free_steps(self) >= 1:
            self.use_step(self.scenario.world.step_s, frozenset())
            self.advance(1)
        else:
            self._landing.step(self)
        self._count += 1
        self.check()

    @property
    def state(self) -> State:
        """The present state; ``set_state`` brings it back."""
        signals = self.signals(np.array([self.row()], dtype=float))
        bodies = {
            name: BodyState(
                *(tuple(signals[f"{name}.{part}"][0].tolist()) for part in BODY_SIGNALS)
            )
            for name in self._bodies
        }
        return State(self.time_s, bodies, self._engine_step_s)

    def set_state(self, state: State) -> None:
        """Puts all moving bodies into a state that ``state`` returned."""
        for name, body in state.bodies.items():
            self.place(name, body)
        self._count = round(state.time_s / self.scenario.world.step_s)
        self._engine_step_s = state.velocity_step_s
        self.set_engine_step(state.velocity_step_s or self.scenario.world.step_s)

    # --- what landing uses --------------------------------------------------------------------

    def use_step(self, step_s: float, resting: frozenset[str]) -> None:
        """Changes the engine's step; moves the stored velocities of all bodies not at rest."""
        if step_s == self._engine_step_s:
            return
        change_s = self._stagger * (step_s - self._engine_step_s)
        for name in self._bodies:
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
        """Drag [N] on every body that has it, at velocities of the same instant as positions."""
        forces = []
        for name, body in self._bodies.items():
            if has_drag(body):
                assert body.drag is not None
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

    # --- the whole run ------------------------------------------------------------------------

    def run(self, source: str, version: str) -> Trajectory:
        """Records the scenario from its start to its end.

        Args:
            source: name of the engine.
            version: its version.
        """
        started = time.perf_counter()
        world = self.scenario.world
        count = round(world.duration_s / world.step_s)
        blocks: list[list[Sequence[float]] | Array] = [[self.row()]]
        done = 0
        while done < count:
            free = count if self._landing is None else self._landing.free_steps(self)
            if free:
                taken = min(free, count - done)
                self.use_step(world.step_s, frozenset())
                blocks.append(self.record(taken))
            else:
                assert self._landing is not None
                taken = 1
                self._landing.step(self)
                blocks.append([self.row()])
            done += taken
        self._count += count
        self.check()
        rows = np.concatenate([np.asarray(block, dtype=float) for block in blocks])
        stepped = {"step": time.perf_counter() - started}
        return Trajectory(
            source=source,
            time_s=sample_times(self.scenario),
            signals=self.signals(rows),
            version=version,
            wall_s={**self.wall_s, **stepped},
            audit=self.audit,
            notes=self.notes,
        )


def sample_times(scenario: Scenario) -> Array:
    """Times of all samples of a scenario [s], the start included."""
    count = round(scenario.world.duration_s / scenario.world.step_s)
    return np.asarray(np.arange(count + 1) * scenario.world.step_s, dtype=float)


def has_drag(body: Body) -> bool:
    """Whether air drag acts on a body."""
    return body.drag is not None and body.drag.factor_kg_m > 0
