"""How a sphere bounces on a plane: over the phase of the step, over impact speeds, over steps."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from simcompare.characterization.grids import first_edge, geometric
from simcompare.engine.backend import Backend, EngineBackend, refuse
from simcompare.engine.calibration import cache
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.calibration.drops import even_phases
from simcompare.engine.calibration.engine_drops import CLEAR_M, PAIR, EngineDrops
from simcompare.engine.calibration.tuned import calibrate
from simcompare.engine.helps import LANDING
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.model.settings import ASSISTED, TUNED, DropPlan, Settings

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
class BounceQuestion:
    """How an engine bounces at one contact level; called with its backend.

    Attributes:
        level: contact level.
        step_s: step at which the numbers of "tuned" are found [s].
        restitution: what is wanted [1].
        speed_m_s: impact for which these numbers are found [m/s].
        mass_kg: of the sphere.
        size_m: its diameter.
        gravity_m_s2: acceleration of free fall.
    """

    level: str
    step_s: float
    restitution: float = 0.8
    speed_m_s: float = 2.0
    mass_kg: float = 0.0027
    size_m: float = 0.04
    gravity_m_s2: float = 9.80665

    def __call__(self, backend: Backend) -> dict[str, Any]:
        """The answer as plain values, from the cache where it is known."""
        if not isinstance(backend, EngineBackend):
            raise Unsupported(f"{backend.name} is not built on simcompare's kit: it drops nothing")
        known = {"ask": "bounce", **asdict(self)}
        found = cache.kept(backend, known, lambda: self._found(backend))
        if "cannot" in found:
            raise Unsupported(found["cannot"])
        return found

    def _found(self, backend: EngineBackend) -> dict[str, Any]:
        try:
            return _Bouncer(self, backend).answer()
        except CannotCalibrate as error:  # that takes longest to find out
            return {"cannot": f"{backend.name}: {error}"}

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


@dataclass(frozen=True)
class Spread:
    """What the drops at one speed and step do, over the phases of the step.

    Attributes:
        mean: mean restitution [1]; a drop without a bounce counts as 0.
        scatter: standard deviation [1].
        least: smallest.
        most: largest.
        bounced: part of the drops that are followed by a flight.
    """

    mean: float
    scatter: float
    least: float
    most: float
    bounced: float


#: what runs away
RAN_AWAY = Spread(math.inf, math.nan, math.nan, math.inf, 1.0)


class _Bouncer:
    """Drops in one engine at one level."""

    def __init__(self, question: BounceQuestion, backend: EngineBackend) -> None:
        self._asked, self._backend = question, backend
        self._engine = backend.load()
        refuse(backend, self._drops(question.step_s).scenario, Settings(question.level))
        self.numbers = self._numbers(question.step_s)
        self.spread = functools.cache(self._spread)

    def _drops(self, step_s: float) -> EngineDrops:
        asked = self._asked
        return EngineDrops(
            self._backend, self._engine, asked.plan(step_s), asked.level, CLEAR_M
        )  # fmt: skip

    def _numbers(self, step_s: float) -> tuple[float, ...]:
        """The engine's own numbers at "tuned"; the restitution itself where it is typed in."""
        asked, lands = self._asked, LANDING in self._backend.helps
        if asked.level != TUNED and (asked.level != ASSISTED or lands):
            return (asked.restitution,)
        return calibrate(self._backend, self._engine, asked.plan(step_s)).numbers

    def restitutions(self, speed_m_s: float, step_s: float, numbers: tuple[float, ...]) -> Any:  # noqa: ANN401
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
            float(found.mean()), float(found.std()), float(found.min()), float(found.max()),
            float((found > 0).mean()),
        )  # fmt: skip

    def answer(self) -> dict[str, Any]:
        """Everything, as plain values."""
        asked = self._asked
        speeds = tuple(speed for speed in SPEEDS_M_S if speed >= asked.slowest_m_s)
        return {
            "numbers": list(self.numbers),
            "phases": even_phases(PHASES).tolist(),
            "over_phase": self._over_phase(),
            "over_speed": [
                {"speed_m_s": v, **asdict(self.spread(v, asked.step_s))} for v in speeds
            ],
            "over_step": [
                {"step_s": dt, **asdict(self.spread(asked.speed_m_s, dt))} for dt in STEPS_S
            ],
            "retuned": self._retuned(),
            "slowest_m_s": asked.slowest_m_s,
            "dies_below_m_s": self._dies_below(speeds),
            "hops_at_m_s": self._hops_at(speeds),
            "too_large": self._range(lambda one: one.mean <= (1 + OFF) * asked.restitution),
            "too_small": self._range(lambda one: one.mean >= (1 - OFF) * asked.restitution),
            "gains_above_s": self._up_to(STEPS_S, lambda one: one.most <= 1),
        }

    def _over_phase(self) -> list[float]:
        asked = self._asked
        return [float(e) for e in self.restitutions(asked.speed_m_s, asked.step_s, self.numbers)]

    def _dies_below(self, speeds: tuple[float, ...]) -> float | None:
        """Slower impacts give back less than half of what is wanted [m/s]; ``None``: none do."""
        asked = self._asked
        return first_edge(
            lambda v: self.spread(v, asked.step_s).mean >= asked.restitution / 2, speeds[::-1]
        )

    def _hops_at(self, speeds: tuple[float, ...]) -> float | None:
        """Slower impacts gain in the mean, faster ones lose: so it hops for ever [m/s]."""
        asked = self._asked
        slower = (_JUST_READ * asked.gravity_m_s2 * asked.step_s, *speeds)
        found = first_edge(lambda v: self.spread(v, asked.step_s).mean < 1, slower[::-1])
        return None if found == speeds[-1] else found  # if no impact loses, it gets faster

    def _range(self, is_right: Callable[[Spread], bool]) -> dict[str, float | None]:
        """Steps below and above the asked one at which something is no longer right."""
        at = self._asked.step_s
        shorter = (at, *(dt for dt in STEPS_S[::-1] if dt < at))
        longer = (at, *(dt for dt in STEPS_S if dt > at))
        return {
            "below_s": self._up_to(shorter, is_right),
            "above_s": self._up_to(longer, is_right),
        }

    def _up_to(self, steps_s: Sequence[float], is_right: Callable[[Spread], bool]) -> float | None:
        """The last of these steps up to which something is right [s]; ``None``: at all of them."""
        return first_edge(lambda dt: is_right(self.spread(self._asked.speed_m_s, dt)), steps_s)

    def _retuned(self) -> list[dict[str, Any]]:
        """The same over steps with numbers that are found anew at each; only at "tuned"."""
        found = []
        for step_s in STEPS_S if self._asked.level == TUNED else ():
            try:
                one = self.spread(self._asked.speed_m_s, step_s, self._numbers(step_s))
                found.append({"step_s": step_s, "reason": "", **asdict(one)})
            except CannotCalibrate as error:
                found.append({"step_s": step_s, "reason": str(error)})
        return found
