"""What the records of all kinds of fits are made of."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Annotated, Any, TypeVar, cast

from pydantic import Field

from simcompare.model.tuning import TuningRow
from simcompare.statistics.identifiability import Identifiability

Part = TypeVar("Part")
#: whose a parameter of an engine is
CLOSED_FORM, ENGINE = "closed form", "engine"
#: sources of uncertainty beside the unknowns that have a prior
DATA, LAW = "data", "choice of law"


@dataclass(frozen=True)
class Value:
    """A value with its standard uncertainty, ``None`` where it is not finite."""

    value: float | None
    u: float | None


@dataclass(frozen=True)
class Known(Identifiability):
    """What data can tell about the unknowns.

    Attributes:
        words: what a reader must know, one sentence each.
    """

    words: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class EngineParameter:
    """A parameter that an engine must be given.

    Attributes:
        value: of it.
        u: standard uncertainty.
        interval95: ends of the 95 % interval; ``None`` where the data leave one open.
        unit: of all of them.
        u_num: standard uncertainty from the engine: phase, step, change from impact to impact.
        whose: "closed form" where every engine is given the same, or "engine".
        misfit: standard uncertainty from what the engine lacks, such as a restitution that depends
            on the speed.
    """

    value: float | None
    u: float | None
    interval95: tuple[float | None, float | None]
    unit: str
    u_num: float | None
    whose: str = ENGINE
    misfit: float = 0.0


@dataclass(frozen=True, kw_only=True)
class AnyKind:
    """What all kinds of fits say.

    Attributes:
        scenario: that was fitted.
        contact: level for which it holds: "tuned" or "assisted".
        assist: our helps that were asked for, as they are typed.
        settings: parameters of the scenario that were not fitted.
        sentences: the answer, in words.
    """

    scenario: str
    contact: str
    assist: str
    settings: Annotated[Mapping[str, float], Field(alias="given")]
    sentences: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class EngineRow:
    """What one engine came to.

    Attributes:
        name: of the engine.
        version: of the engine.
        contact: level for which it holds: "tuned" or "assisted".
        status: "ok" or how it failed.
        reason: why it failed.
        simulations: how many were run.
        wall_s: wall time of them [s].
        correlation: of the parameters.
        identifiable: whether the data determine all unknowns.
    """

    name: str
    version: str | None
    contact: str
    status: str
    reason: str | None
    simulations: int
    wall_s: float
    correlation: tuple[tuple[float | None, ...], ...] = ()
    identifiable: bool = True

    @property
    def failure(self) -> str:
        """Why there is nothing to show, without the engine's own name before it."""
        return (self.reason or self.status).removeprefix(f"{self.name}: ")


#: numbers, numbers of which some may be unknown, and root mean squares by kind
Numbers = tuple[float, ...]
Open = tuple[float | None, ...]
Rms = Mapping[str, float]


def finite(part: Part) -> Part:
    """The same part of a record with ``None`` for numbers that are not finite."""
    return cast("Part", _finite(part))


def _finite(part: Any) -> Any:  # noqa: ANN401
    if isinstance(part, TuningRow):  # its numbers that are none are NaN
        return part
    if is_dataclass(part) and not isinstance(part, type):
        return replace(part, **{f.name: _finite(getattr(part, f.name)) for f in fields(part)})
    if isinstance(part, Mapping):
        return {name: _finite(one) for name, one in part.items()}
    if isinstance(part, tuple | list):
        return tuple(map(_finite, part))
    return None if isinstance(part, float) and not math.isfinite(part) else part


@dataclass(frozen=True)
class Budget:
    """What each source adds to the uncertainty of one quantity of a closed form.

    Attributes:
        name: an unknown, or "restitution" of the fastest impact.
        u: its standard uncertainty of first order, over all laws by their weights.
        unit: of u.
        shares: source -> its part of u²: "data", unknowns that have a prior, "choice of law".
    """

    name: str
    u: float
    unit: str
    shares: Mapping[str, float]

    @property
    def largest(self) -> str:
        """The source with the largest share."""
        return max(self.shares, key=lambda source: self.shares[source])
