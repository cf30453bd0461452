"""Every simulation that a validation needs, and what its probes saw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from simcompare import measures
from simcompare.comparison.repeats import check_sample_step
from simcompare.errors import InputError
from simcompare.inference.reference_model import Model
from simcompare.inference.segments import Segment
from simcompare.model.drawing import ORIENTATION, POSITION
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory
from simcompare.running.jobs import OK, Job, Outcome
from simcompare.running.runner import Progress, run_jobs

#: what is run of every segment
NOMINAL, BEST = "nominal", "best"
#: and with other steps, which show the step error; the last where longer ones cannot be
DOUBLE, FOURFOLD, HALF = "double step", "fourfold step", "half step"
_LONGER = {DOUBLE: 2.0, FOURFOLD: 4.0}
#: what is stored of bodies, to be played, and at how many instants at most
MOTION, _PLAYED = "motion", 1500


@dataclass(frozen=True)
class Engine:
    """What one engine gave.

    Attributes:
        name: the engine.
        outcomes: how the jobs that are judged ended.
        runs: (segment number, variant) -> the probes over time, for the jobs that ended well.
        motion: how bodies moved in the first segment, as it is played; ``None`` where that is not
            known.
    """

    name: str
    outcomes: Sequence[Outcome]
    runs: Mapping[tuple[int, str], Trajectory] = field(repr=False)
    motion: Trajectory | None = field(default=None, repr=False)

    def complete(self, segment: int) -> bool:
        """Whether the runs that are judged are there."""
        return (segment, NOMINAL) in self.runs and (segment, BEST) in self.runs


def simulate(
    model: Model,
    segments: Sequence[Segment],
    fitted: Mapping[str, float] | None,
    engines: Sequence[str],
    *,
    contact: str,
    step_s: float | None,
    time_limit_s: float,
    progress: Progress | None,
) -> list[Engine]:
    """Runs every segment on every engine: as known before, as fitted, and with longer steps.

    Args:
        model: the scenario.
        segments: of the recording.
        fitted: fitted parameters, ``None`` where nothing was fitted.
        engines: names.
        contact: contact level.
        step_s: step [s]; the scenario's own where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.
    """
    planned = [
        (i, variant, scene)
        for i, segment in enumerate(segments)
        for variant, scene in scenes(model, segment, fitted, step_s).items()
    ]
    outcomes = run_jobs(
        _jobs(planned, engines, contact), time_limit_s=time_limit_s, progress=progress
    )
    runs: dict[str, dict[tuple[int, str], Trajectory]] = {name: {} for name in engines}
    _collect(runs, planned, segments, outcomes)
    # a spring may be too stiff for a longer step: these engines try a shorter one
    shorter = [
        (i, HALF, model.scenario(segment, fitted, planned[0][2].world.step_s / 2))
        for i, segment in enumerate(segments)
    ]
    without = [
        name for name in engines if (0, BEST) in runs[name] and (0, DOUBLE) not in runs[name]
    ]
    if without:
        more = run_jobs(
            _jobs(shorter, without, contact), time_limit_s=time_limit_s, progress=progress
        )
        _collect(runs, shorter, segments, more)
    if fitted is None:  # what was known before is then also the best there is
        for by_variant in runs.values():
            by_variant.update(
                {(i, NOMINAL): run for (i, v), run in list(by_variant.items()) if v == BEST}
            )
    judged = [o for o in outcomes if planned[o.job.repeat][1] in (NOMINAL, BEST)]
    first = next(i for i, (_, variant, _) in enumerate(planned) if variant == BEST)
    played = {
        o.job.engine: motion_of(o.trajectory)
        for o in judged
        if o.job.repeat == first and o.status == OK and o.trajectory is not None
    }
    return [
        Engine(name, [o for o in judged if o.job.engine == name], runs[name], played.get(name))
        for name in engines
    ]


def check_step(
    model: Model, segments: Sequence[Segment], step: str | float | None, step_s: float | None
) -> None:
    """Refuses a step that makes no sense in the longest segment.

    Raises:
        InputError: it is too long or too short; says which are not.
    """
    if step is not None and step_s is not None:
        longest = max(segments, key=lambda segment: segment.duration_s)
        check_sample_step(model.scenario(longest), step, step_s)


Planned = list[tuple[int, str, Scenario]]


def _jobs(planned: Planned, engines: Sequence[str], contact: str) -> list[Job]:
    return [
        Job(name, scene, Settings(contact), number)
        for name in engines
        for number, (_, _, scene) in enumerate(planned)
    ]


def _collect(
    runs: dict[str, dict[tuple[int, str], Trajectory]],
    planned: Planned,
    segments: Sequence[Segment],
    outcomes: Sequence[Outcome],
) -> None:
    for outcome in outcomes:
        i, variant, scene = planned[outcome.job.repeat]
        if outcome.status == OK and outcome.trajectory is not None:
            trajectory = of_probes(scene, outcome.trajectory, segments[i].watched)
            runs[outcome.job.engine][i, variant] = trajectory


def scenes(
    model: Model, segment: Segment, fitted: Mapping[str, float] | None, step_s: float | None
) -> dict[str, Scenario]:
    """Variant -> scene; longer steps are left out where the scene cannot have them."""
    variants = {} if fitted is None else {NOMINAL: model.scenario(segment, None, step_s)}
    variants[BEST] = best = model.scenario(segment, fitted, step_s)
    for variant, multiple in _LONGER.items():
        try:
            variants[variant] = model.scenario(segment, fitted, best.world.step_s * multiple)
        except InputError:  # too few samples are left; the step error is then unknown
            break
    return variants


def motion_of(trajectory: Trajectory) -> Trajectory:
    """Where bodies are and how they are turned, at no more instants than are played."""
    count = len(trajectory.time_s)
    places = np.unique(np.linspace(0, count - 1, min(count, _PLAYED)).round().astype(int))
    signals = {
        name: values[places]
        for name, values in trajectory.signals.items()
        if name.endswith((f".{POSITION}", f".{ORIENTATION}"))
    }
    return Trajectory(
        trajectory.source, trajectory.time_s[places], signals, trajectory.version,
        trajectory.contact,
    )  # fmt: skip


def of_probes(scene: Scenario, trajectory: Trajectory, probes: Sequence[str]) -> Trajectory:
    """A trajectory of what probes saw: signal ``<probe>`` for each.

    Raises:
        UnknownName: the source has no such signal.
    """
    signals = {name: measures.observe(trajectory, scene.probes[name]) for name in probes}
    return Trajectory(
        trajectory.source, trajectory.time_s, signals, trajectory.version, trajectory.contact
    )
