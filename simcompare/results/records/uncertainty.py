"""What uncertainty.json says of a result and its uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.propagation.inputs import Input
from simcompare.propagation.propagated import Propagated
from simcompare.results.records.answered import Answered
from simcompare.running.jobs import OK, exit_code_of

#: ways to a result that are no engines
FORMULA, CLOSED_FORM = "formula", "closed form"


@dataclass(frozen=True)
class Way:
    """The result by a formula, the closed form or an engine.

    Attributes:
        source: "formula", "closed form", or the engine's name.
        contact: the engine's contact level, empty for mathematics.
        status: "ok", "unsupported", "missing" or "failed".
        reason: one sentence where the status is not "ok".
        version: the engine's version.
        found: the result with its uncertainty, where the status is "ok".
        runs: simulations that were run for it.
    """

    source: str
    contact: str = ""
    status: str = OK
    reason: str | None = None
    version: str | None = None
    found: Propagated | None = None
    runs: int = 0


@dataclass(frozen=True, kw_only=True)
class Uncertainty(Answered):
    """How well a result is known.

    Attributes:
        subject: name of the scenario, or the formula.
        of: the result; empty for that of a formula.
        unit: its unit.
        inputs: what is uncertain.
        correlation: pairs of inputs with their coefficients.
        ways: to the result, mathematics first.
        beyond: why the closed form does not hold, or not for all that the inputs may be.
        cautions: what of a robot is left out, each without a full stop.
        command: that makes it again.
    """

    subject: str
    of: str
    unit: str
    inputs: tuple[Input, ...]
    correlation: tuple[tuple[str, str, float], ...] = ()
    ways: tuple[Way, ...]
    beyond: tuple[str, ...] = ()
    cautions: tuple[str, ...] = ()
    command: str

    @property
    def known(self) -> tuple[tuple[Way, Propagated], ...]:
        """The ways that have a result."""
        return tuple((way, way.found) for way in self.ways if way.found is not None)

    @property
    def exit_code(self) -> int:
        """0 fine, 3 an engine is broken, or one that was named is missing."""
        statuses = [way.status for way in self.ways]
        return exit_code_of(statuses, self.engines_asked, out_of_reach=True)
