"""One segment of a recording with all that is drawn of one quantity in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from simcompare.model.resampling import interpolated
from simcompare.model.trajectory import Array, Trajectory
from simcompare.reports.run import runs
from simcompare.reports.validation import phrases, validations
from simcompare.results.run import Run

#: what recorded inputs are stored under
INPUT = "input"


@dataclass(frozen=True)
class Case:
    """One quantity in one segment.

    Attributes:
        number: of the segment, first is 0.
        name: of the segment, empty where there is only one.
        probe: the quantity.
        label: the same in words.
        si_unit: unit of all trajectories.
        u: standard uncertainty of a sample, 0 where unknown.
        measured: what was recorded.
        engines: what each engine makes of it.
        truth: the closed form, with its uncertainty where that is known.
        nominal: the closed form with what was known before a fit.
        inputs: recorded inputs that drive the simulation.
        events: of the recording [s].
        lacking: samples that are missing or were left out, in words.
    """

    number: int
    name: str
    probe: str
    label: str
    si_unit: str
    u: float
    measured: Trajectory
    engines: Mapping[str, Trajectory]
    truth: Trajectory | None = None
    nominal: Trajectory | None = None
    inputs: tuple[Trajectory, ...] = ()
    events: tuple[float, ...] = field(default=())
    lacking: str = ""

    @cached_property
    def values(self) -> Array:
        """What was measured."""
        return self.measured.signals[self.probe]

    @cached_property
    def residuals(self) -> dict[str, Array]:
        """Simulated minus measured, at the samples of the measurement; NaN where neither is."""
        return {
            name: interpolated(one.time_s, one.signals[self.probe], self.measured.time_s)
            - self.values
            for name, one in self.engines.items()
        }

    @cached_property
    def largest(self) -> float:
        """Largest size of all residuals."""
        return max(float(np.nanmax(np.abs(y), initial=0.0)) for y in self.residuals.values())

    @property
    def scale(self) -> tuple[float, str]:
        """A factor and the unit in which people say what was measured."""
        return phrases.people_unit(self.si_unit, [float(np.nanmax(np.abs(self.values)))])

    @property
    def small_scale(self) -> tuple[float, str]:
        """The same for what is left."""
        return phrases.people_unit(self.si_unit, [self.largest, 2 * self.u])

    def titled(self, words: str) -> str:
        """Words with the name of the segment, where there are several."""
        return f"{words}, {self.name}" if self.name else words


def case_of(run: Run, probe: str, number: int, stream: str) -> Case | None:
    """A segment of a validation; ``None`` where the quantity was not measured in it."""
    measured = validations.stored(run, validations.MEASURED, "", number)
    if measured is None or probe not in measured.signals:
        return None
    record = validations.validation(run)
    about = record.cases[number].probes.get(probe)
    truth = _with(validations.truth(run, validations.BEST, number), probe)
    nominal = _with(validations.truth(run, validations.NOMINAL, number), probe)
    found = {n: validations.stored(run, n, validations.BEST, number) for n in runs.names(run)}
    return Case(
        number, validations.segment_name(run, stream), probe, validations.label(run, probe),
        record.compare[probe].unit, 0.0 if about is None else float(about.u), measured,
        {name: one for name, one in found.items() if one is not None and probe in one.signals},
        truth, nominal if validations.is_fitted(run) else None, inputs_of(run, number),
        tuple(validations.event_times(run, number)),
        "" if about is None else lacking_words(about.missing, about.saturated),
    )  # fmt: skip


def _with(trajectory: Trajectory | None, probe: str) -> Trajectory | None:
    return trajectory if trajectory is not None and probe in trajectory.signals else None


def inputs_of(run: Run, number: int) -> tuple[Trajectory, ...]:
    """Recorded inputs of a segment."""
    return tuple(
        one.trajectory for one in run.trajectories if (one.source, one.segment) == (INPUT, number)
    )


def lacking_words(missing: int, saturated: int = 0) -> str:
    """How many samples are gaps of the line."""
    words = []
    if missing:
        verb = "is" if missing == 1 else "are"
        words.append(f"{phrases.counted(missing, 'sample')} {verb} missing.")
    if saturated:
        verb = "was" if saturated == 1 else "were"
        words.append(f"{phrases.counted(saturated, 'sample')} {verb} left out: the sensor was at"
                     " its end.")  # fmt: skip
    return " ".join(words)
