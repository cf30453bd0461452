"""What fit.json says of a fit to bounces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from pydantic import Field

from simcompare.model.audit import AuditRow
from simcompare.model.settings import TUNED, DropPlan
from simcompare.model.tuning import TuningRow
from simcompare.results.records.fit_parts import EngineParameter, EngineRow, Known, Rms, Value

#: version of what is stored
FORMAT = 2
Numbers = tuple[float, ...]
Open = tuple[float | None, ...]


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


@dataclass(frozen=True)
class Prior:
    """What is known of an unknown beforehand: a normal distribution."""

    value: float
    u: float


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """An unknown of a closed form.

    Attributes:
        value: estimate.
        u: standard uncertainty.
        low: lower end of the 95 % interval, ``None`` where it is infinite.
        high: upper end.
        interval: "normal" or "profile".
        open_low: whether the data fit as well as far as was looked below.
        open_high: the same above.
    """

    value: float | None
    u: float | None
    low: float | None
    high: float | None
    interval: str
    open_low: bool = False
    open_high: bool = False

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """Ends of the 95 % interval."""
        return self.low, self.high


@dataclass(frozen=True)
class AtSpeed:
    """Restitution at a speed."""

    speed_m_s: float
    value: float
    u: float


@dataclass(frozen=True, kw_only=True)
class Form:
    """A closed form as it was fitted.

    Attributes:
        model: its name.
        text: what it says, in words.
        parameters: its unknowns.
        covariance: of them.
        correlation: of the numbers that the fit looks for.
        fixed: what was not fitted.
        priors: what was known of unknowns.
        pulls: how far each prior is from what the data say, in standard uncertainties.
        chi2: of the data at the estimate, with the stated uncertainties.
        dof: degrees of freedom of ``s2``.
        s2: by how much the data scatter more than stated, squared.
        count: number of measured numbers.
        effective_unknowns: how many unknowns the data, not the priors, determine.
        rms: of the residuals, by kind: "times" [s], "heights" and "track" [m].
        restitution: at the slowest and the fastest impact.
        at_bound: unknowns that ended at a bound.
        warnings: what the reader must know, one sentence each.
        u_known: whether all uncertainties of the measurement are stated.
        scattered: whether the data scatter by more than is stated and than chance explains.
    """

    model: str
    text: str
    parameters: Mapping[str, Unknown]
    covariance: tuple[Open, ...]
    correlation: tuple[Open, ...]
    fixed: Mapping[str, float | None]
    priors: Mapping[str, Prior]
    pulls: Mapping[str, float | None]
    chi2: float
    dof: int
    s2: float
    count: int
    effective_unknowns: float
    rms: Rms
    restitution: tuple[AtSpeed, AtSpeed]
    at_bound: tuple[str, ...]
    warnings: tuple[str, ...] = ()
    u_known: bool
    scattered: bool


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A closed form among others.

    Attributes:
        model: its name.
        text: what it says, in words.
        law: "constant", "power" or "hunt_crossley".
        drag: whether the terminal speed is an unknown of it.
        unknowns: how many the data determine.
        chi2: of the data, divided by the common scatter.
        aic: Akaike's criterion.
        aicc: the same corrected for few data; ``None`` where there are too few.
        bic: Schwarz's criterion.
        delta: the deciding criterion above the least.
        weight: Akaike weight; 0 for a form that repeats another because its drag vanished.
        parameters: its unknowns.
    """

    model: str
    text: str
    law: str
    drag: bool
    unknowns: float
    chi2: float
    aic: float
    aicc: float | None
    bic: float
    delta: float | None
    weight: float
    parameters: Mapping[str, Value]

    def score(self, criterion: str) -> float | None:
        """AIC or AICc, by its name."""
        return self.aic if criterion == "AIC" else self.aicc


@dataclass(frozen=True, kw_only=True)
class Choice:
    """Which closed form was chosen.

    Attributes:
        chosen: its name.
        criterion: which decided, "AIC" or "AICc".
        scatter: what χ² was divided by.
        words: what a reader must know, one sentence each.
        refused: name of a form -> why it could not be fitted.
        candidates: best first.
    """

    chosen: str
    criterion: str
    scatter: float
    words: tuple[str, ...] = ()
    refused: Mapping[str, str]
    candidates: tuple[Candidate, ...]


