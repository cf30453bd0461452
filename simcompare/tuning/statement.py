"""What numbers do in an engine's contact: a statement that holds, with its range and its cost."""

from __future__ import annotations

import math
from dataclasses import dataclass

from simcompare.model.plain import Finite
from simcompare.model.tuning import AtSpeed


@dataclass(frozen=True)
class Typed:
    """One parameter of an engine as it is typed in.

    Attributes:
        parameter: the engine's own name for it.
        value: what is typed in.
        unit: its unit.
        is_tuned: whether it stands for the restitution; else the loop needs it beside.
        note: what goes with it, such as the rule by which two bodies' values are combined.
    """

    parameter: str
    value: float
    unit: str
    is_tuned: bool = False
    note: str = ""


@dataclass(frozen=True)
class Range:
    """Where something holds, as far as it was looked.

    Attributes:
        low: lowest value with which it holds.
        high: highest one.
        below: what is wrong a little below; empty where it still holds at the lowest one tried.
        above: the same a little above.
    """

    low: float
    high: float
    below: str = ""
    above: str = ""


@dataclass(frozen=True)
class Statement:
    """What numbers do, measured on drops at 50 phases of the step.

    Attributes:
        restitution: what they stand for: what was asked for, or what was found; NaN where nothing
            bounces [1].
        numbers: the engine's numbers.
        typed: all that is typed in, the numbers first.
        at: what bounces do at speeds of the range that was asked for, the slowest first.
        holds_at_m_s: speeds at which they hold; ``None`` where they do at none that was asked for.
        holds_with_s: steps with which they hold at the ends and in the middle of those speeds that
            were asked for.
        longest_step_s: longest step with which other numbers hold at all speeds that were asked
            for, where these do not; ``None`` where it is not known.
        is_steadiest: whether of several contacts it is the one that scatters least, not the
            stiffest one.
        fault: what is wrong at speeds that were asked for and at which they do not hold.
        drops: how many drops it took.
    """

    restitution: Finite
    numbers: tuple[float, ...]
    typed: tuple[Typed, ...]
    at: tuple[AtSpeed, ...]
    holds_at_m_s: Range | None
    holds_with_s: Range | None
    longest_step_s: float | None = None
    fault: str = ""
    is_steadiest: bool = False
    drops: int = 0

    @property
    def bounces(self) -> tuple[AtSpeed, ...]:
        """Those of ``at`` in which every impact is followed by a flight."""
        return tuple(one for one in self.at if math.isfinite(one.restitution))
