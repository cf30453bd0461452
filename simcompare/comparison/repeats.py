"""The repeats of a scenario at each step that is asked for, and their truths."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from simcompare import measures, notation, units
from simcompare.comparison import memory
from simcompare.engine.calibration.plan import drop_plans
from simcompare.engine.drives import input_values
from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.errors import InputError
from simcompare.model.scenario import MAX_SAMPLES, Scenario
from simcompare.model.settings import DropPlan
from simcompare.model.trajectory import AT, TRUTH, Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.reference_file import Reference
from simcompare.scenarios.scenario_file import ScenarioFile

#: samples below which a run shows nothing
MIN_SAMPLES = 100
#: 0,5ms: half a millisecond, and not a step without unit before one of 5 ms
_DECIMAL_COMMA = re.compile(r"(?<![\d.])(\d+),(\d+\s*[a-zµμ]+)")


@dataclass(frozen=True)
class AtStep:
    """A scenario at one step, with all that depends on the step.

    Attributes:
        label: what the step adds to the name of a source, "@2ms"; empty where it is the only one.
        scenarios: one for each repeat, the nominal one at index n//2.
        truths: their truths, ``None`` where the scenario has no reference.
        drops: impacts for which engines are tuned.
    """

    label: str
    scenarios: Sequence[Scenario]
    truths: Sequence[Trajectory | None]
    drops: tuple[DropPlan, ...]

    @property
    def nominal(self) -> Scenario:
        """The repeat in the middle."""
        return self.scenarios[len(self.scenarios) // 2]


def at_steps(
    file: ScenarioFile,
    values: Mapping[str, float],
    preset: str | None,
    steps_s: Sequence[float | None],
    count: int | None,
    sources: int,
) -> list[AtStep]:
    """The scenario at every step, in the order in which they are given.

    Args:
        file: the scenario.
        values: parameters that differ from the file, SI.
        preset: named set of parameters, applied first.
        steps_s: times between samples [s]; ``None``: the scenario's own.
        count: number of repeats; the scenario's own where ``None``.
        sources: engines times levels.

    Raises:
        InputError: a step at which the scenario, or its truth, makes no sense, or more than this
            machine can hold.
    """
    steps: list[AtStep] = []
    if len(steps_s) > 1:
        nominal = file.resolve(values, preset=preset)
        repeats = count or (nominal.dither.count if nominal.dither else 1)
        given_s = [step_s or nominal.world.step_s for step_s in steps_s]
        memory.check(nominal, repeats, sources, "--step", given_s)
    for step_s in steps_s:
        scenarios = repeats_of(file, values, preset, step_s, count, sources)
        nominal = scenarios[len(scenarios) // 2]
        label = f"{AT}{step_words(nominal.world.engine_step_s)}" if len(steps_s) > 1 else ""
        # beyond where it holds, a truth tells nothing
        truths = [None] * len(scenarios) if nominal.beyond else truths_of(file.path, scenarios)
        steps.append(AtStep(label, scenarios, truths, drop_plans(nominal)))
    return steps


def step_words(step_s: float) -> str:
    """A step as it is typed, such as "0.5ms"."""
    return f"{1e3 * step_s:.12g}ms"


def read_steps(step: str | float | Sequence[str | float] | None) -> list[str | float]:
    """The steps that were asked for, each as it was given.

    Raises:
        InputError: a list with an empty place.
    """
    if step is None:
        return []
    if isinstance(step, str) and _DECIMAL_COMMA.search(step):
        point = _DECIMAL_COMMA.sub(r"\1.\2", step)
        raise InputError("--step", [f"{step!r} has a decimal comma; write {point}"])
    each = step.split(",") if isinstance(step, str) else step
    steps: list[str | float] = [each] if isinstance(each, int | float | np.number) else [*each]
    if not steps or any(isinstance(one, str) and not one.strip() for one in steps):
        raise InputError("--step", [f"{step!r} lacks a step; expected such as 1ms, or 0.5ms,1ms"])
    return steps


def one_step_s(step: str | float) -> float:
    """A step where only one is taken [s].

    Raises:
        InputError: several, or no time above 0.
    """
    if isinstance(step, str) and "," in step and units.with_point(step) is None:
        raise InputError("--step", [f"{step}: expected one step; only run takes several"])
    step_s = units.to_si(step, "s", "--step")
    if not step_s > 0:
        raise InputError("--step", [f"{step} is not a time above 0; expected such as 1ms"])
    return step_s


def sample_steps_s(
    file: ScenarioFile,
    values: Mapping[str, float],
    preset: str | None,
    step: str | float | Sequence[str | float] | None,
) -> list[float]:
    """Times between samples for the steps that were asked for, each once.

    Raises:
        InputError: a step that makes no sense in the scenario; says which do.
    """
    asked = read_steps(step)
    nominal = file.resolve(values, preset=preset) if asked else None
    sampled_s = [_sampled_s(nominal, one) for one in asked if nominal is not None]
    return list({step_words(step_s): step_s for step_s in sampled_s}.values())


def repeats_of(
    file: ScenarioFile,
    values: Mapping[str, float],
    preset: str | None,
    step_s: float | None,
    count: int | None,
    sources: int = 1,
) -> list[Scenario]:
    """The scenario once for every dithered repeat, the nominal one at index n//2.

    The dithered parameter takes the values p + (i - n//2)/n · span for i = 0 … n-1.

    Raises:
        InputError: values out of bounds, a step so long that the spread leaves what makes sense, or
            more than this machine can hold.
    """
    nominal = file.resolve(values, preset=preset, step_s=step_s)
    dither = nominal.dither
    where = file.name if count is None else "--seeds"
    count = (dither.count if dither else 1) if count is None else count
    memory.check(nominal, count, sources, where)
    if dither is None:
        return [nominal]
    centre = nominal.parameters[dither.parameter]
    if dither.span >= 2 * centre and file.parameters[dither.parameter].min >= 0:
        raise InputError(
            "--step",
            [
                f"{nominal.world.step_s:g} s spreads {dither.parameter} by {dither.span:.3g}"
                f" about {centre:.3g}, below 0; use a shorter step"
            ],
        )
    offsets = [(i - count // 2) / count * dither.span for i in range(count)]
    return [
        file.vary(nominal, dither.parameter, centre + offset) if offset else nominal
        for offset in offsets
    ]


def sample_step_s(
    file: ScenarioFile, values: Mapping[str, float], preset: str | None, step: str | float
) -> float:
    """Time between samples for an engine's step; they are as much coarser as the scenario says.

    Raises:
        InputError: a step that makes no sense in the scenario; says which do.
    """
    return _sampled_s(file.resolve(values, preset=preset), step)


def _sampled_s(nominal: Scenario, step: str | float) -> float:
    step_s = one_step_s(step) * nominal.world.substeps
    check_sample_step(nominal, step, step_s)
    return step_s


def check_sample_step(scenario: Scenario, step: str | float, sampled_s: float) -> None:
    """Refuses a step that makes no sense in the time that a scene lasts.

    Args:
        scenario: the scene, with a step that does.
        step: the engine's step as it was given.
        sampled_s: time between samples that it gives [s].

    Raises:
        InputError: it is too long or too short; says which are not.
    """
    duration_s, parts = scenario.world.duration_s, scenario.world.substeps
    low_s, high_s = duration_s / MAX_SAMPLES / parts, duration_s / MIN_SAMPLES / parts
    step_s = sampled_s / parts
    if low_s <= step_s <= high_s:
        return
    low_s, high_s = notation.rounded_within(low_s, high_s)
    wrong = f"too {'short' if step_s < low_s else 'long'} for {notation.amount(duration_s, 's')}"
    usual = step_words(scenario.world.engine_step_s)
    fault = f"{step_found(step, step_s)} is {wrong}; {step_wanted(step_s, low_s, high_s, usual)}"
    raise InputError("--step", [fault])


def step_found(step: str | float, step_s: float) -> str:
    """A wrong step as a subject, which says that a bare number is in seconds."""
    if isinstance(step, str) and not step.strip()[-1:].isdigit():
        return step
    return f"a bare number is in seconds, and {notation.amount(step_s, 's')}"


def step_wanted(step_s: float, low_s: float, high_s: float, usual: str) -> str:
    """Which steps are taken, and the one that may have been meant."""
    such = notation.meant(step_s, "s", low_s, high_s) or usual
    return f"use {notation.span(low_s, high_s, 's')}, such as {such}"


def truths_of(path: Path, scenarios: Sequence[Scenario]) -> list[Trajectory | None]:
    """The truth of every repeat, ``None`` where the scenario has no reference.

    Raises:
        InputError: the reference fails or returns what cannot be a truth.
    """
    reference = catalogue.reference_of(path)
    if reference is None:
        return [None] * len(scenarios)
    try:
        return [_truth(reference, scenario) for scenario in scenarios]
    except InputError:  # it refuses these parameters, and says why
        raise
    # a user's own code may raise anything, also SystemExit
    except (Exception, SystemExit) as error:
        where = str(path.with_name("reference.py"))
        message = f"reference() failed: {type(error).__name__}: {error}"
        raise InputError(where, [message]) from error


def _truth(reference: Reference, scenario: Scenario) -> Trajectory:
    times = sample_times(scenario)
    signals = dict(reference(scenario.parameters, times, scenario.inputs))
    complete(scenario, times, signals, input_values(scenario, times))
    truth = Trajectory(TRUTH, times, signals)
    for measure in scenario.measures:
        for probe in (measure.probe, *measure.also.values()):
            measures.observe(truth, scenario.probes[probe])
    return truth
