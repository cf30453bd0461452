"""What reports ask of a run: its sources, modes, scores and nominal trajectories."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from simcompare import notation
from simcompare.comparison.comparison import PASS, Score
from simcompare.errors import UnknownName
from simcompare.measures import observe
from simcompare.model.scenario import Probe, Tolerance
from simcompare.model.settings import (
    ASSISTED,
    BY_HAND,
    COEFFICIENTS,
    DEFAULT,
    SHOWN_LEVELS,
    TUNED,
)
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.reports.render import numbers
from simcompare.results.records.run import RunRecord, SourceRecord, StepRecord
from simcompare.results.run import Run
from simcompare.running.jobs import OK

_MODES = {
    DEFAULT: ("by default, as it comes", "by default"),
    COEFFICIENTS: ("coefficients typed in", "with coefficients"),
    TUNED: ("tuned, in a plain loop", "tuned"),
    ASSISTED: ("assisted, with our helps", "assisted"),
    BY_HAND: ("with values set by hand", "by hand"),
    "fitted": ("fitted to a measurement", "fitted"),
}


def run_record(run: Run) -> RunRecord:
    """The record of a run that is no fit and no validation."""
    assert isinstance(run.record, RunRecord)
    return run.record


def beyond(run: Run) -> tuple[str, ...]:
    """Why the truth does not hold for the parameters of a run; empty where it does."""
    return run.record.beyond if isinstance(run.record, RunRecord) else ()


def modes(run: Run) -> list[str]:
    """Contact levels of a run, in the order in which they were asked for."""
    return list(dict.fromkeys(source.contact for source in run.record.sources))


def judged_modes(run: Run) -> list[str]:
    """Modes in which the engines were given the scenario's physics; all if there is none."""
    return [mode for mode in modes(run) if mode not in SHOWN_LEVELS] or modes(run)


def names(run: Run) -> list[str]:
    """Names of all engines of a run, those that did not run included."""
    return list(dict.fromkeys(source.name for source in run.record.sources))


def mode_title(mode: str) -> str:
    """A contact level in words, for the head of a panel."""
    return _MODES.get(mode, (f"contact level {mode}", mode))[0]


def mode_words(mode: str) -> str:
    """A contact level in one or two words, for a table."""
    return _MODES.get(mode, (mode, mode))[1]


def source_of(run: Run, name: str, mode: str) -> SourceRecord | None:
    """The record of one engine in one mode."""
    for source in run.record.sources:
        if source.name == name and source.contact == mode:
            return source
    return None


def ran(run: Run, mode: str) -> list[str]:
    """Engines that ran in a mode."""
    return [
        source.name
        for source in run.record.sources
        if source.contact == mode and source.status == OK
    ]


def measure_words(measure: str) -> str:
    """The name of a measure as people say it."""
    return measure.replace("_", " ")


def unit_words(unit: str) -> str:
    """A unit in brackets with a space before it, nothing for a plain number."""
    return "" if unit in ("", "1") else f" ({unit})"


def label(measure: str, unit: str) -> str:
    """A measure with its unit, for an axis or a head."""
    return f"{measure_words(measure)}{unit_words(unit)}"


def axes(run: Run) -> dict[str, str]:
    """Series that are drawn over another one: measure -> the measure that gives its x values."""
    return dict(run.record.axes)


def probes(run: Run) -> dict[str, Probe]:
    """The probes of a run's scenario, the leading one first."""
    return dict(run.record.probes)


def nominal(run: Run, source: str, contact: str) -> Trajectory | None:
    """The trajectory of the nominal repeat, which is the middle one."""
    middle = run.record.repeats // 2
    for stored in run.trajectories:
        if (stored.source, stored.contact, stored.repeat) == (source, contact, middle):
            return stored.trajectory
    return None


def truth(run: Run) -> Trajectory | None:
    """The truth for the nominal parameters."""
    return nominal(run, TRUTH, "")


