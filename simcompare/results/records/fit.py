"""What run.json says of a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from simcompare.results.records.run import Record


@dataclass(frozen=True, kw_only=True)
class FitRecord(Record):
    """What run.json says of a fit.

    Attributes:
        fit: what was found; fit.json holds it too.
        recording_asked: the recordings as the user named them.
    """

    kind: Literal["fit"] = "fit"
    fit: Mapping[str, Any] = field(default_factory=dict)
    recording_asked: str | tuple[str, ...] = ()
