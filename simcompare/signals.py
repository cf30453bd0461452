"""Inputs of a scenario as signals of time."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, PositiveFloat, model_validator

from simcompare.shapes import Frozen


class Constant(Frozen):
    """The same value at all times."""

    signal: Literal["constant"]
    value: float


class Step(Frozen):
    """``before`` until ``time_s``, ``after`` from then on."""

    signal: Literal["step"]
    before: float = 0.0
    after: float
    time_s: float = 0.0


class Ramp(Frozen):
    """Straight line from ``start`` at ``start_s`` to ``end`` at ``end_s``, constant outside."""

    signal: Literal["ramp"]
    start: float = 0.0
    end: float
    start_s: float = 0.0
    end_s: float

    @model_validator(mode="after")
    def _forward(self) -> Ramp:
        if self.end_s <= self.start_s:
            raise ValueError(f"{self.end_s=} must be later than {self.start_s=}")
        return self


class Sine(Frozen):
    """offset + amplitude·sin(2π·frequency·t + phase)."""

    signal: Literal["sine"]
    amplitude: float
    frequency_Hz: PositiveFloat
    phase_rad: float = 0.0
    offset: float = 0.0


class Chirp(Frozen):
    """Logarithmic sweep from ``start_Hz`` to ``end_Hz`` within ``duration_s``."""

    signal: Literal["chirp"]
    amplitude: float
    start_Hz: PositiveFloat
    end_Hz: PositiveFloat
    duration_s: PositiveFloat


class Table(Frozen):
    """Values at given times, straight lines between them, constant outside."""

    signal: Literal["table"]
    time_s: tuple[float, ...] = Field(min_length=2)
    value: tuple[float, ...]

    @model_validator(mode="after")
    def _sorted(self) -> Table:
        if len(self.time_s) != len(self.value):
            raise ValueError(f"{len(self.time_s)} times but {len(self.value)} values")
        for i in range(1, len(self.time_s)):
            if self.time_s[i] <= self.time_s[i - 1]:
                raise ValueError(f"time_s[{i}] = {self.time_s[i]} is not later than the one before")
        return self


Signal = Annotated[Constant | Step | Ramp | Sine | Chirp | Table, Field(discriminator="signal")]
