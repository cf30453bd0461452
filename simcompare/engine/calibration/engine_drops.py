"""Drops of a sphere on a plane in an engine, each from another phase of the time step."""

from __future__ import annotations

import math
from types import ModuleType
from typing import Protocol

import numpy as np

from simcompare.engine.calibration import drops
from simcompare.engine.calibration.drops import Bounces
from simcompare.engine.simulation import Simulation
from simcompare.engine.state import BodyState, State
from simcompare.errors import SimulationDiverged
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import scene
from simcompare.model.settings import ASSISTED, TUNED, DropPlan, PairNumbers, Settings
from simcompare.model.trajectory import Array


class Tunable(Protocol):
    """What a backend offers to be tuned."""

    @property
    def name(self) -> str:
        """The engine's name."""

    @property
    def bounces_by(self) -> str:
        """What stands for a pair's restitution in it."""

    def version(self) -> str:
        """Version of the engine."""

    def build(self, engine: ModuleType, scenario: Scenario, settings: Settings) -> Simulation:
        """Builds a scene."""


#: what drops, and what it drops on
BALL, FLOOR = PAIR = ("ball", "floor")
#: height from which drops begin where an engine may foresee a contact (Bullet does 20 mm ahead) [m]
CLEAR_M = 0.04
#: weakest gravity with which a drop is read; without any it would have no apex [m/s²]
MIN_GRAVITY_M_S2 = 0.1
#: steps that are recorded at once, and at most
_CHUNK, _MAX_HEIGHTS = 48, 1200
#: recorded steps that are taken at once where impacts are landed on, one by one
_LANDED = 12
#: free steps before and after a contact that are recorded at least
_BEFORE = _AFTER = 6


class EngineDrops:
    """Drops of a sphere on a fixed plane, in an engine's plain loop.

    Args:
        backend: the engine's backend.
        engine: the imported engine.
        plan: what is dropped.
        level: contact level of everything but the numbers.
        clear_m: height from which a drop begins, where its speed allows; an engine may foresee a
            contact before it is there [m].
    """

    def __init__(
        self,
        backend: Tunable,
        engine: ModuleType,
        plan: DropPlan,
        level: str = TUNED,
        clear_m: float = 0.0,
    ) -> None:
        self._backend, self._engine, self._plan, self._level = backend, engine, plan, level
        self._clear_m = clear_m
        self._gravity = max(plan.gravity_m_s2, MIN_GRAVITY_M_S2)
        self._scene = _scene(plan, self._gravity)

    def __call__(self, numbers: tuple[float, ...], speed_m_s: float, phases: Array) -> Bounces:
        """Lets the sphere drop once for every phase."""
        simulation = self.build(numbers)
        try:
            heights = [self._heights(simulation, speed_m_s, float(phase)) for phase in phases]
        finally:
            simulation.close()
        radius_m = self._plan.size_m / 2
        free_part = drops.FREE_PART if Settings(self._level).gives(TUNED) else drops.BRAKED_PART
        return drops.read_drops(heights, self._plan.step_s, self._gravity, radius_m, free_part)

    def build(self, numbers: tuple[float, ...]) -> Simulation:
        """The sphere above the plane, with these numbers."""
        pair = PairNumbers(PAIR, numbers)
        helps: frozenset[str] | None = None
        if self._level == ASSISTED:
            helps = getattr(self._backend, "helps", frozenset())
        settings = Settings(self._level, helps=helps, numbers=(pair,))
        return self._backend.build(self._engine, self._scene, settings)

    @property
    def scenario(self) -> Scenario:
        """The scene."""
        return self._scene

    def _heights(self, simulation: Simulation, speed_m_s: float, phase: float) -> Array:
        """Height above the plane at every step, until the sphere has left it again."""
        step_s, radius = self._plan.step_s, self._plan.size_m / 2
        before = self._steps_before(speed_m_s)
        height, speed = drops.start_above(speed_m_s, phase, step_s, self._gravity, before)
        ball = BodyState((0.0, 0.0, height + radius), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, -speed),
                         (0.0, 0.0, 0.0))  # fmt: skip
        simulation.set_state(State(0.0, {BALL: ball}, step_s))
        found = np.array([height])
        while len(found) < _MAX_HEIGHTS:
            more = self._next(simulation) - radius
            if not np.isfinite(more).all():
                raise SimulationDiverged("the drops that calibrate its contact ran away")
            found = np.concatenate((found, more))
            rises = np.diff(found) > 0
            has_fallen = np.logical_or.accumulate(~rises)  # a slow one is first on its way up
            left = np.flatnonzero((found[1:-1] > 0) & rises[1:] & has_fallen[:-1])
            # from some sample on it rises above the plane, for long enough to be read
            if len(left) and len(found) - left[0] > _AFTER:
                return found
            if np.ptp(more) < 1e-12:  # it rests
                break
        return found

    def _steps_before(self, speed_m_s: float) -> int:
        """Whole steps of the flight before the impact."""
        apex_s = speed_m_s / self._gravity
        squared = apex_s**2 - 2 * self._clear_m / self._gravity
        time_s = apex_s - math.sqrt(squared) if squared > 0 else apex_s
        return max(_BEFORE, math.floor(time_s / self._plan.step_s))

    def _next(self, simulation: Simulation) -> Array:
        """Heights of the centre after some more steps [m]."""
        if self._level != ASSISTED:
            rows = np.asarray(simulation.record(_CHUNK), dtype=float)
            return np.asarray(simulation.motions(rows)[f"{BALL}.position_m"][:, 2])
        heights = []
        for _ in range(_LANDED):
            simulation.step()
            heights.append(simulation.motion_of(BALL)[0][2])
        return np.array(heights)


def _scene(plan: DropPlan, gravity_m_s2: float) -> Scenario:
    moment = 0.4 * plan.mass_kg * (plan.size_m / 2) ** 2
    ball = {
        "mass_kg": plan.mass_kg,
        "inertia_kg_m2": [moment] * 3,
        "position_m": [0, 0, plan.size_m + plan.speed_m_s * plan.step_s],
        "shapes": [{"type": "sphere", "radius_m": plan.size_m / 2}],
    }
    floor = {"fixed": True, "shapes": [{"type": "plane", "normal": [0, 0, 1]}]}
    return scene(
        "drop", {FLOOR: floor, BALL: ball}, 1000 * plan.step_s, plan.step_s,
        (0.0, 0.0, -gravity_m_s2),
        contacts=[{"pair": list(PAIR), "restitution": plan.restitution}],
    )  # fmt: skip
