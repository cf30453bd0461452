"""Values and units of the quantities of a formula, as a user gives them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.model.formula import Formula


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
