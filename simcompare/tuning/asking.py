"""Asking an engine in its own process, or the cache."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from simcompare.engine.backend import Backend, EngineBackend
from simcompare.engine.calibration import cache
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.errors import Unsupported
from simcompare.tuning.answers import answer
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Statement


@dataclass(frozen=True)
class Ask:
    """The question of a request, which an engine's process can be sent.

    Attributes:
        request: what is asked.
    """

    request: Request

    def __call__(self, backend: Backend) -> Statement:
        """Finds the answer, or takes it from the cache.

        Raises:
            Unsupported: the engine cannot be asked, or no numbers give it.
        """
        if not isinstance(backend, EngineBackend):
            raise Unsupported(f"{backend.name}: its backend is not on the kit, so cannot be tuned")
        return read(cache.kept(backend, self._asked, lambda: self._found(backend)))

    def known(self, backend: Backend) -> Mapping[str, Any] | None:
        """The answer as plain values where the cache has it."""
        return cache.known(backend, self._asked)

    @property
    def _asked(self) -> dict[str, Any]:
        return {"what": "contact", **asdict(self.request)}

    def _found(self, backend: EngineBackend) -> dict[str, Any]:
        try:
            return answer(backend, backend.load(), self.request).to_plain()
        except CannotCalibrate as error:  # that takes longest to find out
            return {"cannot": f"{backend.name}: {error}", "longest_step_s": error.longest_step_s}


def read(plain: Mapping[str, Any]) -> Statement:
    """A statement from plain values.

    Raises:
        CannotCalibrate: they say that there is none.
    """
    if "cannot" in plain:
        raise CannotCalibrate(plain["cannot"], plain["longest_step_s"])
    return Statement.from_plain(plain)
