"""What run.json and fit.json say of a fit, and what all kinds of fits have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.records.fit_waveforms import WaveformFit
from simcompare.results.records.run import Record

AnyFit = Annotated[BouncesFit | WaveformFit | TossFit, Field(discriminator="by")]


@dataclass(frozen=True, kw_only=True)
class FitRecord(Record):
    """What run.json says of a fit.

    Attributes:
        fit: what was found; fit.json holds it too.
        recording_asked: the recordings as the user named them.
    """

    kind: Literal["fit"] = "fit"
    fit: AnyFit
    recording_asked: str | tuple[str, ...] = ()
