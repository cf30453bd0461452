"""How a sphere bounces on a plane: over the phase of the step, over impact speeds, over steps."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from simcompare.characterization.behaviour import (
    BounceBehaviour,
    Spread,
    SpreadAtSpeed,
    SpreadAtStep,
    StepLimits,
)
from simcompare.characterization.experiment import Experiment, over_steps
from simcompare.characterization.grids import first_edge, geometric
from simcompare.engine.backend import Backend, EngineBackend, refuse
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.calibration.drops import even_phases
from simcompare.engine.calibration.engine_drops import CLEAR_M, PAIR, EngineDrops
from simcompare.engine.calibration.question import on_the_kit
from simcompare.engine.calibration.tuned import calibrate
from simcompare.engine.helps import LANDING
from simcompare.errors import SimulationDiverged
from simcompare.model.settings import ASSISTED, TUNED, DropPlan, Settings
from simcompare.model.trajectory import Array

#: drops at each speed and step, at even phases of the step
PHASES = 25
#: impacts that are tried, as far as hops can be read that slowly at the step [m/s]
SPEEDS_M_S = (
    0.01, 0.015, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0,
)  # fmt: skip
#: speeds at which hops last long enough to be read: always, and where no drop is lost [g·dt]
_READ, _JUST_READ = 5.0, 3.5
#: steps over which the bounce is looked at [s]
STEPS_S = geometric(0.25e-3, 8e-3, 11)
#: a mean restitution that is off by more than this part is too large, or too small
OFF = 0.01


@dataclass(frozen=True)
class BounceQuestion(Experiment[BounceBehaviour]):
    """How an engine bounces at one contact level.

    Attributes:
        restitution: what is wanted [1].
        speed_m_s: impact for which these numbers are found [m/s].
        mass_kg: of the sphere.
        size_m: its diameter.
        gravity_m_s2: acceleration of free fall.
    """

    kind = BounceBehaviour
    restitution: float = 0.8
    speed_m_s: float = 2.0
    mass_kg: float = 0.0027
    size_m: float = 0.04
    gravity_m_s2: float = 9.80665

    def answer(self, backend: Backend) -> BounceBehaviour:
        """Drops a sphere over speeds, phases and steps."""
        engine = on_the_kit(backend, " is not built on simcompare's kit: it drops nothing")
        try:
            return _Bouncer(self, engine).behaviour()
        except CannotCalibrate as error:
            raise error.of(backend.name) from None

    def plan(self, step_s: float) -> DropPlan:
        """The drop at another step."""
        return DropPlan(
            (PAIR,), self.restitution, self.speed_m_s, self.mass_kg, self.size_m,
            self.gravity_m_s2, step_s,
        )  # fmt: skip

    @property
    def slowest_m_s(self) -> float:
        """The slowest impact whose hop can be read at the step [m/s]."""
        return _READ * self.gravity_m_s2 * self.step_s


#: what runs away
RAN_AWAY = Spread(mean=math.inf, most=math.inf, bounced=1.0)


class _Bouncer:
    """Drops in one engine at one level."""

    def __init__(self, question: BounceQuestion, backend: EngineBackend) -> None:
        self._question, self._backend = question, backend
        self._engine = backend.load()
        refuse(backend, self._drops(question.step_s).scenario, Settings(question.level))
        self.numbers = self._numbers(question.step_s)
        self.spread = functools.cache(self._spread)

    def _drops(self, step_s: float) -> EngineDrops:
        question = self._question
        return EngineDrops(
            self._backend, self._engine, question.plan(step_s), question.level, CLEAR_M
        )

    def _numbers(self, step_s: float) -> tuple[float, ...]:
        """The engine's own numbers at "tuned"; the restitution itself where it is typed in."""
        question, lands = self._question, LANDING in self._backend.helps
        if question.level != TUNED and (question.level != ASSISTED or lands):
            return (question.restitution,)
        return calibrate(self._backend, self._engine, question.plan(step_s)).numbers

    def restitutions(self, speed_m_s: float, step_s: float, numbers: tuple[float, ...]) -> Array:
        """Restitution at each phase of the step (n,)."""
        found = self._drops(step_s)(numbers, speed_m_s, even_phases(PHASES)).restitution
        return np.nan_to_num(found, nan=0.0)

    def _spread(
        self, speed_m_s: float, step_s: float, numbers: tuple[float, ...] | None = None
    ) -> Spread:
        try:
            found = self.restitutions(speed_m_s, step_s, numbers or self.numbers)
        except SimulationDiverged:
            return RAN_AWAY
        return Spread(
            mean=float(found.mean()), scatter=float(found.std()), least=float(found.min()),
            most=float(found.max()), bounced=float((found > 0).mean()),
        )  # fmt: skip

    def behaviour(self) -> BounceBehaviour:
        """Everything."""
        question = self._question
        at_m_s, at_s = question.speed_m_s, question.step_s
        speeds = tuple(speed for speed in SPEEDS_M_S if speed >= question.slowest_m_s)
        return BounceBehaviour(
            numbers=self.numbers,
            phases=tuple(even_phases(PHASES).tolist()),
            over_phase=tuple(self.restitutions(at_m_s, at_s, self.numbers).tolist()),
            over_speed=tuple(
                SpreadAtSpeed(speed_m_s=v, **vars(self.spread(v, at_s))) for v in speeds
            ),
            over_step=over_steps(SpreadAtStep, STEPS_S, lambda dt: self.spread(at_m_s, dt)),
            retuned=self._retuned(),
            slowest_m_s=question.slowest_m_s,
            dies_below_m_s=self._dies_below(speeds),
            hops_at_m_s=self._hops_at(speeds),
            too_large=self._limits(lambda one: one.mean <= (1 + OFF) * question.restitution),
            too_small=self._limits(lambda one: one.mean >= (1 - OFF) * question.restitution),
            gains_above_s=self._up_to(STEPS_S, lambda one: one.most <= 1),
        )

    def _dies_below(self, speeds: tuple[float, ...]) -> float | None:
        """Slower impacts give back less than half of what is wanted [m/s]; ``None``: none do."""
        question = self._question
        return first_edge(
            lambda v: self.spread(v, question.step_s).mean >= question.restitution / 2,
            speeds[::-1],
        )

    def _hops_at(self, speeds: tuple[float, ...]) -> float | None:
        """Slower impacts gain in the mean, faster ones lose: so it hops for ever [m/s]."""
        question = self._question
        slower = (_JUST_READ * question.gravity_m_s2 * question.step_s, *speeds)
        found = first_edge(lambda v: self.spread(v, question.step_s).mean < 1, slower[::-1])
        return None if found == speeds[-1] else found  # if no impact loses, it gets faster

    def _limits(self, is_right: Callable[[Spread], bool]) -> StepLimits:
        """Steps below and above that of the question at which something is no longer right."""
        at = self._question.step_s
        shorter = (at, *(dt for dt in STEPS_S[::-1] if dt < at))
        longer = (at, *(dt for dt in STEPS_S if dt > at))
        return StepLimits(self._up_to(shorter, is_right), self._up_to(longer, is_right))

    def _up_to(self, steps_s: Sequence[float], is_right: Callable[[Spread], bool]) -> float | None:
        """The last of these steps up to which something is right [s]; ``None``: at all of them."""
        return first_edge(lambda dt: is_right(self.spread(self._question.speed_m_s, dt)), steps_s)

    def _retuned(self) -> tuple[SpreadAtStep, ...]:
        """The same over steps with numbers that are found anew at each; only at "tuned"."""
        steps_s = STEPS_S if self._question.level == TUNED else ()
        speed_m_s = self._question.speed_m_s
        return over_steps(
            SpreadAtStep, steps_s, lambda dt: self.spread(speed_m_s, dt, self._numbers(dt))
        )
