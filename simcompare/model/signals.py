"""Inputs of a scenario as signals of time; each evaluates itself with ``at(time_s)``."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PositiveFloat, model_validator

from simcompare.model.frozen import Frozen

Array = NDArray[np.float64]


class Constant(Frozen):
    """The same value at all times."""

    signal: Literal["constant"]
    value: float

    def at(self, time_s: Array) -> Array:
        """Values at the given times (n,)."""
        return np.asarray(np.full(len(time_s), self.value), dtype=float)


class Step(Frozen):
    """``before`` until ``time_s``, ``after`` from then on."""

    signal: Literal["step"]
    before: float = 0.0
    after: float
    time_s: float = 0.0

    def at(self, time_s: Array) -> Array:
        """Values at the given times (n,)."""
        return np.asarray(np.where(time_s < self.time_s, self.before, self.after), dtype=float)


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
            raise ValueError(f"end_s = {self.end_s:g} is not later than start_s = {self.start_s:g}")
        return self

    def at(self, time_s: Array) -> Array:
        """Values at the given times (n,)."""
        return np.asarray(
            np.interp(time_s, (self.start_s, self.end_s), (self.start, self.end)), dtype=float
        )


class Sine(Frozen):
    """offset + amplitude·sin(2π·frequency·t + phase)."""

    signal: Literal["sine"]
    amplitude: float
    frequency_Hz: PositiveFloat
    phase_rad: float = 0.0
    offset: float = 0.0

    def at(self, time_s: Array) -> Array:
        """Values at the given times (n,)."""
        turns = 2 * math.pi * self.frequency_Hz * time_s
        return np.asarray(
            self.offset + self.amplitude * np.sin(turns + self.phase_rad), dtype=float
        )


class SineSteps(Frozen):
    """Cosines of one amplitude, one frequency after another, each for ``dwell_s``.

    Each begins with phase 0 at its maximum, so that a mass driven by it as a force gets no lasting
    speed. After the last one the signal is 0.
    """

    signal: Literal["sine_steps"]
    amplitude: float
    frequencies_Hz: tuple[PositiveFloat, ...] = Field(min_length=1)
    dwell_s: PositiveFloat

    def at(self, time_s: Array) -> Array:
        """Values at the given times (n,)."""
        # rounding must not put the first sample of a step into the one before
        place = np.floor(time_s / self.dwell_s + 1e-9).astype(int)
        inside = (place >= 0) & (place < len(self.frequencies_Hz))
        frequency = np.array(self.frequencies_Hz)[np.where(inside, place, 0)]
        turns = 2 * math.pi * frequency * (time_s - place * self.dwell_s)
        return np.asarray(np.where(inside, self.amplitude * np.cos(turns), 0.0), dtype=float)


class Chirp(Frozen):
    """Cosine whose frequency grows as a power from ``start_Hz`` to ``end_Hz`` in ``duration_s``."""

    signal: Literal["chirp"]
    amplitude: float
    start_Hz: PositiveFloat
    end_Hz: PositiveFloat
    duration_s: PositiveFloat

    def at(self, time_s: Array) -> Array:
        """Values at the given times (n,)."""
        growth = math.log(self.end_Hz / self.start_Hz) / self.duration_s
        turns = np.expm1(growth * time_s) / growth if growth else time_s
        return np.asarray(self.amplitude * np.cos(2 * math.pi * self.start_Hz * turns), dtype=float)


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

    def at(self, time_s: Array) -> Array:
        """Values at the given times (n,)."""
        return np.asarray(np.interp(time_s, self.time_s, self.value), dtype=float)


Signal = Annotated[
    Constant | Step | Ramp | Sine | SineSteps | Chirp | Table, Field(discriminator="signal")
]
