"""What fit.json says of closed forms of a bouncing ball."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field

from simcompare.results.records.fit_parts import (
    Numbers,
    Open,
    Rms,
    Value,
)

#: speed of the impact to which a restitution belongs that depends on the speed [m/s]
REFERENCE_M_S = 4.0
#: above the least criterion by less than this: the data cannot tell
RIVAL = 4.0
#: weight above which a closed form stands alone
ALL = 0.9999


@dataclass(frozen=True)
class Prior:
    """What is known of an unknown beforehand: a normal distribution.

    Attributes:
        value: its mean.
        u: its standard deviation.
        reason: why it is assumed where nobody stated it; empty where somebody did.
        source: where that is written.
    """

    value: float
    u: float
    reason: str = ""
    source: str = ""


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """An unknown of a closed form.

    Attributes:
        value: estimate.
        u: standard uncertainty.
        low: lower end of the 95 % interval, ``None`` where it is infinite.
        high: upper end.
        interval: "normal", "profile", "truncated" as a drag cannot be below 0, or "averaged" over
            the closed forms by their weights.
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


@dataclass(frozen=True)
class AtSpeed:
    """Restitution at a speed, with its standard uncertainty and the ends of its 95 % interval."""

    speed_m_s: float
    value: float
    u: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, kw_only=True)
class Form:
    """A closed form as it was fitted.

    Attributes:
        model: its name.
        text: what it says, in words.
        parameters: its unknowns, averaged over all closed forms where there are several.
        alone: as this closed form alone has them, where that differs.
        covariance: of them, in this closed form alone.
        correlation: of the numbers that the fit looks for.
        fixed: what was not fitted.
        priors: what was known of unknowns.
        pulls: how far each prior is from what the data say, in standard uncertainties.
        assumed: unknowns that the data say nothing of and that the user did not seek: gravity, the
            clock, the length of a video, drag of a preset.
        chi2: of the data at the estimate, with the stated uncertainties.
        dof: degrees of freedom of ``s2``.
        s2: by how much the data scatter more than stated, squared.
        count: number of measured numbers.
        effective_unknowns: how many unknowns the data, not the priors, determine.
        rms: of the residuals, by kind: "times" and "intervals" [s], "heights" and "track" [m].
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
    u_known: bool = True
    scattered: bool = False
    assumed: tuple[str, ...] = ()
    alone: Mapping[str, Unknown] = field(default_factory=dict)

    @property
    def own(self) -> Mapping[str, Unknown]:
        """The unknowns as this closed form alone has them."""
        return self.alone or self.parameters

    @property
    def found(self) -> Mapping[str, Unknown]:
        """The unknowns of which the data say something."""
        return {name: row for name, row in self.parameters.items() if name not in self.assumed}


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """A closed form among others.

    Attributes:
        model: its name.
        text: what it says, in words.
        law: "constant", "power", "linear", "logarithmic" or "hunt_crossley".
        drag: whether the terminal speed is an unknown of it.
        unknowns: how many the data determine.
        chi2: of the data, divided by the common scatter.
        aic: Akaike's criterion.
        bic: Schwarz's criterion.
        delta: Akaike's criterion above the least.
        weight: Akaike weight.
        parameters: its unknowns.
    """

    model: str
    text: str
    law: str = ""
    drag: bool = False
    unknowns: float
    chi2: float
    aic: float
    bic: float
    delta: float | None
    weight: float
    parameters: Mapping[str, Value]


@dataclass(frozen=True, kw_only=True)
class Choice:
    """Which closed form was chosen.

    Attributes:
        chosen: its name.
        scatter: what χ² was divided by.
        dof: degrees of freedom of the scatter where it alone tells the uncertainty, else 0.
        words: what a reader must know, one sentence each.
        refused: name of a form -> why it could not be fitted.
        candidates: best first.
        disagree: whether forms that fit about as well give restitutions beyond their intervals.
        drag_excess: by how much Akaike's criterion is less without the drag of the settings;
            ``None`` where these have none.
    """

    chosen: str
    scatter: float
    dof: int = 0
    words: tuple[str, ...] = ()
    refused: Mapping[str, str]
    candidates: tuple[Candidate, ...]
    disagree: bool = False
    drag_excess: float | None = None

    @property
    def rivals(self) -> tuple[Candidate, ...]:
        """Closed forms that fit about as well as the chosen one."""
        return tuple(
            one for one in self.candidates[1:]
            if one.delta is not None and one.delta < RIVAL and one.weight > 0
        )  # fmt: skip

    @property
    def is_alone(self) -> bool:
        """Whether one closed form has all the weight that is told."""
        return self.candidates[0].weight > ALL


@dataclass(frozen=True)
class Repeats:
    """How one estimate scatters over simulated repeats."""

    u: float | None
    low: float | None
    high: float | None
    bias: float | None


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
        kind: "times" or "intervals" [s], "heights" or "track" [m].
        at: numbers of the impacts or apexes, or times [s].
        residuals: measured less predicted.
        u: standard uncertainty, from the scatter where none is stated.
        stated: whether it is stated.
        judged: whether the fit minimised these; times and heights of a video are drawn from its
            arcs and only shown.
    """

    drop: int
    kind: str
    at: tuple[int | float, ...]
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


@dataclass(frozen=True, kw_only=True)
class OtherEstimate:
    """A restitution by another rule than the fit's.

    Attributes:
        drop: number of the drop, first is 1.
        source: its recording.
        rule: "mean ratio", "first ratio" or "line".
        value: the restitution.
        u: standard uncertainty, where the rule gives one.
        trend: by how much ratios of flights rise from impact to impact.
        u_trend: its standard uncertainty, ``None`` where it cannot be known.
        name: the rule in words.
        text: what is wrong with it.
    """

    drop: int
    source: str
    rule: str = ""
    value: float
    u: float | None
    trend: float | None = None
    u_trend: float | None = None
    name: str = ""
    text: str = ""