def observed(trajectory: Trajectory | None, probe: Probe) -> Array | None:
    """What a probe sees, ``None`` where the source has no such signal."""
    if trajectory is None:
        return None
    try:
        return observe(trajectory, probe)
    except UnknownName:
        return None


def score_of(run: Run, source: str, contact: str, measure: str) -> Score | None:
    """The score of a whole run of one source."""
    return run.record.whole.get((source, contact, measure))


def measures(run: Run) -> list[str]:
    """Everything that was measured once a run: what has a tolerance first."""
    return toleranced_first(run, (score.measure for score in run.record.whole.values()))


def toleranced_first(run: Run, measures: Iterable[str]) -> list[str]:
    """Each measure once: first what has a tolerance, else in the order in which it is given.

    Scores stand in the order of the scenario's own ``measures``; the tolerances of one that
    extends another begin with those of the other.
    """
    tolerances = run.record.tolerances
    return sorted(dict.fromkeys(measures), key=lambda name: name not in tolerances)


def steps(run: Run) -> tuple[StepRecord, ...]:
    """What depends on the step, for each of several; empty for a run with one step."""
    return run.record.steps


def tolerances(run: Run, source: str) -> Mapping[str, Tolerance]:
    """The tolerances of the scenario at the step of a source."""
    for step in steps(run):
        if source.endswith(step.at):
            return step.tolerances
    return run.record.tolerances


def judged(run: Run) -> list[str]:
    """What has a truth and a tolerance, in the order in which the scenario measures it."""
    scores = run.record.whole.values()
    with_truth = {score.measure for score in scores if score.truth is not None}
    tolerances = run.record.tolerances
    return [name for name in measures(run) if name in with_truth and name in tolerances]


def width(run: Run, score: Score) -> float | None:
    """Half-width of the band that the scenario accepts, also where nothing was judged."""
    tolerance = tolerances(run, score.source).get(score.measure)
    if score.tolerance is not None or tolerance is None or score.truth is None:
        return score.tolerance
    return tolerance.width(score.truth)


def share_of_tolerance(run: Run, score: Score) -> float | None:
    """|deviation| over tolerance: up to 1 is accepted."""
    accepted = width(run, score)
    if score.value is None or score.truth is None or not accepted:
        return None
    deviation = abs(score.value - score.truth)
    return deviation / accepted if deviation > numbers.ROUNDING * size(run, score) else 0.0


def passed(run: Run, source: str, mode: str) -> tuple[int, int]:
    """How many tolerances a source met, and of how many."""
    scores = [score_of(run, source, mode, name) for name in judged(run)]
    verdicts = [score.verdict for score in scores if score is not None]
    return verdicts.count(PASS), len(verdicts)


def value_words(run: Run, score: Score | None, sizes: Iterable[float | None] = ()) -> str:
    """A score as ``value ± scatter``; of some repeats alone, from the lowest to the highest.

    Args:
        run: the run.
        score: the score; a dash where there is none.
        sizes: what the values of its table are like, where no tolerance limits its decimals.
    """
    if score is None:
        return "–"
    scale, places = size(run, score), notation.places(width(run, score), sizes)
    if score.value is None and score.low is not None and score.high is not None:
        low, high = (numbers.with_u(end, None, scale=scale, digits=4, places=places)
                     for end in (score.low, score.high))  # fmt: skip
        ends = low if low == high else f"{low} to {high}"
        return f"{ends} {measured_words(run, score)}"
    return numbers.with_u(score.value, score.scatter, scale=scale, digits=4, places=places)


def measured_words(run: Run, score: Score) -> str:
    """In how many of the repeats something could be measured."""
    return f"({score.repeats} of {run.record.repeats})"


def size(run: Run, score: Score) -> float:
    """Beside what a value of a measure may be no more than rounding: its truth, its tolerance.

    A tolerance counts a hundredfold: nobody looks at a ten-thousand-millionth of it.
    """
    return max(abs(score.truth or 0.0), 100 * (width(run, score) or 0.0))
