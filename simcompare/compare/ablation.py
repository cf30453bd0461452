"""Ablation: an assisted run once more without each of our helps, all others kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from simcompare.compare.comparison import Repeat, Score, scores_of
from simcompare.compare.repeats import AtStep
from simcompare.engine.helps import HELPS
from simcompare.errors import SimcompareError
from simcompare.model.settings import ASSISTED, Settings
from simcompare.running.jobs import UNSUPPORTED, Job, Outcome, does_not_act


def jobs_of(engine: str, at: AtStep, settings: Settings) -> list[Job]:
    """Jobs of the nominal repeat, one without each help; those that do not act end at once."""
    middle = len(at.scenarios) // 2
    helps = frozenset(HELPS) if settings.helps is None else settings.helps
    return [
        Job(
            engine, at.nominal, replace(settings, helps=helps - {name}), middle, without=name,
            at=at.label,
        )
        for name in HELPS
        if name in helps
    ]  # fmt: skip


def results_of(at: AtStep, outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """What the nominal repeat shows with each help, and without it, all others kept.

    Args:
        at: the scenario at one step.
        outcomes: of all steps.
    """
    nominal: dict[tuple[str, str], dict[str, Score]] = {}
    faults: dict[tuple[str, str], str] = {}
    middle, own = len(at.scenarios) // 2, [one for one in outcomes if one.job.at == at.label]
    for outcome in own:
        if outcome.job.mode == ASSISTED and outcome.job.repeat == middle:
            key = (outcome.job.source, outcome.job.without)
            if outcome.trajectory is not None:
                repeat = Repeat(at.nominal, outcome.trajectory, at.truths[middle])
                try:
                    scores = [s for s in scores_of([repeat]) if s.index is None]
                    nominal[key] = {score.measure: score for score in scores}
                except SimcompareError as error:
                    faults[key] = str(error)
    found = []
    for outcome in own:
        source, name = outcome.job.source, outcome.job.without
        if not name or (source, "") not in nominal:
            continue
        if outcome.status == UNSUPPORTED and outcome.reason == does_not_act(name):
            continue
        left_out = nominal.get((source, name), {})
        found.append({
            "source": source, "help": name, "status": outcome.status,
            "reason": outcome.reason or faults.get((source, name)),
            "measures": [
                {"measure": measure, "unit": score.unit, "truth": score.truth,
                 "with": score.value, "without": getattr(left_out.get(measure), "value", None)}
                for measure, score in nominal[source, ""].items()
            ],
        })  # fmt: skip
    return found
