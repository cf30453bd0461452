"""What a script's numbers are to be: the closed form, and simcompare's own run of that row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from simcompare import measures
from simcompare.comparison.comparison import Repeat, Score, scores_of
from simcompare.comparison.repeats import truths_of
from simcompare.engine import engines
from simcompare.errors import BackendError, InputError
from simcompare.exporters.scripts.measuring import Truth
from simcompare.model.scenario import Measure, Scenario
from simcompare.model.settings import Settings
from simcompare.model.trajectory import Trajectory
from simcompare.running.jobs import MISSING, OK, UNSUPPORTED, Job, execute
from simcompare.scenarios.scenario_file import ScenarioFile

#: values of the whole run that a script prints, as many as the table of a run shows
SHOWN = 4


@dataclass(frozen=True)
class Expected:
    """One number that the script prints.

    Attributes:
        name: as the table of a run shows it.
        own: its name in the function that measures it.
        measure: what measures it.
        truth: what that measure finds in the closed form.
        score: value of simcompare's own run, and of the closed form.
    """

    name: str
    own: str
    measure: Measure
    truth: Truth
    score: Score


def expected_of(
    file: ScenarioFile,
    engine: str,
    repeats: Sequence[Scenario],
    shifted: Scenario | None,
    settings: Settings,
) -> list[Expected]:
    """Runs all repeats and measures them.

    Raises:
        InputError: the engine refuses the scene; the reason is told.
        BackendError: it is not installed, or failed.
    """
    truths = truths_of(file.path, [*repeats, *([shifted] if shifted else [])])
    done = [
        Repeat(scene, _run(Job(engine, scene, settings, i)), truth)
        for i, (scene, truth) in enumerate(zip(repeats, truths, strict=False))
    ]
    nominal = done[len(done) // 2]
    whole = [score for score in scores_of(done) if score.index is None]
    names = list(dict.fromkeys(score.measure for score in whole))[:SHOWN]
    found = []
    for name in names:
        score = next(score for score in whole if score.measure == name)
        measure, own = _measure_of(nominal.scenario, score)
        truth = Truth(
            None
            if nominal.truth is None
            else measures.take(measure, nominal.scenario, nominal.truth),
            None
            if shifted is None or truths[-1] is None
            else measures.take(measure, shifted, truths[-1]),
        )
        found.append(Expected(name, own, measure, truth, score))
    return found


def _run(job: Job) -> Trajectory:
    done = execute(job)
    if done.status == OK and done.trajectory is not None:
        return done.trajectory
    if done.status == MISSING:
        engines.get(job.engine).version()
    if done.status in (UNSUPPORTED, MISSING):
        raise InputError(f"--engine {job.engine}", [str(done.reason)])
    raise BackendError(str(done.reason))


def _measure_of(scenario: Scenario, score: Score) -> tuple[Measure, str]:
    """Which of a scenario's measures gave a score, and under which name of its own."""
    for measure in scenario.measures:
        for own in measures.load(measure.function).units:
            if measure.probe == score.probe and measure.name_of(own) == score.measure:
                return measure, own
    raise AssertionError(score.measure)
