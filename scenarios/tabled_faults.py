"""Faults in what a scenario says of tables of results."""

from __future__ import annotations

from collections.abc import Mapping

from simcompare import measures, units
from simcompare.errors import InputError, UnknownName
from simcompare.model import expressions
from simcompare.model.scenario import Scenario
from simcompare.model.tabled import Assumed, Tabled
from simcompare.statistics.stated import stated


def tabled_faults(
    said: Tabled, values: Mapping[str, float], scenario: Scenario | None
) -> dict[str, str]:
    """Every fault as place -> sentence.

    Args:
        said: what the scenario says.
        values: of its parameters.
        scenario: it with numbers, ``None`` where it has faults itself.
    """
    faults = {}
    for place, name in {"tells": said.tells, "offset": said.offset}.items():
        if name is not None and name not in values:
            faults[f"table.{place}"] = str(UnknownName("parameter", name, values))
    for name, one in said.assume.items():
        if fault := _of_assumed(name, one, values):
            faults[f"table.assume.{name}"] = fault
    known = [*values, *(measures.results_of(scenario) if scenario else said.columns)]
    for name in said.columns:
        if name not in known:
            faults[f"table.columns.{name}"] = str(
                UnknownName("parameter or measured value", name, known)
            )
    return faults


def _of_assumed(name: str, one: Assumed, values: Mapping[str, float]) -> str:
    if name not in values:
        return str(UnknownName("parameter", name, values))
    try:
        value = value_of(one, values)
        if one.u is not None:
            stated(one.u, value, units.unit_of(name), "u")
    except (expressions.ExpressionError, InputError) as error:
        return str(error)
    return ""


def value_of(one: Assumed, values: Mapping[str, float]) -> float:
    """The value that is assumed, SI.

    Raises:
        ExpressionError: it is an expression that cannot be evaluated.
    """
    if isinstance(one.value, str):
        return expressions.evaluate(one.value, values)
    return one.value
