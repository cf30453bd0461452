"""Ablation: an assisted run once more without each of our helps, all others kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

from pydantic import Field

from simcompare.comparison.comparison import Repeat, Score, scores_of
from simcompare.comparison.repeats import AtStep
from simcompare.engine.helps import HELPS
from simcompare.errors import SimcompareError
from simcompare.model.settings import ASSISTED, Settings
from simcompare.running.jobs import UNSUPPORTED, Job, Outcome, does_not_act


@dataclass(frozen=True)
class Ablated:
    """One measure of the nominal repeat with all helps, and without one of them.

    Attributes:
        measure: what was measured.
        unit: unit of all of it.
        truth: value of the closed form.
        with_: with all helps.
        without: without one; ``None`` where it could not be measured.
    """

    measure: str
    unit: str
    truth: float | None
    with_: Annotated[float | None, Field(alias="with")]
    without: float | None


@dataclass(frozen=True)
class Ablation:
    """What one source shows without one of our helps.

    Attributes:
        source: name of the source.
        help: the help that was left out.
        status: how the simulation without it ended.
        reason: why it did not end well.
        measures: of the whole run.
    """

    source: str
    help: str
    status: str
    reason: str | None
    measures: tuple[Ablated, ...]


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


def results_of(at: AtStep, outcomes: Sequence[Outcome]) -> list[Ablation]:
    """What the nominal repeat shows with each help, and without it, all others kept.

    Args:
        at: the scenario at one step.
        outcomes: of all steps.
    """
    nominal: dict[tuple[str, str], dict[str, Score]] = {}
    faults: dict[tuple[str, str], str] = {}
    middle, at_step = len(at.scenarios) // 2, [one for one in outcomes if one.job.at == at.label]
    for outcome in at_step:
        if outcome.job.mode == ASSISTED and outcome.job.repeat == middle:
            key = (outcome.job.source, outcome.job.without)
            if outcome.trajectory is not None:
                repeat = Repeat(at.nominal, outcome.trajectory, at.truths[middle])
                try:
                    scores = [s for s in scores_of([repeat]) if s.index is None]
                    nominal[key] = {score.measure: score for score in scores}
                except SimcompareError as error:
                    faults[key] = str(error)
    ablations = []
    for outcome in at_step:
        source, name = outcome.job.source, outcome.job.without
        if not name or (source, "") not in nominal:
            continue
        if outcome.status == UNSUPPORTED and outcome.reason == does_not_act(name):
            continue
        left_out = nominal.get((source, name), {})
        measures = tuple(
            Ablated(
                measure, score.unit, score.truth, score.value,
                getattr(left_out.get(measure), "value", None),
            )
            for measure, score in nominal[source, ""].items()
        )  # fmt: skip
        reason = outcome.reason or faults.get((source, name))
        ablations.append(Ablation(source, name, outcome.status, reason, measures))
    return ablations
