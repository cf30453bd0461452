"""What fit.json says of the engines of a fit to bounces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field

from simcompare.model.audit import AuditRow
from simcompare.model.settings import DropPlan
from simcompare.model.tuning import TuningRow
from simcompare.results.records.fit_forms import Residuals
from simcompare.results.records.fit_holdout import SourceHoldout
from simcompare.results.records.fit_parts import (
    EngineParameter,
    EngineRow,
    Numbers,
)


@dataclass(frozen=True)
class Target:
    """The impact to which engines were tuned."""

    restitution: float
    u: float
    speed_m_s: float


@dataclass(frozen=True)
class OneRestitution:
    """The one restitution of engines for a ball whose own depends on the speed.

    Attributes:
        value: of it.
        u: standard uncertainty with which it stands for every recorded impact.
        misfit: its part from the impacts: root mean square by which they differ from it.
        most: the largest of these differences; ``None`` in older files.
    """

    value: float
    u: float
    misfit: float
    most: float | None = None

    @property
    def off(self) -> str:
        """How far it is from the ball's over the recorded impacts, in words."""
        words = f"by {self.misfit:.2g} (root mean square over the recorded impacts)"
        return words if self.most is None else f"{words}, at most {self.most:.2g}"


@dataclass(frozen=True)
class EffectiveValue:
    """What an engine shows.

    Attributes:
        value: mean over the fitted drops.
        u: standard uncertainty.
        u_engine: its part from the engine: the phase of the step, and how its restitution changes
            from impact to impact.
        unit: of all of them.
    """

    value: float
    u: float
    u_engine: Annotated[float, Field(alias="u_phase")]
    unit: str


@dataclass(frozen=True)
class Shown:
    """What the simulations of one drop showed, impact by impact.

    Attributes:
        times_s: impact times of the middle simulation [s].
        restitution: effective, mean over the phases of the step.
        scatter: its standard deviation over them.
        late_s: impact time less that of the closed form, mean over the phases [s].
        scatter_s: its standard deviation over them [s].
    """

    times_s: Numbers
    restitution: Numbers
    scatter: Numbers
    late_s: Numbers
    scatter_s: Numbers


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


@dataclass(frozen=True, kw_only=True)
class Impact:
    """One recorded impact in the plain loop of an engine.

    Attributes:
        drop: number of the drop, first is 1.
        number: of the impact.
        speed_m_s: of the closed form.
        closed_form: its restitution.
        restitution: of the engine, mean over the phases of the step.
        u_phase: standard uncertainty of that mean.
        scatter: standard deviation over the phases.
        deviation: part by which it differs from the closed form.
        late_s: impact time less that of the closed form [s].
        scatter_s: its standard deviation over the phases [s].
    """

    drop: int
    number: int
    speed_m_s: float
    closed_form: float
    restitution: float
    u_phase: float
    scatter: float
    deviation: float
    late_s: float
    scatter_s: float


@dataclass(frozen=True)
class FirstContact:
    """The contact of the first impact: largest depth, how long it lasts, and what it delays."""

    penetration_m: float | None = None
    contact_s: float | None = None
    delay_s: float | None = None


@dataclass(frozen=True)
class Tuned:
    """An engine's own numbers for the pairs of one restitution.

    Attributes:
        pairs: names of the bodies of each pair.
        restitution: that the numbers give.
        values: the numbers.
        size_m: smallest size of the body for which they were found.
        gravity_m_s2: along the normal of the contact.
    """

    pairs: tuple[tuple[str, str], ...]
    restitution: float
    values: Numbers
    size_m: float
    gravity_m_s2: float

    def suits(self, plan: DropPlan) -> bool:
        """Whether the numbers were found for such drops, but for the speed of the impact."""
        return all(
            math.isclose(ours, asked, rel_tol=1e-6)
            for ours, asked in (
                (self.restitution, plan.restitution),
                (self.size_m, plan.size_m),
                (self.gravity_m_s2, plan.gravity_m_s2),
            )
        )


@dataclass(frozen=True)
class RunWith:
    """With what a run repeats the fit.

    Attributes:
        closed: parameters of the closed form, by the scenario's names.
        engines: engine -> parameters of the scenario that it must be given.
        numbers: engine -> its own numbers for the restitution, in a plain loop.
    """

    closed: Mapping[str, float]
    engines: Mapping[str, Mapping[str, float]]
    numbers: Mapping[str, tuple[Tuned, ...]] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class BouncesEngine(EngineRow):
    """What one engine must be given, and what it then shows.

    Attributes:
        parameters: unknown -> what it must be given; empty where it failed.
        effective: what it shows, by name.
        native: contact values that it held.
        shown: what the simulations of each drop showed.
        left_s: measured less simulated impact times, drop by drop [s].
        residuals: the same for every kind of number; empty in a plain loop, where an impact is
            late by its contact.
        step_s: step for which its numbers hold [s].
        numbers: its own, for the restitution in a plain loop.
        impacts: what each recorded impact showed there.
        contact_of_first_impact: its depth and duration there.
        phases: at how many phases of the step each drop was run there.
        tuning: how the numbers were found.
        holdout: what it shows of drops that were not fitted.
    """

    parameters: Mapping[str, EngineParameter] = field(default_factory=dict)
    effective: Mapping[str, EffectiveValue] = field(default_factory=dict)
    native: tuple[AuditRow, ...] = ()
    shown: tuple[Shown, ...] = ()
    left_s: tuple[Numbers, ...] = ()
    residuals: Annotated[tuple[Residuals, ...], Field(alias="left")] = ()
    step_s: float | None = None
    numbers: tuple[Number, ...] = ()
    impacts: tuple[Impact, ...] = ()
    contact_of_first_impact: FirstContact = FirstContact()
    phases: int = 0
    tuning: tuple[TuningRow, ...] = ()
    holdout: tuple[SourceHoldout, ...] = ()
