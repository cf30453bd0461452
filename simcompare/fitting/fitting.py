"""The verb ``fit``: parameters from measurements, on every engine, with uncertainty."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simcompare import catalogue, engines, experiment, run_record, units
from simcompare.compare import INFO, Score
from simcompare.errors import InputError, UnknownName
from simcompare.fitting import (
    bounce_models,
    choose,
    engine_fit,
    holding_out,
    records,
    waveform_fit,
)
from simcompare.fitting.arcs import rejoined
from simcompare.fitting.engine_fit import EngineFit
from simcompare.fitting.fit_file import FITTED
from simcompare.fitting.identifiability import BLIND, identifiability
from simcompare.fitting.impacts import CLOCKED, Impacts, from_recording, from_table, from_times
from simcompare.fitting.likelihood import Fit
from simcompare.fitting.problem import SPEED, Prior
from simcompare.results import Run, Stored
from simcompare.runner import TIME_LIMIT_S, Progress
from simcompare.scenario_file import ScenarioFile
from simcompare.validation.model import model_of

if TYPE_CHECKING:
    from simcompare.hardware.logs.bounce_table import BounceTable


def fit(
    scenario: str = "ball",
    *,
    recordings: Sequence[str | Path],
    hold_out: Sequence[str | Path] = (),
    engine: str = "all",
    model: str = "auto",
    unknowns: Sequence[str] = (),
    fixed: Mapping[str, str | float] | None = None,
    priors: Mapping[str, tuple[float, float]] | None = None,
    u_time_s: float | None = None,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    mapping: str | Path | None = None,
    step: str | float | None = None,
    out: str | Path | None = None,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Run:
    """Fits a scenario to a measurement: to impacts and heights, or to signals over time.

    Args:
        scenario: name, folder or file of a scenario that says under ``fit:`` how it is fitted.
        recordings: logs, stored recordings, public data sets or bounce tables that are fitted.
        hold_out: the same, which are not fitted but predicted.
        engine: ``"all"`` or names with commas.
        model: closed form, or "auto": the one with the least AICc.
        unknowns: what is sought beside what the model has, such as "clock_skew"; by waveform,
            all that is sought.
        fixed: values of what is not sought.
        priors: unknown -> value and standard uncertainty.
        u_time_s: standard uncertainty of an impact time, where a recording does not say [s].
        set: parameters of the scenario, such as the ball's mass.
        preset: named set of parameters, applied first.
        mapping: mapping file for the logs.
        step: time between samples.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.

    Returns:
        The run; ``record["fit"]`` holds what was found, and goes into fit.json.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    chosen = engines.select(engine)
    file = catalogue.load(scenario)
    if not recordings:
        raise InputError("--recording", ["no recording is given; give at least one"])
    if file.fit is None:
        raise InputError(
            scenario, ["names nothing that can be fitted; expected fit: {by: bounces|waveform, …}"]
        )
    if out is not None:
        experiment.check_writable(Path(out))
    if file.fit.by == "waveform":
        only = {"--prior": priors, "--model": model != "auto", "--u-time": u_time_s is not None}
        done = waveform_fit.fit_waveform(
            file, recordings=recordings, hold_out=hold_out, engine=engine, unknowns=unknowns,
            given=waveform_fit.given_of(file, preset, fixed or {}, set or {}, only),
            mapping=mapping, step=step, time_limit_s=time_limit_s, progress=progress,
        )  # fmt: skip
        return _saved(done, out)
    given = _given(file, set, preset)
    asked = _Asked(
        extra=tuple(unknowns),
        fixed={**_known_drag(given), **_numbers(fixed or {})},
        priors={name: Prior(value, u) for name, (value, u) in (priors or {}).items()},
    )
    _check_request(recordings, hold_out, u_time_s, file.read_settings(set or {}))
    drops = [drop for name in recordings for drop in drops_of(name, mapping, u_time_s)]
    held = [drop for name in hold_out for drop in drops_of(name, mapping, u_time_s)]
    choice = choose.compare(
        drops, _candidates(model, asked), extra=asked.extra, fixed=asked.fixed, priors=asked.priors
    )
    known = identifiability(choice.best)
    if asked.extra and not known.condition < BLIND:
        raise InputError("--unknown", [*known.words, "leave it out, or --fix what it mixes with"])
    whole = model_of(file)
    start = _for_engines(choice.best, _joined(choice.best, drops, asked), asked)
    step_s = None if step is None else units.to_si(step, "s", "--step")
    found = engine_fit.fit_engines(
        whole, start.problem, start, chosen, given, step_s=step_s, time_limit_s=time_limit_s,
        progress=progress,
    )  # fmt: skip
    predicted = holding_out.predict(choice.best, start, found, held, asked.fixed)
    command = ["simcompare", "fit", scenario, "--engine", engine, "--model", model]
    for option, values in (
        ("--recording", recordings), ("--hold-out", hold_out), ("--preset", [preset]),
        ("--unknown", [",".join(unknowns)]), ("--map", [mapping]), ("--step", [step]),
        ("--u-time", [u_time_s and f"{u_time_s!r}s"]),
        ("--fix", [f"{name}={value}" for name, value in (fixed or {}).items()]),
        ("--prior", [f"{name}={value!r}:{u!r}" for name, (value, u) in (priors or {}).items()]),
        ("--set", [f"{name}={value}" for name, value in (set or {}).items()]),
    ):  # fmt: skip
        command += [word for value in values if value for word in (option, str(value))]
    told = _Told(scenario, file, tuple(map(str, recordings)), tuple(command), step_s)
    return _saved(_gather(told, choice, start, found, predicted, (drops, held), given), out)


