"""Comparison: every score of every source, tidy.

A score is the mean over the dithered repeats and its standard deviation; each repeat is held against
the truth for its own parameters, so the dither itself is not in the deviation.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from simcompare import measures
from simcompare.backend import DEFAULT
from simcompare.measures import Measured
from simcompare.scenario import Scenario, Tolerance
from simcompare.trajectory import Trajectory

PASS, FAIL, INFO = "pass", "fail", "info"


@dataclass(frozen=True)
class Score:
    """One measured value of one source, judged where the scenario has a tolerance for it.

    Attributes:
        source: name of the source.
        contact: its contact mode.
        measure: what was measured.
        index: number of the event, first is 1; ``None`` for values of the whole run.
        value: mean over the repeats; ``None`` where it could not be measured.
        u: standard deviation over the repeats; ``None`` for a single one.
        unit: unit of value, u, truth and tolerance.
        repeats: number of repeats in the mean.
        truth: value of the closed form, for the nominal parameters.
        tolerance: half-width of the accepted band around the truth.
        verdict: "pass", "fail" or "info" (simple acceptance, JCGM 106:2012, 8.2).
    """

    source: str
    contact: str
    measure: str
    index: int | None
    value: float | None
    u: float | None
    unit: str
    repeats: int
    truth: float | None
    tolerance: float | None
    verdict: str

    def to_dict(self) -> dict[str, Any]:
        """The score as plain values for JSON and CSV."""
        return asdict(self)


@dataclass(frozen=True)
class Repeat:
    """One repeat of one source beside the truth for the same parameters."""

    scenario: Scenario
    trajectory: Trajectory
    truth: Trajectory | None


def scores_of(repeats: Sequence[Repeat]) -> list[Score]:
    """Scores of one source from its repeats, the nominal repeat being the middle one.

    Args:
        repeats: repeats of one engine in one contact mode, in order of the dithered parameter.
    """
    found: list[Score] = []
    nominal = repeats[len(repeats) // 2]
    for measure in nominal.scenario.measures:
        module = measures.load(measure.function)
        probe = nominal.scenario.probes[measure.probe]
        ours = [module.measure(repeat.trajectory, probe) for repeat in repeats]
        if any(repeat.truth is None for repeat in repeats):
            found += _without_truth(nominal, ours)
            continue
        theirs = [module.measure(r.truth, probe) for r in repeats if r.truth is not None]
        pairs = [module.against(a, b) for a, b in zip(ours, theirs, strict=True)]
        found += _judged(nominal, pairs, ours[0].units)
        found += _series(nominal, ours, theirs)
    return found


def _judged(
    nominal: Repeat,
    pairs: Sequence[Mapping[str, tuple[float | None, float]]],
    units: Mapping[str, str],
) -> list[Score]:
    found = []
    for name, (_, truth) in pairs[len(pairs) // 2].items():
        both = [pair[name] for pair in pairs if name in pair]
        deviations = [value - true for value, true in both if value is not None]
        complete = len(deviations) == len(pairs)
        value, u = _mean_and_sd(truth, deviations) if complete else (None, None)
        tolerance = nominal.scenario.tolerances.get(name)
        found.append(_score(nominal, (name, None), (value, u, units[name]), truth, tolerance))
        found[-1] = _with_repeats(found[-1], len(deviations))
    return found


def _series(nominal: Repeat, ours: Sequence[Measured], theirs: Sequence[Measured]) -> list[Score]:
    """One score per event, for the events that every repeat of the source resolves."""
    found = []
    true_nominal = theirs[len(theirs) // 2]
    for name, unit in ((name, ours[0].units[name]) for name in ours[0].series):
        events = min(len(measured.series[name]) for measured in ours)
        for k in range(events):
            both = [(a.series[name], b.series[name]) for a, b in zip(ours, theirs, strict=True)]
            known = all(k < len(true) for _, true in both)
            if known:
                truth = float(true_nominal.series[name][k])
                value, u = _mean_and_sd(truth, [float(a[k] - b[k]) for a, b in both])
            else:
                truth = None
                value, u = _mean_and_sd(0.0, [float(a[k]) for a, _ in both])
            score = _score(nominal, (name, k + 1), (value, u, unit), truth, None)
            found.append(_with_repeats(score, len(ours)))
    return found


def _without_truth(nominal: Repeat, ours: Sequence[Measured]) -> list[Score]:
    found = []
    for name in ours[0].values:
        values = [measured.values[name] for measured in ours]
        known = [value for value in values if value is not None]
        value, u = _mean_and_sd(0.0, known) if len(known) == len(values) else (None, None)
        score = _score(nominal, (name, None), (value, u, ours[0].units[name]), None, None)
        found.append(_with_repeats(score, len(known)))
    return found


def _mean_and_sd(offset: float, deviations: Sequence[float]) -> tuple[float, float | None]:
    mean = offset + float(np.mean(deviations))
    return mean, float(np.std(deviations, ddof=1)) if len(deviations) > 1 else None


def _score(
    nominal: Repeat,
    name: tuple[str, int | None],
    found: tuple[float | None, float | None, str],
    truth: float | None,
    tolerance: Tolerance | None,
) -> Score:
    value, u, unit = found
    source, contact = nominal.trajectory.source, nominal.trajectory.contact
    width, verdict = None, INFO
    # what an engine does by default is shown, not judged: nobody gave it the scenario's physics
    if tolerance is not None and truth is not None and contact != DEFAULT:
        width = tolerance.width(truth)
        within = value is not None and math.isfinite(value) and abs(value - truth) <= width
        verdict = PASS if within else FAIL
    return Score(source, contact, name[0], name[1], value, u, unit, 1, truth, width, verdict)


def _with_repeats(score: Score, repeats: int) -> Score:
    values = score.to_dict()
    return Score(**{**values, "repeats": repeats})
