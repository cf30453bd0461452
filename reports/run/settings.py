"""How a run was made, on one line: what differs from the scenario's own, engines, step and day."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare import units
from simcompare.notation import capital
from simcompare.reports.render import numbers
from simcompare.reports.run import audit, runs
from simcompare.reports.run.listing import joined, noun
from simcompare.reports.run.reproduce import scenario_of
from simcompare.results.run import Run

#: so many parameters are named on the line
_NAMED = 4


def settings(run: Run) -> str:
    """The line below the question."""
    day = run.record.created.partition("T")[0]
    return ", ".join([capital(_parameters(run)), _sources(run), _steps(run), day])


def made_with(run: Run) -> tuple[str, ...]:
    """The same with every name and version."""
    record = run.record
    versions = {source.engine or source.name: source.version for source in record.sources}
    known = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    changed = ", ".join(_changed(run))
    return (
        f"Parameters: {changed or 'all as in the scenario'}.",
        f"Engines: {known or 'none ran'}.",
        f"Repeats of each: {record.repeats}; time between samples:"
        f" {numbers.plain(1e3 * record.step_s)} ms; simulated time:"
        f" {numbers.plain(record.duration_s, 4)} s.",
        f"Made on {record.created} with simcompare {record.software.simcompare or '?'}.",
    )


def _parameters(run: Run) -> str:
    preset, changed = run.record.preset, list(_changed(run))
    shown = changed if len(changed) <= _NAMED else [*changed[:_NAMED], "…"]
    names = [f"preset {preset}"] if preset else []
    return ", ".join([*names, *shown]) or "default parameters"


def _changed(run: Run) -> Iterator[str]:
    """Parameters that are not those of the scenario and its preset; all where it is gone."""
    scenario = scenario_of(run, unchanged=False)
    for name, value in run.record.parameters.items():
        if scenario is None or scenario.parameters.get(name) != value:
            unit = units.symbol(units.unit_of(name))
            words = runs.measure_words(name.removesuffix(units.suffix_of(name)))
            yield f"{words} {numbers.plain(value)}{'' if unit == '1' else f' {unit}'}"


def _sources(run: Run) -> str:
    """Engines that ran, counted where they are many."""
    names = list(dict.fromkeys(s.engine or s.name for s in run.record.sources if s.ran))
    if not names:
        return "no engine ran"
    return joined(names) if len(names) < 3 else f"{len(names)} {noun(names)}"


def step_taken(run: Run) -> str:
    """The step of all engines, or from the shortest to the longest; empty where none tells it."""
    held = {audit.step_of(source) for source in run.record.sources if source.ran}
    # some engines hold it in few digits
    steps = dict.fromkeys(_ms(step_s) for step_s in sorted(s for s in held if s is not None))
    if not steps:
        return ""
    first, *others = steps
    return f"steps {first} to {others[-1]} ms" if others else f"step {first} ms"


def _steps(run: Run) -> str:
    """Steps of the engines: several that were asked for, else what they took."""
    asked = [_ms(step.engine_step_s) for step in runs.steps(run)]
    if asked:
        return f"step {joined([f'{step} ms' for step in asked])}"
    scenario = scenario_of(run, unchanged=False)
    parts = 1 if scenario is None else scenario.world.substeps
    return step_taken(run) or f"step {_ms(run.record.step_s / parts)} ms"


def _ms(step_s: float) -> str:
    return numbers.plain(1e3 * step_s, 4)
