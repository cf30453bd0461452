"""What a fit found for one engine's plain loop: its own numbers, and what it does with them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from simcompare.fitting.bounces.beside import Bouncing
from simcompare.fitting.bounces.engine_fit import EngineFit
from simcompare.fitting.bounces.likelihood import COVERAGE
from simcompare.model.plain import plain
from simcompare.model.trajectory import Array
from simcompare.model.tuning import TuningRow


@dataclass(frozen=True)
class Number:
    """One of an engine's own numbers for the restitution.

    Attributes:
        name: the engine's parameter.
        value: as it is typed in.
        u: standard uncertainty, 0 where it was chosen.
        unit: of it.
    """

    name: str
    value: float
    u: float
    unit: str


@dataclass(frozen=True)
class TunedFit(EngineFit):
    """What a user types into a plain loop of one engine, and what it then does.

    Attributes:
        numbers: the engine's own, for the restitution.
        step_s: the engine step for which they hold [s].
        restitution: what they were tuned to at the first recorded impact, and its u.
        impacts: what each recorded impact showed, drop by drop.
        penetration_m: largest depth in the drops [m].
        tuning: how the numbers were found.
        held: what the held-out drops showed.
        held_m: heights of their apexes in the plain loop, the drop first [m].
        phases: at how many phases of the step each drop was run.
    """

    numbers: tuple[Number, ...] = ()
    step_s: float = 0.0
    restitution: tuple[float, float] = (0.0, 0.0)
    impacts: tuple[Mapping[str, Any], ...] = ()
    penetration_m: float = 0.0
    tuning: tuple[TuningRow, ...] = field(default=(), repr=False)
    held: tuple[Bouncing, ...] = ()
    held_m: tuple[Array, ...] = ()
    phases: int = 0

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        found = super().to_dict()
        if self.fit is None:
            return found
        first = plain(self.tuning[0].at[0]) if self.tuning and self.tuning[0].at else {}
        return {
            **found,
            "step_s": self.step_s,
            "numbers": [vars(number) for number in self.numbers],
            "impacts": [dict(row) for row in self.impacts],
            "contact_of_first_impact": {
                "penetration_m": self.penetration_m,
                "contact_s": first.get("contact_s"),
                "delay_s": first.get("delay_s"),
            },
            "phases": self.phases,
            "tuning": [plain(row) for row in self.tuning],
        }

    def parameters(self) -> dict[str, dict[str, Any]]:
        """The closed form's, with the one restitution to which the engine was tuned."""
        found = super().parameters()
        found.pop("exponent", None)
        if "restitution" in found:
            value, u = self.restitution
            row = found["restitution"]
            if not math.isclose(value, row["value"], rel_tol=1e-9):
                half = COVERAGE * u
                row |= {"value": value, "u": u, "interval95": [value - half, value + half]}
        return found
