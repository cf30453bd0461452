"""From the estimates of many draws to what is stored and shown of one source."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from simcompare.estimation import consistency
from simcompare.estimation.consistency import Verdict
from simcompare.estimation.estimate import Estimate, Innovations, State, Way
from simcompare.estimation.estimators import Estimator
from simcompare.model.estimate_plan import EstimatePlan, RecordedPlan
from simcompare.model.sensor_errors import SensorErrors
from simcompare.model.trajectory import Array
from simcompare.reports.estimation import words
from simcompare.results.records.estimation import Curve, Reading, SourceEstimate, WayError
from simcompare.results.run_record import now, software
from simcompare.running.jobs import OK
from simcompare.verbs.estimate_request import EstimateRequest
from simcompare.verbs.estimated import Estimated

QUESTION = "How well do its sensors tell the motion, and does the filter know how well?"
#: what is asked where chips are compared
_OF_CHIPS = "Which chips can tell it, before and after a calibration, at rest and in motion?"
#: points of a stored curve at most
_POINTS = 2000


def of_source(source: str, version: str | None, draws: Sequence[Estimate]) -> SourceEstimate:
    """What the draws of one source say together; curves and numbers are those of the first."""
    first = draws[0]
    return SourceEstimate(
        source,
        version,
        OK,
        labels=first.labels,
        errors=tuple(_errors(draws)),
        nees=_nees(draws),
        nis=_nis(draws),
        nees_over_time=_over_time(draws),
        readings=_readings(draws),
        numbers=first.numbers,
        notes=first.notes,
        curves=tuple(
            _curve(way, name, one) for way in first.ways for name, one in way.states.items()
        ),
    )


def estimated(
    request: EstimateRequest,
    estimator: Estimator,
    plan: EstimatePlan | RecordedPlan,
    sources: tuple[SourceEstimate, ...],
    *,
    title: str,
    scenario: str,
    draws: int,
    seed: int,
    recording: str = "",
    sensors: Mapping[str, SensorErrors] | None = None,
    engines_asked: str = "all",
) -> Estimated:
    """All of it, with its sentences."""
    found = Estimated(
        created=now(),
        title=f"{estimator.title}: {title}",
        question=_OF_CHIPS if estimator.study and not recording else QUESTION,
        scenario=scenario, estimator=estimator.name, sensors=sensors or {}, options=plan.options,
        loosen=estimator.loosening, biases=estimator.biases(plan.signals),
        sums=estimator.sums(plan.signals), draws=draws, seed=seed, recording=recording,
        engines_asked=engines_asked, sources=sources, command=request.command(),
        software=software(),
    )  # fmt: skip
    return replace(found, sentences=tuple(words.sentences(found)))


def _errors(draws: Sequence[Estimate]) -> list[WayError]:
    found = []
    for number, way in enumerate(draws[0].ways):
        for name in way.states:
            states = [one.ways[number].states[name] for one in draws]
            errors = [one.rms_error for one in states if one.rms_error is not None]
            told = [one.u for one in states if one.u is not None]
            found.append(WayError(way.name, name, _rms(errors), _rms([_rms(u) for u in told])))
    return found


def _rms(values: Array | Sequence[float | None]) -> float | None:
    sizes = np.array(values, dtype=float)
    return float(np.sqrt(np.nanmean(sizes**2))) if sizes.size else None


def _nees(draws: Sequence[Estimate]) -> Verdict | None:
    rows = _nees_rows(draws)
    known = rows.size > 0 and bool(np.isfinite(rows).all(axis=0).any())
    return consistency.nees(rows, _innovations(draws)[0].states) if known else None


def _innovations(draws: Sequence[Estimate]) -> list[Innovations]:
    return [one.innovations for one in draws if one.innovations is not None]


def _nees_rows(draws: Sequence[Estimate]) -> Array:
    """NEES of each draw (draws, n), as many instants as all of them have; none where unknown."""
    rows = [one.nees for one in _innovations(draws) if one.nees is not None]
    count = min(map(len, rows), default=0)
    return np.array([row[:count] for row in rows])


def _nis(draws: Sequence[Estimate]) -> Verdict | None:
    found = _innovations(draws)
    if not any(np.isfinite(one.nis).any() for one in found):
        return None
    count = min(len(one.nis) for one in found)
    return consistency.nis(
        np.array([one.nis[:count] for one in found]), np.array([one.used[:count] for one in found])
    )


def _over_time(draws: Sequence[Estimate]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    rows = _nees_rows(draws)
    if not rows.size:
        return (), ()
    every = _every(rows.shape[1])
    time_s = draws[0].best.time_s[: rows.shape[1]]
    return tuple(time_s[::every].tolist()), tuple(rows.mean(axis=0)[::every].tolist())


def _readings(draws: Sequence[Estimate]) -> tuple[Reading, ...]:
    found = _innovations(draws)
    names = found[0].whitened if found else ()
    return tuple(
        Reading(
            name,
            consistency.whiteness([one.whitened[name] for one in found]),
            refused := float(np.mean([one.refused.get(name, 0) for one in found])),
            refused + float(np.mean([len(one.whitened[name]) for one in found])),
            name in found[0].counted,
        )
        for name in names
    )


def _every(count: int) -> int:
    return max(1, -(-count // _POINTS))


def _curve(way: Way, name: str, state: State) -> Curve:
    every = _every(len(way.time_s))

    def kept(values: Array | None) -> tuple[float, ...] | None:
        return None if values is None else tuple(np.asarray(values)[::every].tolist())

    return Curve(
        way.name,
        name,
        kept(way.time_s) or (),
        kept(state.values) or (),
        kept(state.u),
        kept(state.truth),
    )
