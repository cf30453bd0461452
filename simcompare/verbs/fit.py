"""The verb ``fit``: parameters from measurements, on every engine, with uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from simcompare.arguments import checked
from simcompare.engine import engines
from simcompare.errors import InputError
from simcompare.model import plain
from simcompare.model.fittable import TOSSES, WAVEFORM
from simcompare.results import store
from simcompare.results.records.fit import FitRecord
from simcompare.running.runner import TIME_LIMIT_S, Progress, kept_processes
from simcompare.scenarios import catalogue
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.verbs import levels
from simcompare.verbs.notebook_line import with_line
from simcompare.verbs.request import FitRequest
from simcompare.verbs.result import Result


@checked
@with_line
def fit(
    scenario: str | Path = "ball",
    *,
    recordings: str | Path | Sequence[str | Path],
    hold_out: str | Path | Sequence[str | Path] = (),
    engine: str | Sequence[str] = "all",
    model: str = "auto",
    unknowns: str | Sequence[str] = (),
    fixed: Mapping[str, str | float] | None = None,
    priors: Mapping[str, tuple[float, float]] | None = None,
    u_time_s: float | None = None,
    set: Mapping[str, str | float] | None = None,
    preset: str | None = None,
    mapping: str | Path | None = None,
    step: str | float | None = None,
    assist: str | Sequence[str] | None = None,
    out: str | Path | None = None,
    trust: bool = False,
    time_limit_s: float = TIME_LIMIT_S,
    progress: Progress | None = None,
) -> Result:
    """Fits a scenario to a measurement: to impacts and heights, signals over time, or tosses.

    ::

        fit = simcompare.fit("pendulum", recordings=["pendulum_free_swing"], engine="mujoco")
        fit.table()  # parameters with their uncertainty
        fit.plot()  # measured and simulated

    Args:
        scenario: name, folder or file of a scenario that says under ``fit:`` how it is fitted.
        recordings: log, stored recording, public data set or bounce table that is fitted; a list
            of several.
        hold_out: the same, which are not fitted but predicted.
        engine: ``"all"``, names with commas or a list of names.
        model: closed form, or "auto": all, averaged by their weights.
        unknowns: what is fitted beside what the model has, such as "clock_skew"; by waveform
            and by tosses, all that is fitted.
        fixed: values of what is not fitted; by tosses also the "scale" of measured lengths. By
            bounces, gravity and the recorder's clock have an uncertainty where nothing is said.
        priors: unknown -> value and standard uncertainty.
        u_time_s: standard uncertainty of an impact time, where a recording does not say [s].
        set: parameters of the scenario, such as the ball's mass.
        preset: named set of parameters, applied first.
        mapping: mapping file for the logs.
        step: the engine's step, which engines are tuned for; the scenario's own where ``None``.
        assist: our helps with which engines are run: "none", for which bounces are fitted if
            nothing is said, "all", or names (``simcompare.engine.helps``); by waveform always
            "all", by tosses too if nothing is said.
        out: folder in which the run's own folder is made; nothing is stored where ``None``.
        trust: run the Python files beside the scenario, where it comes from elsewhere; a yes is
            remembered until they change.
        time_limit_s: longest time for one simulation [s].
        progress: called as jobs end.

    Returns:
        The run; ``record.fit`` holds what was found, and goes into fit.json.

    Raises:
        InputError: every fault of the request or of a recording.
    """
    scenario, engine = str(scenario), engines.listed(engine)
    recordings, hold_out = _listed(recordings), _listed(hold_out)
    unknowns = levels.names(unknowns)
    options = FitRequest(
        scenario=scenario, recordings=tuple(recordings), hold_out=tuple(hold_out), engine=engine,
        model=model, unknowns=tuple(unknowns), fixed=fixed, priors=priors, u_time_s=u_time_s,
        set=set, preset=preset, mapping=mapping, step=step, assist=assist,
    )  # fmt: skip
    engines.select(engine)  # a wrong name is told before a folder is made
    file = catalogue.load(scenario, trust=trust)
    if not recordings:
        raise InputError("--recording", ["no recording is given; give at least one"])
    if file.fit is None:
        raise InputError(
            scenario,
            ["names nothing that can be fitted; expected fit: {by: bounces|waveform|tosses, …}"],
        )
    if out is not None:
        store.check_writable(Path(out))
    with kept_processes():
        done = _of_kind(file.fit.by)(file, options, time_limit_s, progress)
    return _saved(done, out)


def _of_kind(kind: str) -> Callable[[ScenarioFile, FitRequest, float, Progress | None], Result]:
    """Of the three kinds of fits only what the one needs is imported."""
    if kind == WAVEFORM:
        from simcompare.verbs.fit_waveforms import fit_waveform

        return fit_waveform
    if kind == TOSSES:
        from simcompare.verbs.fit_tosses import fit_tosses

        return fit_tosses
    from simcompare.verbs.fit_bounces import fit_bounces

    return fit_bounces


def _listed(recordings: str | Path | Sequence[str | Path]) -> Sequence[str | Path]:
    return [recordings] if isinstance(recordings, str | Path) else recordings


def _saved(done: Result, out: str | Path | None) -> Result:
    if out is None:
        return done
    assert isinstance(done.record, FitRecord)
    fit = plain.text(done.record.fit, indent=1) + "\n"
    return store.save(done, Path(out), {"fit.json": fit})
