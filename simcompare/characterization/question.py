"""What the experiments have in common: a question to an engine at one level and step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from simcompare.engine.backend import Backend
from simcompare.engine.calibration import cache


@dataclass(frozen=True)
class Question(ABC):
    """An experiment at one contact level; called with a backend.

    Attributes:
        name: of the experiment.
        level: contact level.
        step_s: the engine's step [s].
    """

    name: ClassVar[str]
    level: str
    step_s: float

    def __call__(self, backend: Backend) -> dict[str, Any]:
        """The answer as plain values, from the cache where it is known."""
        known = {"ask": self.name, **asdict(self)}
        return cache.kept(backend, known, lambda: self.answer(backend))

    @abstractmethod
    def answer(self, backend: Backend) -> dict[str, Any]:
        """Tries it in the engine."""
