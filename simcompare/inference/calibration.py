"""Parameters of a plan fitted to the streams that it calibrates on, to predict others."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from simcompare.inference import plan as plans
from simcompare.inference import sources
from simcompare.inference.estimate import Estimate, estimate
from simcompare.inference.plan import Plan
from simcompare.inference.reference_model import Model
from simcompare.inference.segment_reader import segments_of
from simcompare.inference.sources import Source


def calibrated(
    model: Model,
    plan: Plan,
    source: Source,
    overrides: Mapping[str, float],
    mapping: str | Path | None,
) -> Estimate | None:
    """The plan's parameters fitted to its streams; ``None`` where it fits none.

    Args:
        model: the scenario.
        plan: of the recording that is judged.
        source: that recording.
        overrides: parameters that the user sets; they are not fitted.
        mapping: mapping file for another log.

    Raises:
        InputError: another recording has no plan that suits the scenario.
    """
    calibrate = plan.calibrate
    names = [n for n in calibrate.parameters if n not in overrides] if calibrate is not None else []
    if calibrate is None or not names:
        return None
    other = source
    if calibrate.recording is not None:
        other = sources.find(calibrate.recording, mapping=mapping)
        # a log that has no plan of its own is read by that of the recording that is judged
        entries = other.plans or source.plans
        plan = plans.choose(entries, plan.scenario)
        plans.checked(plan, model.file.resolve(), entries)
    segments = segments_of(
        model.file, plan, other.recording, calibrate.streams, overrides, calibrate.most_s
    )
    probe = tuple(name for name, compared in plan.compare.items() if compared.judged)
    fitted = {*names, *calibrate.nuisance}
    known = {n: one.u for n, one in plan.parameters.items() if one.u > 0 and n not in fitted}
    known = {n: u for n, u in known.items() if n not in overrides}
    starts = [name for name in plan.start if name not in overrides]
    return estimate(model, segments, probe, names, calibrate.nuisance, starts=starts, known=known)
