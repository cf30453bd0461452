"""What run.json says of a validation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from simcompare.results.records.run import Record


@dataclass(frozen=True, kw_only=True)
class ValidationRecord(Record):
    """What run.json says of a validation.

    Attributes:
        validation: what was found.
        recording_asked: the recording as the user named it.
    """

    kind: Literal["validation"] = "validation"
    validation: Mapping[str, Any] = field(default_factory=dict)
    recording_asked: str | tuple[str, ...] = ()
