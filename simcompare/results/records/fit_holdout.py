"""What fit.json says of drops that were not fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from simcompare.results.records.fit_parts import (
    Numbers,
    Rms,
)


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
