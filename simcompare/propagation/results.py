"""The results of a scenario: every number that its measures find in a run."""

from __future__ import annotations

import math
from collections.abc import Mapping

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
    names = list(measures.results_of(scenario))
    if of is None:
        of = scenario.answer.measure if scenario.answer else None
    if of is None:
        such = ", ".join(names) or "none"
        raise InputError("--of", [f"name a result of {scenario.name}; there are: {such}"])
    if of not in names:
        raise UnknownName(f"result of {scenario.name}", of, names)
    return of


def value_of(scenario: Scenario, trajectory: Trajectory, of: str) -> float:
    """A result of one run.

    Raises:
        InputError: it cannot be measured in that run; names what can.
    """
    measure = next(one for one in scenario.measures if of in _names(one, scenario))
    values, why = _values(measure, scenario, trajectory)
    if of in values:
        return values[of]
    others = [one for each in scenario.measures for one in _values(each, scenario, trajectory)[0]]
    cure = f"; single results are: {', '.join(others)}" if others else ""
    raise InputError(of, [f"it has no single value in {trajectory.source}{why}{cure}"])


def _names(measure: Measure, scenario: Scenario) -> list[str]:
    return [measure.name_of(name) for name in measures.units_of(measure, scenario)]


def _values(
    measure: Measure, scenario: Scenario, trajectory: Trajectory
) -> tuple[Mapping[str, float], str]:
    """The single values that a measure finds, and a remark where it finds none."""
    seen = measures.take(measure, scenario, trajectory)
    function = measures.load(measure.function)
    # what is measured once per event may be judged by its mean
    judged = {} if seen.lacking else function.against(seen, seen)
    means = {name: value for name, (value, _) in judged.items() if name in function.series}
    found = {
        measure.name_of(name): float(value)
        for name, value in {**seen.values, **means}.items()
        if value is not None and math.isfinite(value)
    }
    why = seen.lacking or "; ".join(seen.notes)
    return found, f" ({why})" if why else ""
