"""The verb ``fit`` for scenarios whose parameters are told by tosses of a cube."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from simcompare import units
from simcompare.compare.comparison import INFO, Score
from simcompare.compare.repeats import sample_step_s
from simcompare.engine import engines
from simcompare.engine.assist import ALL
from simcompare.errors import InputError, UnknownName
from simcompare.fitting.tosses import records
from simcompare.fitting.tosses.engines import EngineTosses, How, fit_engines
from simcompare.fitting.tosses.replay import STEP_S, Replay
from simcompare.fitting.tosses.roles import roles_of
from simcompare.fitting.tosses.setup import prepare
from simcompare.reports.fit import tosses as words
from simcompare.results import run_record
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit import FitRecord
from simcompare.results.records.fit_tosses import TossSource
from simcompare.results.records.run import SourceRecord
from simcompare.results.run import Run, Stored
from simcompare.running.runner import TIME_LIMIT_S, Progress
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import levels

#: what ``--fix`` calls measured lengths over true ones
SCALE = "scale"


@dataclass(frozen=True)
class Given:
    """What the user takes as known.

    Attributes:
        values: parameters of the scenario.
        scale: measured lengths over true ones.
    """

    values: Mapping[str, float]
    scale: float


def fit_tosses(
    file: ScenarioFile,
    *,
    recordings: Sequence[str | Path],
    hold_out: Sequence[str | Path] = (),
    engine: str = "all",
    unknowns: Sequence[str] = (),
    given: Given,
    mapping: str | Path | None = None,
    step: str | float | None = None,
    assist: str | Sequence[str] | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Run:
    """Fits what makes a cube land as it was seen to land, engine by engine.

    Args:
        file: a scenario that is fitted by tosses.
        recordings: logs, stored recordings, or public data sets that are fitted.
        hold_out: the same, which are not fitted but predicted; where there are none, a part of the
            tosses is drawn and fitted, and the others predicted.
        engine: ``"all"`` or names with commas.
        unknowns: what is sought; what the scenario names as usual, where empty.
        given: what is taken as known.
        mapping: mapping file for the logs.
        step: longest step of the engines.
        assist: our helps with which engines are run; "all" where nothing is said.
        time_limit_s: longest time for one simulation [s].
        progress: called as simulations end.

    Returns:
        The run; ``record.fit`` holds what was found.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    chosen = engines.select(engine)
    helps = levels.chosen_helps(ALL if assist is None else assist, engine)
    roles = roles_of(file, given.values)
    step_s = STEP_S if step is None else sample_step_s(file, roles.given, None, step)
    how = How(helps, step_s, time_limit_s=time_limit_s, progress=progress)
    setup = prepare(
        roles, [str(name) for name in recordings], [str(name) for name in hold_out],
        unknowns=unknowns, given=given.values, scale=given.scale, mapping=mapping,
    )  # fmt: skip
    found = fit_engines(roles, setup, chosen, how)
    scene = Replay(roles, setup.fitted[0], {}, step_s=step_s).scenario()
    made = records.of_fit(roles, setup, found, given.values, how, scene)
    made = replace(made, sentences=tuple(words.sentences(made)))
    command = ["simcompare", "fit", file.name, "--engine", engine]
    for option, texts in (
        ("--recording", recordings), ("--hold-out", hold_out),
        ("--unknown", [",".join(unknowns)]), ("--map", [mapping]), ("--step", [step]),
        ("--assist", [assist and made.assist]),
        ("--set", [f"{name}={value}" for name, value in given.values.items()]),
        ("--fix", [f"{SCALE}={given.scale}"] if given.scale != 1 else []),
    ):  # fmt: skip
        command += [word for text in texts if text for word in (option, str(text))]
    record = run_record.of_run(
        FitRecord, file, [scene], None, [_source(one) for one in found],
        [score for source in made.sources for score in _scores(source)],
        fit=made, engines_asked=engine, scenario_asked=file.name, command=tuple(command),
        recording_asked=tuple(map(str, recordings)),
    )  # fmt: skip
    runs = [(one.engine, one.outcome.trajectory) for one in found]
    return Run(record, tuple(Stored(name, FITTED, 0, run) for name, run in runs if run))


def given_of(
    file: ScenarioFile,
    preset: str | None,
    fixed: Mapping[str, str | float],
    settings: Mapping[str, str | float],
    refused: Mapping[str, object],
) -> Given:
    """What the user takes as known.

    Args:
        file: the scenario.
        preset: named set of parameters.
        fixed: what stands after ``--fix``: parameters, or ``scale``.
        settings: what stands after ``--set``.
        refused: options that tosses do not have, with what was given.

    Raises:
        InputError: such an option, or a scale that is none.
        UnknownName: a preset or parameter that does not exist.
    """
    wrong = [option for option, value in refused.items() if value]
    if wrong:
        raise InputError(
            ", ".join(wrong),
            [
                f"{file.name} is fitted by tosses, which this is not for; use --set for what is"
                " known"
            ],
        )  # fmt: skip
    if preset is not None and preset not in file.presets:
        raise UnknownName(f"preset of {file.name}", preset, file.presets)
    chosen = {} if preset is None else dict(file.presets[preset].set)
    others = {name: value for name, value in fixed.items() if name != SCALE}
    scale = units.to_si(fixed.get(SCALE, 1.0), "1", f"--fix {SCALE}")
    if not scale > 0:
        raise InputError("--fix", [f"{scale:g} is no {SCALE}; expected a number above 0"])
    values = {**file.read_settings(others, "--fix"), **file.read_settings(settings)}
    return Given({**chosen, **values}, scale)


def _source(one: EngineTosses) -> SourceRecord:
    return run_record.of_source(one.engine, FITTED, [one.outcome])


def _scores(source: TossSource) -> list[Score]:
    """What was found for one engine, as scores that are shown and not judged."""
    return [
        Score(source.name, FITTED, name, "", None, own.value, None, own.u, own.unit, 1, None, None,
              INFO)
        for name, own in source.parameters.items()
    ]  # fmt: skip
