"""Comparison: every score of every source, tidy.

A score is the mean over the dithered repeats and its standard deviation; each repeat is held
against the truth for its own parameters, so the dither itself is not in the deviation.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from simcompare import measures
from simcompare.measures import Measured
from simcompare.model.scenario import Measure, Scenario, Tolerance
from simcompare.model.settings import SHOWN_LEVELS
from simcompare.model.trajectory import Trajectory

PASS, FAIL, INFO = "pass", "fail", "info"
#: relative size below which a difference of two doubles is rounding
ROUNDING = 1e-12


@dataclass(frozen=True)
class Score:
    """One measured value of one source, judged where the scenario has a tolerance for it.

    Attributes:
        source: name of the source.
        contact: its contact level.
        measure: what was measured.
        probe: at which probe of the scenario.
        index: number of the event, first is 1; ``None`` for values of the whole run.
        value: mean over the repeats; ``None`` where it could not be measured.
        scatter: standard deviation of single repeats; ``None`` for a single one.
        u: standard uncertainty of the value: of the mean, the scatter over the root of the
            number of repeats (JCGM 100:2008, 4.2.3).
        unit: unit of value, scatter, u, truth and tolerance.
        repeats: number of repeats in the mean.
        truth: value of the closed form, for the nominal parameters.
        tolerance: half-width of the accepted band around the truth, or around what was measured.
        verdict: "pass", "fail" or "info" (simple acceptance, JCGM 106:2012, 8.2).
        low: lowest value of the repeats that could be measured, ``None`` where none could.
        high: highest of them.
        lacking: why it could not be measured, where the source does not give a signal.
        measured: value that was measured on a real device.
    """

    source: str
    contact: str
    measure: str
    probe: str
    index: int | None
    value: float | None
    scatter: float | None
    u: float | None
    unit: str
    repeats: int
    truth: float | None
    tolerance: float | None
    verdict: str
    low: float | None = None
    high: float | None = None
    lacking: str = ""
    measured: float | None = None


@dataclass(frozen=True)
class Repeat:
    """One repeat of one source beside the truth for the same parameters."""

    scenario: Scenario
    trajectory: Trajectory
    truth: Trajectory | None


def scores_of(repeats: Sequence[Repeat]) -> list[Score]:
    """Scores of one source from its repeats, the nominal repeat being the middle one.

    Args:
        repeats: repeats of one engine in one contact level, in order of the dithered parameter.
    """
    found: list[Score] = []
    nominal = repeats[len(repeats) // 2]
    for measure in nominal.scenario.measures:
        against = measures.load(measure.function).against
        ours = [measures.take(measure, r.scenario, r.trajectory) for r in repeats]
        theirs = [
            measures.take(measure, r.scenario, r.truth) for r in repeats if r.truth is not None
        ]
        if theirs:
            pairs = [against(a, b) for a, b in zip(ours, theirs, strict=True)]
            found += _judged(nominal, measure, pairs, ours[0])
        else:
            found += _without_truth(nominal, measure, ours)
        found += _series(nominal, measure, ours, theirs)
    return found


class _Mean(NamedTuple):
    value: float | None
    scatter: float | None
    unit: str
    repeats: int
    low: float | None = None
    high: float | None = None


def _judged(
    nominal: Repeat,
    measure: Measure,
    pairs: Sequence[Mapping[str, tuple[float | None, float]]],
    seen: Measured,
) -> list[Score]:
    scores, units = [], seen.units
    # what an engine does not give is no failure of it
    tolerances = {} if seen.lacking else nominal.scenario.tolerances
    for name, (_, truth) in pairs[len(pairs) // 2].items():
        both = [pair[name] for pair in pairs if name in pair]
        deviations = [value - true for value, true in both if value is not None]
        found = _mean_and_sd(truth, deviations, units[name], of=len(pairs))
        shown = measure.name_of(name)
        tolerance = tolerances.get(shown)
        made = _score(nominal, (shown, measure.probe, None), found, truth, tolerance)
        scores.append(replace(made, lacking=seen.lacking))
    judged = {score.measure for score in scores}
    for name, unit in units.items():
        shown = measure.name_of(name)
        # not even the truth can be measured
        if shown in tolerances and shown not in judged:
            nothing = _Mean(None, None, unit, 0)
            scores.append(_score(nominal, (shown, measure.probe, None), nothing, None, None))
    return scores


def _series(
    nominal: Repeat, measure: Measure, ours: Sequence[Measured], theirs: Sequence[Measured]
) -> list[Score]:
    """One score per event that every repeat of the source resolves; ``theirs`` may be empty."""
    scores = []
    for name in ours[0].series:
        unit, truths = ours[0].units[name], [measured.series[name] for measured in theirs]
        shown = measure.name_of(name)
        values = [measured.series[name] for measured in ours]
        for k in range(min(map(len, values))):
            known = bool(truths) and all(k < len(true) for true in truths)
            true = [float(row[k]) for row in truths] if known else [0.0] * len(values)
            truth = true[len(true) // 2]
            deviations = [float(a[k]) - b for a, b in zip(values, true, strict=True)]
            found = _mean_and_sd(truth, deviations, unit, of=len(ours))
            scores.append(
                _score(
                    nominal, (shown, measure.probe, k + 1), found, truth if known else None, None
                )
            )
    return scores


def _without_truth(nominal: Repeat, measure: Measure, ours: Sequence[Measured]) -> list[Score]:
    scores = []
    for name in ours[0].values:
        known = [value for m in ours if (value := m.values[name]) is not None]
        found = _mean_and_sd(0.0, known, ours[0].units[name], of=len(ours))
        shown = measure.name_of(name)
        made = _score(nominal, (shown, measure.probe, None), found, None, None)
        scores.append(replace(made, lacking=ours[0].lacking))
    wanted = nominal.scenario.answer
    for name in ours[0].series:
        shown = measure.name_of(name)
        if wanted is not None and wanted.measure == shown:  # what the answer is about: its mean
            known = [float(m.series[name].mean()) for m in ours if len(m.series[name])]
            found = _mean_and_sd(0.0, known, ours[0].units[name], of=len(ours))
            scores.append(_score(nominal, (shown, measure.probe, None), found, None, None))
    return scores


def _mean_and_sd(offset: float, deviations: Sequence[float], unit: str, *, of: int) -> _Mean:
    """Mean and standard deviation, which take all ``of`` repeats, and the ends of those known."""
    finite = [offset + deviation for deviation in deviations if math.isfinite(deviation)]
    least = ROUNDING * max(map(abs, (offset, *finite)), default=0.0)
    low, high = min(finite, default=None), max(finite, default=None)
    ends = tuple(end if end is None or abs(end) > least else 0.0 for end in (low, high))
    if len(deviations) < of:
        return _Mean(None, None, unit, len(deviations), *ends)
    value = offset + float(np.mean(deviations))
    sd = float(np.std(deviations, ddof=1)) if of > 1 else None
    # what the subtraction and addition of the truth leave behind is rounding, not a spread
    rounding = ROUNDING * max(abs(offset), abs(value))
    value = value if abs(value) > rounding else 0.0
    return _Mean(value, 0.0 if sd is not None and sd <= rounding else sd, unit, of, *ends)


def _score(
    nominal: Repeat,
    name: tuple[str, str, int | None],
    found: _Mean,
    truth: float | None,
    tolerance: Tolerance | None,
) -> Score:
    value, scatter, unit, repeats, low, high = found
    u = None if scatter is None else scatter / math.sqrt(repeats)
    source, contact = nominal.trajectory.source, nominal.trajectory.contact
    width, verdict = None, INFO
    # what an engine does as it comes is shown, not judged
    if tolerance is not None and truth is not None and contact not in SHOWN_LEVELS:
        width = tolerance.width(truth)
        within = value is not None and math.isfinite(value) and abs(value - truth) <= width
        verdict = PASS if within else FAIL
        if value is None and low is not None and high is not None:
            # what could be measured is right: the rest is not known, which is no failure
            known = max(abs(low - truth), abs(high - truth)) <= width
            verdict = INFO if known else FAIL
    return Score(
        source, contact, *name, value, scatter, u, unit, repeats, truth, width, verdict, low, high
    )
