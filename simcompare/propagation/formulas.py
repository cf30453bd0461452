"""The uncertainty of a formula: traced by GTC, and by a million trials."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.model.expressions import ExpressionError
from simcompare.model.formula import Formula, read, shown
from simcompare.propagation.propagated import Asked, Propagated, traced, with_trials
from simcompare.statistics.budget import Budget

#: trials of a formula at least: they take less than two seconds
TRIALS = 1_000_000


def formula_of(text: str, where: str = "--of") -> Formula:
    """Reads a formula.

    Raises:
        InputError: it is more than arithmetic, or none.
    """
    try:
        return read(text)
    except ExpressionError as error:
        raise InputError(where, [str(error)]) from None


def asked_of(text: str) -> Formula:
    """Reads a formula whose uncertainty is asked for.

    Raises:
        InputError: it is more than arithmetic, or none, or a number alone.
    """
    formula = formula_of(text)
    if not formula.names:
        value = value_of(formula, {})
        fault = f"{shown(text)} is {value:.6g} and names no quantity, so nothing is uncertain"
        raise InputError("--of", [f"{fault}; expected a formula such as 2*tau/r"])
    return formula


def propagated(formula: Formula, values: Mapping[str, float], asked: Asked) -> Propagated:
    """Budget and Monte Carlo of a formula.

    Args:
        formula: the formula.
        values: of all its quantities [SI].
        asked: those that are uncertain.

    Raises:
        InputError: it has no finite value at the estimates, or for some draws.
    """
    exact = {name: np.float64(value) for name, value in values.items() if name in formula.names}

    def model(**drawn: Any) -> Any:  # noqa: ANN401
        return formula.at({**exact, **drawn})

    return with_trials(
        asked, first_order(formula, exact, asked), model, max(asked.trials or 0, TRIALS)
    )


def first_order(formula: Formula, exact: Mapping[str, float], asked: Asked) -> Budget:
    """The budget alone.

    Raises:
        InputError: the formula has no finite value at the estimates, or no finite slope.
    """
    known = {name: one.center for name, one in asked.inputs.items()}
    value_of(formula, {**exact, **known})
    functions = _functions()
    plain = {name: float(value) for name, value in exact.items()}

    def model(**numbers: Any) -> Any:  # noqa: ANN401
        return formula.at({**plain, **numbers}, functions)

    try:
        return traced(asked, model)
    except ExpressionError:
        fault = f"{shown(formula.text)} changes without limit at the estimates: it has no slope"
        raise InputError("--of", [f"{fault} there; expected others"]) from None


def value_of(formula: Formula, values: Mapping[str, float]) -> float:
    """The formula's value.

    Raises:
        InputError: it is no finite number.
    """
    try:
        with np.errstate(all="ignore"):
            value = float(formula.at({name: np.float64(one) for name, one in values.items()}))
    except ExpressionError as error:
        raise InputError("--of", [str(error)]) from None
    if not math.isfinite(value):
        told = ", ".join(f"{name} = {values[name]:.6g}" for name in formula.names)
        at = f" at {told}" if told else ""
        raise InputError("--of", [f"{shown(formula.text)} gives no finite number{at}"])
    return value


def unit_of(formula: Formula, values: Mapping[str, float], units_of: Mapping[str, str]) -> str:
    """SI unit of the result, "1" where no quantity has a unit.

    Raises:
        InputError: units that cannot be added, such as m + kg.
    """
    if all(unit == "1" for unit in units_of.values()):
        return "1"
    try:
        return units.unit_of_result(lambda of: formula.at(of, _OF_UNITS), values, units_of)
    # pint raises many kinds for what does not fit
    except Exception as error:  # noqa: BLE001
        raise InputError(
            "--of", [f"the units do not fit: {error}; give each quantity its unit, or none to all"]
        ) from None


def unit_of_names(formula: Formula, values: Mapping[str, float]) -> str:
    """SI unit of a formula whose quantities have theirs in their names."""
    return unit_of(formula, values, {name: units.unit_of(name) for name in values})


@functools.cache
def _functions() -> Mapping[str, Callable[..., Any]]:
    """What a formula may call, for numbers of GTC and plain ones."""
    import GTC

    names = ("sqrt", "exp", "log", "sin", "cos", "tan", "atan2")
    return {
        **{name: _of_both(getattr(GTC, name), name) for name in names},
        "abs": lambda a: a if _number(a) >= 0 else -a,
        "min": lambda a, b: a if _number(a) <= _number(b) else b,
        "max": lambda a, b: a if _number(a) >= _number(b) else b,
    }


def _of_both(traced_one: Callable[..., Any], name: str) -> Callable[..., Any]:
    plain = getattr(np, {"atan2": "arctan2"}.get(name, name))

    def called(*values: Any) -> Any:  # noqa: ANN401
        is_plain = all(isinstance(value, float) for value in values)
        return plain(*values) if is_plain else traced_one(*values)

    return called


def _number(value: Any) -> float:  # noqa: ANN401
    return float(getattr(value, "x", value))


_OF_UNITS: Mapping[str, Callable[..., Any]] = {
    "sqrt": lambda a: a**0.5,
    **{name: getattr(np, name) for name in ("exp", "log", "sin", "cos", "tan")},
    "atan2": np.arctan2,
    "abs": abs,
    "min": lambda a, b: min(a, b),
    "max": lambda a, b: max(a, b),
}


@dataclass(frozen=True)
class Quantities:
    """What a formula is given.

    Attributes:
        values: of each quantity [SI].
        units: their SI units, "1" for plain numbers.
    """

    values: Mapping[str, float]
    units: Mapping[str, str]


def quantities_of(formula: Formula, given: Mapping[str, str | float]) -> Quantities:
    """Reads ``{"tau": "20 mN*m", "m": 0.6}``; a unit may also be in the name, as in ``r_m``.

    Raises:
        InputError: names that the formula has not, values that cannot be read or lack, all at once.
    """
    faults = [
        str(UnknownName("quantity of the formula", name, formula.names))
        for name in given
        if name not in formula.names
    ]
    values, found_units = {}, {}
    for name in formula.names:
        if name not in given:
            faults.append(f"{name} has no value; give --set {name}=VALUE")
            continue
        try:
            values[name], found_units[name] = _read(name, given[name])
        except InputError as error:
            faults.append(str(error))
    if faults:
        raise InputError("--set", faults)
    return Quantities(values, found_units)


def _read(name: str, text: str | float) -> tuple[float, str]:
    if units.suffix_of(name):
        unit = units.unit_of(name)
        return units.to_si(text, unit, name), unit
    return units.quantity(text, name)
