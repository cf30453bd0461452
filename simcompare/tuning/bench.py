"""A test bench for one engine's contact: drops at any speed and step, and what is wrong."""

from __future__ import annotations

import math
from types import ModuleType

from simcompare.engine.calibration.calibration import PHASES, Counted, measured
from simcompare.engine.calibration.drops import Drops, slowest_m_s
from simcompare.engine.calibration.engine_drops import CLEAR_M, EngineDrops, Tunable
from simcompare.engine.calibration.springs import DEPTH, SCATTER
from simcompare.errors import SimulationDiverged
from simcompare.model.audit import AuditRow
from simcompare.model.settings import TUNED
from simcompare.model.tuning import AtSpeed
from simcompare.tuning.request import Request

#: phases at which a statement is measured; its range is looked for with fewer
STATED = 2 * PHASES
#: what is said of impacts that were not tried
TOO_SLOW = "its flight is too short to be read at this step"
#: factor by which the scatter may be larger than what numbers are usually sought with, where they
#: still hold: else they would begin to fail right beside the speed for which they were sought
HELD = 1.5
Numbers = tuple[float, ...]


class Bench:
    """Drops for a request.

    Args:
        backend: the engine's backend.
        engine: the imported engine.
        request: what is asked.
    """

    def __init__(self, backend: Tunable, engine: ModuleType, request: Request) -> None:
        self._backend, self._engine, self.request = backend, engine, request
        self._benches: dict[float, Counted] = {}
        self.kind = backend.bounces_by
        deepest_m = DEPTH * request.size_m
        self.depth_m = deepest_m if request.depth_m is None else min(request.depth_m, deepest_m)
        #: whether the least scatter is wanted, whatever it is, instead of the stiffest contact
        self.wants_steadiest = request.depth_m is not None and request.scatter_part is None
        #: largest scatter with which numbers are sought, and with which they hold
        if request.scatter_part is None:
            self.scatter_part = math.inf if self.wants_steadiest else SCATTER
            self.most_scatter_part = HELD * SCATTER
        else:
            self.scatter_part = self.most_scatter_part = request.scatter_part

    def drops(self, step_s: float | None = None) -> Drops:
        """The engine's drops, at the step of the request or another one."""
        step_s = self.request.step_s if step_s is None else step_s
        if step_s not in self._benches:
            self._benches[step_s] = Counted(self._engine_drops(step_s))
        return self._benches[step_s]

    @property
    def count(self) -> int:
        """How many drops there were."""
        return sum(drops.count for drops in self._benches.values())

    def at(
        self,
        numbers: Numbers,
        speed_m_s: float,
        step_s: float | None = None,
        phases: int = PHASES,
    ) -> AtSpeed:
        """What bounces do; what runs away, or is too slow for a flight, has no restitution."""
        nothing = AtSpeed(speed_m_s, *(math.nan,) * 5)
        if speed_m_s < self.slowest_m_s(step_s):
            return nothing
        try:
            return measured(self.drops(step_s), numbers, speed_m_s, phases)
        except SimulationDiverged:
            return nothing

    def audit(self, numbers: Numbers) -> list[AuditRow]:
        """All that the engine was given, read back."""
        simulation = self._engine_drops(self.request.step_s).build(numbers)
        try:
            return list(simulation.audit)
        finally:
            simulation.close()

    def slowest_m_s(self, step_s: float | None = None) -> float:
        """Slowest impact that can be read at a step, that of the request or another one."""
        step_s = self.request.step_s if step_s is None else step_s
        return slowest_m_s(step_s, self.request.gravity_m_s2)

    def rebounds(self, found: AtSpeed) -> bool:
        """Whether every impact is followed by a flight, and none goes too deep."""
        return math.isfinite(found.restitution) and found.penetration_m <= self.depth_m

    def fault(self, found: AtSpeed, restitution: float) -> str:
        """Why a statement does not hold for what was found; empty where it does."""
        mean = found.restitution
        if found.speed_m_s < self.slowest_m_s():
            return TOO_SLOW
        if math.isnan(mean):
            return "not every impact is followed by a flight"
        if abs(mean / restitution - 1) > self.request.within:
            return f"the restitution is {mean:.4f}"
        if found.scatter > self.most_scatter_part * restitution:
            return f"it scatters by ±{found.scatter:.2g}"
        if found.penetration_m > self.depth_m:
            deep_m = found.penetration_m
            return f"it sinks {deep_m:.3g} m" if deep_m >= 1 else f"it sinks {1e3 * deep_m:.3g} mm"
        return ""

    def of(self, request: Request) -> Bench:
        """The same engine for another request."""
        return Bench(self._backend, self._engine, request)

    def _engine_drops(self, step_s: float) -> EngineDrops:
        request = self.request
        clear_m = 0.0 if request.level == TUNED else CLEAR_M
        plan = request.plan(step_s)
        return EngineDrops(self._backend, self._engine, plan, request.level, clear_m)
