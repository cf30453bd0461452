"""The verb ``estimate`` on a recording: no engine, one draw, and the truth that was recorded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from simcompare.estimation import estimators, recorded
from simcompare.estimation.estimate import Given
from simcompare.estimation.estimators import Estimator
from simcompare.inference import sources
from simcompare.reports import suspicions
from simcompare.reports.validation import answer
from simcompare.scenarios import catalogue
from simcompare.verbs import estimate_request as requests
from simcompare.verbs import estimating
from simcompare.verbs.estimate_request import EstimateRequest
from simcompare.verbs.estimated import Estimated


def estimated(request: EstimateRequest) -> Estimated:
    """What the sensors of a real device tell of its motion.

    Raises:
        SimcompareError: faults of the arguments or of a file, or a recording that is not prepared.
    """
    name = catalogue.load(request.scenario).name
    assert request.recording is not None
    source = sources.find(str(request.recording), mapping=request.mapping)
    plan = requests.recorded_plan_of(source, name, request.estimator)
    estimator = estimators.load(plan.estimator)
    options = requests.options_of(estimator, plan.options, request.options or {})
    plan = plan.model_copy(update={"options": options})
    given = recorded.given_of(source.recording, plan, estimator, source.name)
    found = estimating.of_source(source.name, None, [estimators.apply(estimator, given)])
    found = replace(found, notes=(*found.notes, *filter(None, [plan.note])))
    told = estimating.estimated(
        request, estimator, plan, (found,), title=source.about.get("title", source.name),
        scenario=name, draws=1, seed=0, recording=source.name,
    )  # fmt: skip
    doubts = [*answer.contradictions(source.recording.provenance)]
    doubts = doubts or [*_suspected(estimator, given)]
    return replace(told, sentences=(*told.sentences, *doubts))


def _suspected(estimator: Estimator, given: Given) -> Iterator[str]:
    """A mistake in what is said of the recording, where it explains how far the estimate is off."""
    if estimator.suspected is None:
        return
    found = estimator.suspected(replace(given, options=estimator.with_defaults(given.options)))
    if found is not None:
        yield suspicions.sentence(found, "place", "m")
