"""What a scenario says of the uncertainty of its parameters: inherited by variants, and faults."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.model import formula
from simcompare.model.expressions import ExpressionError
from simcompare.model.plain import Plain
from simcompare.model.uncertain import Uncertain
from simcompare.statistics.stated import is_nothing, stated


def inherited(base: Plain, change: Plain) -> Plain:
    """The tree of a scenario without what a variant of it does not inherit.

    That is what is said of parameters that the variant takes away, all formulas, and how a table of
    results is read: its motion may be another one.
    """
    base = {key: value for key, value in base.items() if key != "table"}
    said, changed = base.get("uncertainty"), change.get("parameters")
    if not isinstance(said, dict) or not isinstance(said.get("inputs"), dict):
        return base
    changed = changed if isinstance(changed, dict) else {}
    gone = {name for name, one in changed.items() if one is None}
    kept = {name: one for name, one in said["inputs"].items() if name not in gone}
    return {**base, "uncertainty": {"inputs": kept}}


def uncertain_faults(said: Uncertain, values: Mapping[str, float]) -> dict[str, str]:
    """Every fault as place -> sentence.

    Args:
        said: what the scenario says.
        values: of its parameters.
    """
    faults = {}
    for name, one in said.inputs.items():
        for fault in _of_input(name, one.u, values):
            faults[f"uncertainty.inputs.{name}"] = fault
    for name, text in said.formulas.items():
        for fault in _of_formula(text, values):
            faults[f"uncertainty.formulas.{name}"] = fault
    return faults


def _of_input(name: str, text: str | float, values: Mapping[str, float]) -> Iterator[str]:
    if name not in values:
        yield str(UnknownName("parameter", name, values))
        return
    if is_nothing(text, values[name]):
        return
    try:
        stated(text, values[name], units.unit_of(name), "u")
    except InputError as error:
        yield str(error)


def _of_formula(text: str, values: Mapping[str, float]) -> Iterator[str]:
    try:
        names = formula.read(text).names
    except ExpressionError as error:
        yield str(error)
        return
    yield from (str(UnknownName("parameter", name, values)) for name in names if name not in values)
