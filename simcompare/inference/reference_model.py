"""The scenario's own truth as a model of the measurement: quick, exact, and without an engine."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from simcompare import measures
from simcompare.engine.drives import input_values
from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.errors import InputError
from simcompare.inference.segments import DURATION, Segment
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.reference_file import Reference
from simcompare.scenarios.scenario_file import ScenarioFile


@dataclass(frozen=True)
class Model:
    """A scenario with its reference.

    Attributes:
        file: the scenario.
        reference: its reference, ``None`` where it has none.
    """

    file: ScenarioFile
    reference: Reference | None

    def scenario(
        self,
        segment: Segment,
        values: Mapping[str, float] | None = None,
        step_s: float | None = None,
    ) -> Scenario:
        """The scene of a segment, with some parameters changed.

        It ends with the first step that is not before the end of the segment, so that every sample
        that was measured lies within it, however long the step is.
        """
        settings = {**segment.values, **(values or {})}
        scene = self.file.resolve(settings, step_s=step_s, inputs=segment.inputs)
        own = DURATION in self.file.parameters
        lasts_s = scene.world.duration_s if own else segment.duration_s
        whole = {"duration_s": whole_steps_s(lasts_s, scene.world.step_s)}
        return scene.model_copy(update={"world": scene.world.model_copy(update=whole)})

    def truth(self, scene: Scenario, time_s: Array | None = None) -> Trajectory:
        """The reference of a scene, at its own samples or at other times.

        Raises:
            InputError: there is none, or it fails.
        """
        if self.reference is None:
            raise InputError(
                self.file.name,
                ["has no reference.py, so parameters cannot be fitted and their part not be told"],
            )
        times = sample_times(scene) if time_s is None else time_s
        try:
            signals = dict(self.reference(scene.parameters, times, scene.inputs))
        except InputError:
            raise
        # a user's own code may raise anything, also SystemExit
        except (Exception, SystemExit) as error:
            message = f"reference() failed: {type(error).__name__}: {error}"
            raise InputError(str(self.file.path.with_name("reference.py")), [message]) from error
        if time_s is None:
            complete(scene, times, signals, input_values(scene, times))
        return Trajectory(TRUTH, times, signals)

    def at(self, segment: Segment, probe: str, values: Mapping[str, float], time_s: Array) -> Array:
        """A probe of the reference at the times of a measurement."""
        scene = self.scenario(segment, values)
        observed = scene.probes[probe]
        # from the start on; what the core computes from the motion needs even samples
        times = time_s if time_s[0] == 0 else np.concatenate(([0.0], time_s))
        direct = self.truth(scene, times)
        if observed.observe in direct.signals:
            return measures.observe(direct, observed)[len(times) - len(time_s) :]
        full = self.truth(scene)
        values_there = np.interp(time_s, full.time_s, measures.observe(full, observed))
        return np.asarray(values_there, dtype=float)


def whole_steps_s(duration_s: float, step_s: float) -> float:
    """The shortest whole number of steps that is not shorter than a duration [s]."""
    steps = math.ceil(duration_s / step_s)
    # the quotient is rounded, and so is the product: the last sample is what counts
    return (steps if steps * step_s >= duration_s else steps + 1) * step_s


def model_of(file: ScenarioFile) -> Model:
    """A scenario with its reference, where it has one."""
    return Model(file, catalogue.reference_of(file.path))
