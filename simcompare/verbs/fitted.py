"""What all kinds of fits do alike: what the user takes as known, and what is stored."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from simcompare.comparison.comparison import INFO, Score
from simcompare.errors import InputError
from simcompare.model.scenario import Scenario
from simcompare.results import run_record
from simcompare.results.fit_file import FITTED
from simcompare.results.records.fit import AnyFit, FitRecord
from simcompare.results.records.fit_engines import EffectiveValue, Number
from simcompare.results.records.fit_parts import EngineParameter
from simcompare.results.records.run import SourceRecord
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs.request import FitRequest

#: what measured signals are stored under
MEASURED = "measured"


#: a number with its standard uncertainty
Found = EngineParameter | EffectiveValue | Number


def check_options(file: ScenarioFile, given: Mapping[str, object], by: str, cure: str) -> None:
    """Raises ``InputError`` for options that a kind of fit does not know."""
    if wrong := [option for option, value in given.items() if value]:
        fault = f"{file.name} is fitted by {by}, which this is not for; use --set for what is known"
        raise InputError(", ".join(wrong), [f"{fault}{cure}"])


def of_bounces(request: FitRequest) -> dict[str, object]:
    """The options that only a fit of bounces knows, as they were given."""
    return {
        "--prior": request.priors,
        "--model": request.model != "auto",
        "--u-time": request.u_time_s is not None,
    }


def known(file: ScenarioFile, request: FitRequest, apart: Collection[str] = ()) -> dict[str, float]:
    """Parameters that the user sets, which are not fitted: --preset, --fix and --set.

    Args:
        file: of the scenario.
        request: what the user asked for.
        apart: what is fixed and no parameter of the scenario.

    Raises:
        UnknownName: a preset or parameter that does not exist.
    """
    fixed = {name: one for name, one in (request.fixed or {}).items() if name not in apart}
    return {
        **file.of_preset(request.preset),
        **file.read_settings(fixed, "--fix"),
        **file.read_settings(request.set or {}),
    }


def score(engine: str, name: str, one: Found) -> Score:
    """What was found for one engine, as a score that is shown and not judged."""
    return Score(
        engine, FITTED, name, "", None, one.value, None, one.u, one.unit, 1, None, None, INFO
    )


def record_of(
    file: ScenarioFile,
    scene: Scenario,
    request: FitRequest,
    fit: AnyFit,
    sources: Sequence[SourceRecord],
    scores: Sequence[Score],
    truth: str | None = None,
) -> FitRecord:
    """What run.json says of a fit, with what was asked."""
    return run_record.of_run(
        FitRecord, file, [scene], truth, sources, scores, fit=fit, engines_asked=request.engine,
        scenario_asked=request.scenario, recording_asked=tuple(map(str, request.recordings)),
        command=request.command(),
    )  # fmt: skip
