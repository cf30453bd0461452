"""The results of a scenario: every number that its measures find in a run."""

from __future__ import annotations

import math

from simcompare import measures
from simcompare.errors import InputError, UnknownName
from simcompare.model.scenario import Measure, Scenario
from simcompare.model.trajectory import Trajectory


def chosen(scenario: Scenario, of: str | None) -> str:
    """The result that is asked for; the one that answers the scenario's question where ``None``.

    Raises:
        UnknownName: the scenario has none of that name.
        InputError: none is asked for, and the scenario has no answer.
    """
    names = list(units_of(scenario))
    if of is None:
        of = scenario.answer.measure if scenario.answer else None
    if of is None:
        such = ", ".join(names) or "none"
        raise InputError("--of", [f"name a result of {scenario.name}; there are: {such}"])
    if of not in names:
        raise UnknownName(f"result of {scenario.name}", of, names)
    return of


def units_of(scenario: Scenario) -> dict[str, str]:
    """Every result -> its unit."""
    return {
        measure.name_of(name): unit
        for measure in scenario.measures
        for name, unit in measures.units_of(measure, scenario).items()
    }


def value_of(scenario: Scenario, trajectory: Trajectory, of: str) -> float:
    """A result of one run.

    Raises:
        InputError: it cannot be measured in that run.
    """
    measure = _measure(scenario, of)
    seen = measures.take(measure, scenario, trajectory)
    # what is judged may be a mean of what is measured once per event
    function = measures.load(measure.function)
    judged = {} if seen.lacking else function.against(seen, seen)
    means = {name: value for name, (value, _) in judged.items() if name in function.series}
    values = {**seen.values, **means}
    value = {measure.name_of(name): value for name, value in values.items()}.get(of)
    if value is None or not math.isfinite(value):
        why = seen.lacking or "; ".join(seen.notes) or "it has no single value there"
        raise InputError(of, [f"it cannot be measured in {trajectory.source}: {why}"])
    return float(value)


def _measure(scenario: Scenario, of: str) -> Measure:
    return next(
        measure
        for measure in scenario.measures
        if of in map(measure.name_of, measures.units_of(measure, scenario))
    )
