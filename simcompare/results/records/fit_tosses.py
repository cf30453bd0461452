"""What fit.json says of a fit by tosses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from simcompare.model.audit import AuditRow
from simcompare.results.records.fit_engines import RunWith
from simcompare.results.records.fit_parts import AnyKind, EngineParameter, EngineRow

#: version of what fit.json holds
FORMAT = 1


@dataclass(frozen=True, kw_only=True)
class TossParameter(EngineParameter):
    """One parameter of one engine; its u is that of the tosses that were drawn, and of the grid.

    Attributes:
        value: with which its tosses land best.
        u: standard uncertainty.
        interval95: 95 % interval, by a bootstrap over the tosses.
        u_num: the part of u that the grid has.
        spacing: of the last grid.
        open: whether the interval reaches the end of what was tried, so that it may be wider.
        at_bound: whether the value stands at an end of its range.
    """

    value: float
    u: float
    interval95: tuple[float, float]
    spacing: float
    open: bool
    at_bound: bool


@dataclass(frozen=True)
class TossMean:
    """A mean over tosses.

    Attributes:
        mean: over the tosses.
        sd: standard deviation over them, with n in the denominator as in published tables.
        interval95: of the mean: percentiles of a bootstrap over the tosses.
    """

    mean: float
    sd: float
    interval95: tuple[float, float]


@dataclass(frozen=True)
class TossErrors:
    """How far an engine is off in some tosses.

    Attributes:
        position: distance of the centres [% of the width].
        rotation: angle between the orientations [deg].
        positions: the former of each toss.
        rotations: the latter of each toss.
    """

    position: TossMean
    rotation: TossMean
    positions: tuple[float, ...]
    rotations: tuple[float, ...]


@dataclass(frozen=True)
class TriedPoint:
    """A point of the search.

    Attributes:
        values: parameter -> value.
        cost: mean distance of the corners [% of the width]; ``None`` where the engine cannot.
    """

    values: Mapping[str, float]
    cost: float | None


@dataclass(frozen=True, kw_only=True)
class TossSource(EngineRow):
    """What was found for one engine.

    Attributes:
        parameters: what was sought; empty where it failed.
        cost: mean distance of the corners in the tosses that were fitted [% of the width].
        holdout: errors in the tosses that were predicted.
        tried: every point of the search, in its order.
        native: contact values that the engine held in the last toss.
    """

    parameters: Mapping[str, TossParameter] = field(default_factory=dict)
    cost: float | None = None
    holdout: TossErrors | None = None
    tried: tuple[TriedPoint, ...] = ()
    native: tuple[AuditRow, ...] = ()


@dataclass(frozen=True)
class Witness:
    """One measurement of the length scale of a recording.

    Attributes:
        name: what tells it.
        scale: measured lengths over true ones.
        u: standard uncertainty.
        text: where both come from.
    """

    name: str
    scale: float
    u: float
    text: str


@dataclass(frozen=True)
class TossRange:
    """Within what the fit was made.

    Attributes:
        step_s: between the engine's samples [s].
        engine_step_s: of the engine [s].
        duration_s: of the longest toss [s].
        speed_m_s: slowest and fastest speed of a centre at the first touch.
    """

    step_s: float
    engine_step_s: float
    duration_s: float
    speed_m_s: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class TossFit(AnyKind):
    """What a fit by tosses found.

    Attributes:
        format: version of what is stored.
        by: kind of the fit.
        unknowns: what was sought.
        width_m: length of the cube's edges [m].
        fitted: names of the tosses that were fitted.
        held_out: names of those that were predicted.
        scale: measured lengths over true ones, by which all tosses were divided.
        witnesses: what tells the scale of the recording as measured.
        told: which tosses were fitted, and which left out.
        sources: what was found for every engine.
        valid: within what the fit was made.
        run_with: what another run takes of it.
    """

    format: int = FORMAT
    by: Literal["tosses"] = "tosses"
    unknowns: tuple[str, ...]
    width_m: float
    fitted: tuple[str, ...]
    held_out: tuple[str, ...]
    scale: float
    witnesses: tuple[Witness, ...]
    told: tuple[str, ...]
    sources: tuple[TossSource, ...]
    valid: TossRange
    run_with: RunWith