def _check_request(
    recordings: Sequence[str | Path],
    hold_out: Sequence[str | Path],
    u_time_s: float | None,
    settings: Mapping[str, float],
) -> None:
    """Raises ``InputError`` for what would count data twice, or would be ignored."""
    if u_time_s is not None and not u_time_s > 0:
        raise InputError("--u-time", [f"{u_time_s:g} s is not an uncertainty; it must exceed 0"])
    places = [str(Path(name).resolve()) for name in (*recordings, *hold_out)]
    twice = {str(n) for n, p in zip((*recordings, *hold_out), places, strict=True)
             if places.count(p) > 1}  # fmt: skip
    if twice:
        raise InputError(
            "--recording, --hold-out",
            [
                f"{name} is given twice; what was seen predicts nothing new"
                for name in sorted(twice)
            ],
        )
    sought = [name for name in ("restitution", "drop_height_m", "gravity_m_s2") if name in settings]
    if sought:
        raise InputError(
            "--set",
            [f"{name} belongs to the bounce; give it with --fix or --prior" for name in sought],
        )


def _plain(value: Any) -> Any:  # noqa: ANN401
    """The same with what is not finite, such as a terminal speed without drag, as ``None``."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _saved(done: Run, out: str | Path | None) -> Run:
    done = replace(done, record=_plain(dict(done.record)))
    if out is None:
        return done
    from simcompare import store

    stored = store.save(done, Path(out))
    assert stored.folder is not None
    (stored.folder / "fit.json").write_text(
        store.to_json(stored.record["fit"], indent=1) + "\n", encoding="utf-8"
    )
    return stored


@dataclass(frozen=True)
class _Asked:
    extra: tuple[str, ...]
    fixed: Mapping[str, float]
    priors: Mapping[str, Prior]


@dataclass(frozen=True)
class _Told:
    scenario: str
    file: ScenarioFile
    recordings: tuple[str, ...]
    command: tuple[str, ...]
    step_s: float | None


def _given(
    file: ScenarioFile, set: Mapping[str, str | float] | None, preset: str | None
) -> dict[str, float]:
    values = {name: parameter.value for name, parameter in file.parameters.items()}
    if preset is not None:
        if preset not in file.presets:
            raise UnknownName(f"preset of {file.name}", preset, file.presets)
        values.update(file.presets[preset].set)
    return {**values, **file.read_settings(set or {})}


def _known_drag(given: Mapping[str, float]) -> dict[str, float]:
    """The terminal speed that the scenario's own drag makes, where it has some."""
    if not given.get("drag_coefficient"):
        return {}
    area = math.pi * given["radius_m"] ** 2
    force = 0.5 * given["air_density_kg_m3"] * given["drag_coefficient"] * area
    return {SPEED: math.sqrt(given["mass_kg"] * given["gravity_m_s2"] / force)}


def _numbers(fixed: Mapping[str, str | float]) -> dict[str, float]:
    found = {}
    for text, value in fixed.items():
        name = units.find_name(text, bounce_models.DEFAULTS)
        if name is None:
            raise UnknownName("parameter of a bounce", text, bounce_models.DEFAULTS)
        found[name] = units.to_si(value, units.unit_of(name), f"--fix {text}")
    return found


def _candidates(model: str, asked: _Asked) -> list[str]:
    """Closed forms that are compared; with a known terminal speed those without drag fall away."""
    if model != "auto":
        return [bounce_models.model_of(model).name]
    known = SPEED in asked.fixed
    return [name for name, one in bounce_models.MODELS.items() if one.drag or not known]


