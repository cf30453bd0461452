"""A question to an engine whose answer is kept."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Generic

from simcompare.engine.backend import Backend, EngineBackend
from simcompare.engine.calibration import cache
from simcompare.engine.calibration.cache import Answer
from simcompare.errors import Unsupported


class Question(ABC, Generic[Answer]):
    """A frozen record of what is asked; called with a backend, also in an engine's own process.

    Attributes:
        kind: type of the answer.
    """

    kind: ClassVar[type[Any]]

    def __call__(self, backend: Backend) -> Answer:
        """The answer, from the cache where it is known.

        Raises:
            Unsupported: the engine cannot be asked, or there is no answer.
        """
        found: Answer = cache.kept(backend, self, self.kind, lambda: self.answer(backend))
        return found

    def known(self, backend: Backend) -> Answer | None:
        """The answer where the cache has it.

        Raises:
            CannotCalibrate: it says that there is none.
        """
        return cache.known(backend, self, self.kind)

    @abstractmethod
    def answer(self, backend: Backend) -> Answer:
        """Finds the answer in the engine."""


def on_the_kit(backend: Backend, otherwise: str) -> EngineBackend:
    """A backend that is built on the kit.

    Raises:
        Unsupported: it is not; ``otherwise`` says what that means.
    """
    if not isinstance(backend, EngineBackend):
        raise Unsupported(f"{backend.name}{otherwise}")
    return backend