@dataclass(frozen=True)
class Repeats:
    """How one estimate scatters over simulated repeats."""

    u: float | None
    low: float | None
    high: float | None
    bias: float | None

    @property
    def limits(self) -> tuple[float | None, float | None]:
        """2.5 % and 97.5 % quantiles."""
        return self.low, self.high


@dataclass(frozen=True)
class Bootstrap:
    """Fits to simulated repeats.

    Attributes:
        kind: "parametric".
        draws: how many.
        failed: that did not converge and were left out.
        seed: of the generator.
        parameters: unknown -> its scatter.
    """

    kind: str
    draws: int
    failed: int
    seed: int
    parameters: Mapping[str, Repeats]


@dataclass(frozen=True, kw_only=True)
class Residuals:
    """Measured less predicted numbers of one kind of one drop.

    Attributes:
        drop: number of the drop, first is 1.
        kind: "times" [s], "heights" [m] or "track" [m].
        at: numbers of the impacts or apexes, or times [s].
        residuals: measured less predicted.
        u: standard uncertainty, from the scatter where none is stated.
        stated: whether it is stated.
        judged: whether the fit minimised these; times and heights of a video are drawn from its
            arcs and only shown.
    """

    drop: int
    kind: str
    at: Numbers
    residuals: Annotated[Numbers, Field(alias="left")]
    u: Numbers
    stated: bool
    judged: bool


@dataclass(frozen=True)
class Law:
    """Restitution against speed, and the speed of every impact, drop by drop."""

    speed_m_s: Numbers
    value: Numbers
    u: Numbers
    impact_speed_m_s: tuple[Numbers, ...]


@dataclass(frozen=True, kw_only=True)
class Ratios:
    """Ratios of neighbouring flights, or roots of ratios of heights, of one drop.

    Attributes:
        drop: number of the drop, first is 1.
        how: "flight times" or "heights".
        numbers: which impacts.
        values: the ratios.
        expected: what the fit expects of them.
        u: standard uncertainties.
    """

    drop: int
    how: str
    numbers: tuple[int, ...]
    values: Numbers
    expected: Numbers
    u: Open


@dataclass(frozen=True)
class ProfileRow:
    """Least χ², less that of the fit, with one unknown held at values; ends of its interval."""

    name: str
    values: Numbers
    chi2: Numbers
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Target:
    """The impact to which engines were tuned."""

    restitution: float
    u: float
    speed_m_s: float


@dataclass(frozen=True)
class EffectiveValue:
    """What an engine shows.

    Attributes:
        value: mean over the fitted drops.
        u: standard uncertainty.
        u_phase: its part from the phase of the step.
        unit: of all of them.
    """

    value: float
    u: float
    u_phase: float
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


@dataclass(frozen=True, kw_only=True)
class PredictedHeight:
    """A rebound height that was predicted.

    Attributes:
        number: of the impact before it.
        predicted: height [m].
        u_predicted: standard uncertainty [m].
        e_n: difference from the measured one over both expanded uncertainties (k = 2).
    """

    number: int
    predicted: float
    u_predicted: float
    e_n: float | None


@dataclass(frozen=True, kw_only=True)
class JudgedHeight(PredictedHeight):
    """The same with what was measured [m]."""

    measured: float
    u_measured: float | None


@dataclass(frozen=True, kw_only=True)
class EngineHoldout:
    """What one engine shows of a drop that was not fitted.

    Attributes:
        restitution: that it shows.
        u: standard uncertainty.
        held: restitution of the drop at its first impact, in a plain loop.
        u_held: its standard uncertainty.
        e_n: difference of the two over their expanded uncertainties (k = 2).
        heights: rebound heights.
        late_s: impact times less those of the closed form [s].
        scatter_s: their standard deviations over the phases of the step [s].
    """

    restitution: float
    u: float
    held: float | None = None
    u_held: float | None = None
    e_n: float | None
    heights: tuple[PredictedHeight, ...] = ()
    late_s: Numbers = ()
    scatter_s: Numbers = ()


@dataclass(frozen=True, kw_only=True)
class SourceHoldout(EngineHoldout):
    """The same with the recording of the drop."""

    source: str