def drops_of(name: str | Path, mapping: str | Path | None, u_s: float | None) -> list[Impacts]:
    """Every drop in a recording, a log, or a table of bounces.

    Raises:
        InputError: nothing that bounces is in it.
    """
    from simcompare.hardware.logs import bounce_table
    from simcompare.validation import sources

    path = bounce_table.facts().get(str(name), Path(name))
    if _is_table(path):
        return _of_table(bounce_table.read(path, _TABLE))
    source = sources.find(str(name), mapping=mapping)
    return list(from_recording(source.recording, u_s=u_s))


def _is_table(path: Path) -> bool:
    """Whether a file is a table of bounces: its first heading is "bounce"."""
    try:
        with path.open("rb") as file:
            lines = file.read(4096).decode("utf-8-sig", errors="replace").splitlines()
    except OSError:
        return False
    heads = [line for line in lines if line.strip() and not line.startswith("#")]
    return bool(heads) and heads[0].replace(";", ",").replace("\t", ",").split(",")[0] == "bounce"


def _of_table(table: BounceTable) -> list[Impacts]:
    """Impact times where the table has them, else rebound heights."""
    times = [quantity for quantity in table.quantities if quantity.name == "impact_time"]
    if not times:
        return [from_table(table)]
    u = [float("nan") if quantity.u is None else quantity.u for quantity in times]
    values = [quantity.value for quantity in times]
    return list(from_times(values, u, kind=CLOCKED, source=table.path.name))


_TABLE = {"restitution": "1", "rebound_height": "m", "impact_time": "s", "impact_speed": "m/s"}


def _joined(best: Fit, drops: Sequence[Impacts], asked: _Asked) -> list[Impacts]:
    """Impacts of videos where arcs with the drag that was found meet, and not parabolas."""
    speed = best.as_dict().get(SPEED, asked.fixed.get(SPEED, math.inf))
    if not math.isfinite(speed):
        return list(drops)
    gravity = float(asked.fixed.get("gravity_m_s2", bounce_models.GRAVITY))
    return [drop if drop.track is None else rejoined(drop, speed, gravity) for drop in drops]


def _for_engines(best: Fit, drops: Sequence[Impacts], asked: _Asked) -> Fit:
    """The fit with the contact that engines have: a restitution that does not depend on speed."""
    model = bounce_models.model_of(best.model)
    if model.law == "constant" and all(drop.track is None for drop in drops):
        return best
    name = "constant+drag" if model.drag or SPEED in asked.fixed else "constant"
    priors = {n: prior for n, prior in asked.priors.items() if n != "exponent"}
    fixed = {n: value for n, value in asked.fixed.items() if n != "exponent"}
    return choose.compare(drops, [name], extra=asked.extra, fixed=fixed, priors=priors).best


def _gather(
    told: _Told,
    choice: choose.Choice,
    start: Fit,
    found: Sequence[EngineFit],
    predicted: Mapping[str, Any],
    drops: tuple[Sequence[Impacts], Sequence[Impacts]],
    given: Mapping[str, float],
) -> Run:
    sources = [
        run_record.of_source(one.engine, FITTED, [one.outcome])
        for one in found
        if one.outcome is not None
    ]
    nominal = engine_fit.scenario_values(start.problem, start.x, 0, given)
    scene = told.file.resolve(nominal, step_s=told.step_s)
    scores = [score for one in found for score in _scores(one)]
    record = run_record.of_run(told.file, [scene], None, sources, scores)
    record["fit"] = records.of_fit(
        told.file.name, choice, start, found, predicted, drops, given, scene.world.step_s
    )
    record.update(
        engines_asked=",".join(one.engine for one in found), scenario_asked=told.scenario,
        against=None, against_asked=None, preset=None, interrupted=False, kind="fit",
        recording_asked=list(told.recordings), command=list(told.command),
    )  # fmt: skip
    stored = [
        Stored(one.engine, FITTED, drop, run)
        for one in found
        for drop, (_, run) in enumerate(one.runs)
    ]
    return Run(record, tuple(scores), tuple(stored))


def _finite(value: float) -> float | None:
    """A number for a file; what has no bound, such as a terminal speed without drag, is none."""
    return float(value) if math.isfinite(value) else None


def _scores(one: EngineFit) -> list[Score]:
    if one.fit is None or one.effective is None:
        return []
    rows = [
        Score(one.engine, FITTED, name, "", None, _finite(value), _finite(u), units.unit_of(name),
              1, None, None, INFO)
        for name, value, u in zip(one.fit.names, one.fit.values, one.fit.u, strict=True)
    ]  # fmt: skip
    value, u = one.effective[0], engine_fit.whole_u(one)
    return [*rows, Score(one.engine, FITTED, "effective_restitution", "", None, value, u, "1",
                         1, None, None, INFO)]  # fmt: skip
