"""What fit.json says of a fit to bounces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from simcompare.model.settings import TUNED
from simcompare.results.records.fit_engines import BouncesEngine, OneRestitution, RunWith, Target
from simcompare.results.records.fit_forms import (
    Bootstrap,
    Choice,
    Form,
    Law,
    OtherEstimate,
    ProfileRow,
    Ratios,
    Residuals,
)
from simcompare.results.records.fit_holdout import Holdout
from simcompare.results.records.fit_parts import (
    AnyKind,
    Budget,
    Known,
    Numbers,
    Open,
)

#: version of what is stored
FORMAT = 2


@dataclass(frozen=True)
class Rejected:
    """An impact or sample that was left out.

    Attributes:
        what: "impact" or "sample".
        number: its place among all that were recorded, first is 1.
        time_s: when, on the recording's clock [s].
        reason: why it was left out.
    """

    what: str
    number: int
    time_s: float
    reason: str


@dataclass(frozen=True)
class Drop:
    """What was measured of one drop; what is unknown is ``None``.

    Attributes:
        kind: where it comes from.
        source: name of the file.
        numbers: which impact each time belongs to.
        times_s: impact times [s].
        u_s: their standard uncertainties [s].
        height_numbers: after which impact each height comes; 0 is the drop itself.
        heights_m: of the apexes [m].
        u_heights_m: their standard uncertainties [m].
        samples: of height against time.
        dropped: what was left out.
        missed: numbers of impacts that were not recorded.
        notes: what else must be known.
        interval_numbers: at which impact each measured interval begins.
        intervals_s: times between neighbouring impacts [s].
        u_intervals_s: their standard uncertainties [s].
    """

    kind: str
    source: str
    numbers: tuple[int, ...]
    times_s: Numbers
    u_s: Open
    height_numbers: tuple[int, ...]
    heights_m: Numbers
    u_heights_m: Open
    samples: int
    dropped: tuple[Rejected, ...]
    missed: tuple[int, ...]
    notes: tuple[str, ...]
    interval_numbers: tuple[int, ...] = ()
    intervals_s: Numbers = ()
    u_intervals_s: Open = ()


@dataclass(frozen=True)
class Valid:
    """Where a fit holds: slowest and fastest impact, time between samples, step of the engines."""

    speed_m_s: tuple[float, float]
    step_s: float
    engine_step_s: float


@dataclass(frozen=True, kw_only=True)
class BouncesFit(AnyKind):
    """What fit.json says of a fit to bounces.

    Attributes:
        by: the kind.
        format: version of what is stored.
        measured: the drops that were fitted.
        dropped: what was left out of them, in words.
        held_out: the drops that were not.
        closed_form: the chosen one.
        choice: and the others.
        bootstrap: how its unknowns scatter.
        identifiability: what the data can tell of them.
        residuals: of the closed form.
        law: restitution against speed.
        ratios: of single bounces.
        profiles: of its unknowns.
        one_number: what engines have for a restitution that depends on the speed; ``None`` where it
            does not. All else that they are given is the closed form's.
        tuned_to: the impact to which engines were tuned.
        tuned_mean: mean restitution of the closed form over the impacts that engines resolve.
        u_tuned_mean: its standard uncertainty, as if those of the impacts were one error.
        sources: the engines.
        run_with: with what a run repeats the fit.
        holdout: what is predicted of the drops that were not fitted.
        budgets: where the uncertainty of each quantity comes from.
        other_estimates: restitutions by other rules.
        valid: where it holds.
    """

    by: Literal["bounces"] = "bounces"
    format: int = FORMAT
    measured: tuple[Drop, ...]
    dropped: Annotated[tuple[str, ...], Field(alias="told")] = ()
    held_out: tuple[Drop, ...]
    closed_form: Form
    choice: Choice
    bootstrap: Bootstrap
    identifiability: Known
    residuals: Annotated[tuple[Residuals, ...], Field(alias="left")]
    law: Law
    ratios: tuple[Ratios, ...]
    profiles: tuple[ProfileRow, ...]
    one_number: OneRestitution | None = None
    tuned_to: Target | None
    tuned_mean: float | None
    u_tuned_mean: float | None = None
    sources: tuple[BouncesEngine, ...]
    run_with: RunWith
    holdout: Holdout
    budgets: tuple[Budget, ...] = ()
    other_estimates: tuple[OtherEstimate, ...]
    valid: Valid

    @property
    def is_tuned(self) -> bool:
        """Whether engines were fitted in their plain loops, without our helps."""
        return self.contact == TUNED
