"""What the experiments have in common: a question to an engine at one contact level and step."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.engine.calibration.cache import Answer
from simcompare.engine.calibration.question import Question


@dataclass(frozen=True)
class Experiment(Question[Answer]):
    """An experiment at one contact level.

    Attributes:
        level: contact level.
        step_s: the engine's step; of a bounce that at which its numbers are found.
    """

    level: str
    step_s: float