@dataclass(frozen=True, kw_only=True)
class HeldOutDrop:
    """A drop that was not fitted, as the closed form predicts it.

    Attributes:
        number: of the drop, first is 1.
        source: its recording.
        heights: rebound heights.
        restitution: that the drop itself would give, ``None`` where it was not fitted.
        u_restitution: its standard uncertainty.
        fitted: restitution of the fit.
        u_fitted: its standard uncertainty.
        u_difference: standard uncertainty of the difference of the two.
        e_n: their difference over its expanded uncertainty (k = 2).
        rms: of the residuals, by kind.
        chi2: of the prediction.
        count: number of measured numbers.
        drop_height_m: from how high it fell.
        unknowns: of the closed form.
        speeds_m_s: slowest and fastest impact.
        engines: what engines show of it.
    """

    number: int
    source: str
    heights: tuple[JudgedHeight, ...]
    restitution: float | None = None
    u_restitution: float | None = None
    fitted: float | None = None
    u_fitted: float | None = None
    u_difference: float | None = None
    e_n: float | None = None
    rms: Rms
    chi2: float
    count: int
    drop_height_m: float | None
    unknowns: tuple[str, ...]
    speeds_m_s: tuple[float, float]
    engines: Mapping[str, EngineHoldout] = field(default_factory=dict)


@dataclass(frozen=True)
class Holdout:
    """All drops that were not fitted, and what they say in words."""

    drops: tuple[HeldOutDrop, ...] = ()
    text: str = ""


@dataclass(frozen=True, kw_only=True)
class OtherEstimate:
    """A restitution by another rule than the fit's.

    Attributes:
        drop: number of the drop, first is 1.
        source: its recording.
        rule: "mean ratio", "first ratio", "line" or "trajectory".
        value: the restitution.
        u: standard uncertainty, where the rule gives one.
        trend: by how much ratios of flights rise from impact to impact.
        u_trend: its standard uncertainty, ``None`` where it cannot be known.
        starts: from how many places a search began.
        reached: from how many of them it reached the minimum.
        name: the rule in words.
        text: what is wrong with it.
    """

    drop: int
    source: str
    rule: str
    value: float
    u: float | None
    trend: float | None = None
    u_trend: float | None = None
    starts: int = 0
    reached: int = 0
    name: str = ""
    text: str = ""


@dataclass(frozen=True)
class Valid:
    """Where a fit holds: slowest and fastest impact, time between samples, step of the engines."""

    speed_m_s: tuple[float, float]
    step_s: float
    engine_step_s: float


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


@dataclass(frozen=True, kw_only=True)
class BouncesFit:
    """What fit.json says of a fit to bounces.

    Attributes:
        by: the kind.
        format: version of what is stored.
        scenario: that was fitted.
        contact: level for which it holds: "tuned" or "assisted".
        assist: our helps that were asked for, as they are typed.
        settings: parameters of the scenario that were not fitted.
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
        engine_form: the closed form with the contact that engines have, where that is another.
        engine_model: its name.
        engine_model_text: what it says, in words.
        tuned_to: the impact to which engines were tuned.
        tuned_mean: mean restitution of the closed form over the impacts that engines resolve.
        sources: the engines.
        run_with: with what a run repeats the fit.
        holdout: what is predicted of the drops that were not fitted.
        other_estimates: restitutions by other rules.
        valid: where it holds.
        sentences: the answer, in words.
    """

    by: Literal["bounces"] = "bounces"
    format: int = FORMAT
    scenario: str
    contact: str
    assist: str
    settings: Annotated[Mapping[str, float], Field(alias="given")]
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
    engine_form: Form | None
    engine_model: str
    engine_model_text: str
    tuned_to: Target | None
    tuned_mean: float | None
    sources: tuple[BouncesEngine, ...]
    run_with: RunWith
    holdout: Holdout
    other_estimates: tuple[OtherEstimate, ...]
    valid: Valid
    sentences: tuple[str, ...] = ()

    @property
    def is_tuned(self) -> bool:
        """Whether engines were fitted in their plain loops, without our helps."""
        return self.contact == TUNED

    @property
    def for_engines(self) -> Form:
        """The closed form with the contact that engines have."""
        return self.engine_form or self.closed_form
