"""What a fit found for one engine's plain loop: its own numbers, and what it does with them."""

from __future__ import annotations

from dataclasses import dataclass, field

from simcompare.fitting.bounces.deviations import Deviation
from simcompare.fitting.bounces.engine_fit import EngineFit
from simcompare.model.trajectory import Array
from simcompare.model.tuning import TuningRow
from simcompare.results.records.fit_engines import Impact, Number


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
    impacts: tuple[Impact, ...] = ()
    penetration_m: float = 0.0
    tuning: tuple[TuningRow, ...] = field(default=(), repr=False)
    held: tuple[Deviation, ...] = ()
    held_m: tuple[Array, ...] = ()
    phases: int = 0
