"""What the experiments have in common: a question at one contact level and step, and its scene."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from simcompare.engine.backend import Backend
from simcompare.engine.calibration.cache import Answer
from simcompare.engine.calibration.question import Question
from simcompare.errors import BackendError
from simcompare.model import scenes
from simcompare.model.scenario import Scenario
from simcompare.model.scenes import Parts
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory

Row = TypeVar("Row")


@dataclass(frozen=True)
class Experiment(Question[Answer]):
    """An experiment at one contact level.

    Attributes:
        level: contact level.
        step_s: the engine's step; of a bounce that at which its numbers are found.
    """

    level: str
    step_s: float

    def run(self, backend: Backend, scenario: Scenario) -> Trajectory:
        """What an engine makes of a scene at the level."""
        return backend.simulate(scenario, Settings(self.level))


def scene(
    name: str,
    bodies: Parts,
    duration_s: float,
    step_s: float,
    gravity_m_s2: tuple[float, float, float],
    **parts: object,
) -> Scenario:
    """A scene that lasts for whole steps, two at least."""
    count = max(2, math.ceil(duration_s / step_s - 1e-9))
    return scenes.scene(name, bodies, count * step_s, step_s, gravity_m_s2, **parts)


def over_steps(
    row: Callable[..., Row], steps_s: Sequence[float], look: Callable[[float], object]
) -> tuple[Row, ...]:
    """What an engine does at each step; where it refuses a step, the reason.

    Args:
        row: makes the record of a step.
        steps_s: the steps.
        look: tries it at a step; its record has the fields of ``row`` but ``step_s``.
    """
    found = []
    for step_s in steps_s:
        try:
            found.append(row(step_s=step_s, **vars(look(step_s))))
        except BackendError as error:
            found.append(row(step_s=step_s, reason=str(error)))
    return tuple(found)
