"""Ablation: an assisted run once more without each of our helps, all others kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from simcompare.compare import Repeat, Score, scores_of
from simcompare.engine.helps import HELPS
from simcompare.errors import SimcompareError
from simcompare.jobs import UNSUPPORTED, Job, Outcome, does_not_act
from simcompare.scenario import Scenario
from simcompare.settings import ASSISTED, Settings
from simcompare.trajectory import Trajectory


def jobs_of(engine: str, scenarios: Sequence[Scenario], settings: Settings) -> list[Job]:
    """Jobs of the nominal repeat, one without each help; those that do not act end at once."""
    middle = len(scenarios) // 2
    helps = frozenset(HELPS) if settings.helps is None else settings.helps
    return [
        Job(
            engine, scenarios[middle], replace(settings, helps=helps - {name}), middle, without=name
        )
        for name in HELPS
        if name in helps
    ]


def results_of(
    scenarios: Sequence[Scenario], truths: Sequence[Trajectory | None], outcomes: Sequence[Outcome]
) -> list[dict[str, Any]]:
    """What the nominal repeat shows with each help, and without it, all others kept."""
    nominal: dict[tuple[str, str], dict[str, Score]] = {}
    faults: dict[tuple[str, str], str] = {}
    middle = len(scenarios) // 2
    for outcome in outcomes:
        if outcome.job.mode == ASSISTED and outcome.job.repeat == middle:
            key = (outcome.job.engine, outcome.job.without)
            if outcome.trajectory is not None:
                repeat = Repeat(scenarios[middle], outcome.trajectory, truths[middle])
                try:
                    scores = [s for s in scores_of([repeat]) if s.index is None]
                    nominal[key] = {score.measure: score for score in scores}
                except SimcompareError as error:
                    faults[key] = str(error)
    found = []
    for outcome in outcomes:
        engine, name = outcome.job.engine, outcome.job.without
        if not name or (engine, "") not in nominal:
            continue
        if outcome.status == UNSUPPORTED and outcome.reason == does_not_act(name):
            continue
        left_out = nominal.get((engine, name), {})
        found.append({
            "source": engine, "help": name, "status": outcome.status,
            "reason": outcome.reason or faults.get((engine, name)),
            "measures": [
                {"measure": measure, "unit": score.unit, "truth": score.truth,
                 "with": score.value, "without": getattr(left_out.get(measure), "value", None)}
                for measure, score in nominal[engine, ""].items()
            ],
        })  # fmt: skip
    return found
