"""The question of a request to an engine."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.engine.backend import Backend
from simcompare.engine.calibration.calibration import CannotCalibrate
from simcompare.engine.calibration.question import Question, on_the_kit
from simcompare.tuning.request import Request
from simcompare.tuning.statement import Statement
from simcompare.tuning.statements import statement_for


@dataclass(frozen=True)
class StatementQuestion(Question[Statement]):
    """Which numbers give a restitution, or the other way round.

    Attributes:
        request: what is asked.
    """

    kind = Statement
    request: Request

    def answer(self, backend: Backend) -> Statement:
        """Finds it with drops in the engine.

        Raises:
            Unsupported: the engine cannot be asked.
            CannotCalibrate: no numbers give it.
        """
        engine = on_the_kit(backend, ": its backend is not on the kit, so cannot be tuned")
        try:
            return statement_for(engine, engine.load(), self.request)
        except CannotCalibrate as error:
            raise error.of(backend.name) from None
