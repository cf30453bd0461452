"""What is known of the inputs of a result: from the user, else from the scenario."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import RootModel, ValidationError, model_validator

from simcompare import units
from simcompare.errors import InputError, UnknownName
from simcompare.model.frozen import Frozen
from simcompare.model.yaml_file import describe, faults_of, read_yaml
from simcompare.scenarios.scenario_file import ScenarioFile
from simcompare.statistics.distributions import Distribution
from simcompare.statistics.joint import Correlation
from simcompare.statistics.stated import is_nothing, stated

#: what is taken as exact
EXACT = "exact"
#: key of a file that is no input
_CORRELATION = "correlation"
#: the reason of what the user gives
GIVEN = "as given"


@dataclass(frozen=True)
class Input:
    """One input that is uncertain.

    Attributes:
        name: of the parameter or quantity.
        stated: its uncertainty, as it was stated.
        reason: by what it was measured.
        unit: SI unit, "1" for a plain number.
    """

    name: str
    stated: str
    reason: str
    unit: str


@dataclass(frozen=True)
class Known(Input):
    """The same with what is known of it.

    Attributes:
        distribution: about its best estimate [SI].
        degrees_of_freedom: of its standard uncertainty.
    """

    distribution: Distribution
    degrees_of_freedom: float = math.inf


@dataclass(frozen=True)
class InputsFile:
    """A YAML file of inputs.

    Attributes:
        values: estimates that it gives.
        uncertainties: input -> uncertainty as it is stated.
        reasons: of those that have one.
        correlation: pairs of names -> coefficient.
    """

    values: Mapping[str, str | float]
    uncertainties: Mapping[str, str | float]
    reasons: Mapping[str, str]
    correlation: Correlation


class _Entry(Frozen):
    value: str | float | None = None
    u: str | float | None = None
    reason: str = GIVEN

    @model_validator(mode="before")
    @classmethod
    def _alone(cls, given: object) -> object:
        """An uncertainty alone needs no braces."""
        return {"u": given} if isinstance(given, str | int | float) else given


class _Content(RootModel[dict[str, _Entry]]):
    pass


class _Pairs(Frozen):
    correlation: tuple[tuple[str, str, float], ...] = ()


def read_file(path: Path) -> InputsFile:
    """Reads a file of inputs.

    Such as::

        wheel_radius_m: {u: ±0.05mm, reason: "Calliper with a resolution of 0.1 mm."}
        torque_N_m: 2%
        correlation:
          - [wheel_radius_m, torque_N_m, 0.5]

    Raises:
        InputError: it cannot be read, or what is wrong in it, all at once.
    """
    tree, lines, faults = read_yaml(path)
    if not isinstance(tree, dict):
        raise InputError(str(path), ["is no mapping; expected lines such as torque_N_m: 2%"])
    pairs = {key: tree.pop(key) for key in [_CORRELATION] if key in tree}
    entries: Mapping[str, _Entry] = {}
    correlation = _Pairs()
    try:
        entries = _Content.model_validate(tree).root
    except ValidationError as error:
        faults = {**faults_of(error), **faults}
    try:
        correlation = _Pairs.model_validate(pairs)
    except ValidationError as error:
        faults = {**faults_of(error), **faults}
    if faults:
        raise InputError(str(path), describe(faults, lines))
    return InputsFile(
        {name: one.value for name, one in entries.items() if one.value is not None},
        {name: one.u for name, one in entries.items() if one.u is not None},
        {name: one.reason for name, one in entries.items()},
        {(one, other): r for one, other, r in correlation.correlation},
    )


NO_FILE = InputsFile({}, {}, {}, {})


def of_scenario(
    file: ScenarioFile,
    values: Mapping[str, float],
    given: Mapping[str, str | float],
    reasons: Mapping[str, str],
) -> tuple[Known, ...]:
    """The scenario's own inputs, with what the user says of them; what is exact is left out.

    Args:
        file: the scenario.
        values: of all its parameters [SI].
        given: parameter -> uncertainty, with or without the unit in its name.
        reasons: of those that were given.

    Raises:
        InputError: unknown parameters and what cannot be read, all at once, or nothing is given.
    """
    said = {} if file.uncertainty is None else file.uncertainty.inputs
    texts: dict[str, str | float] = {
        name: one.u for name, one in said.items() if not is_nothing(one.u, values[name])
    }
    why = {name: one.reason for name, one in said.items()}
    faults: list[str] = []
    taken: set[str] = set()
    for name, text in given.items():
        found = units.find_name(name, file.parameters)
        if found is None:
            faults.append(str(UnknownName("parameter", name, file.parameters)))
        elif found in taken:
            faults.append(f"{found} is given twice, with and without its unit")
        else:
            taken.add(found)
            texts[found], why[found] = text, reasons.get(name, GIVEN)
    known = _read(texts, why, values, {n: units.unit_of(n) for n in texts}, faults)
    if faults:
        raise InputError(f"{file.name}, --u", faults)
    if not known:
        such = next(iter(file.parameters), "name")
        raise InputError(
            "--u", [f"{file.name} says of no parameter how well it is known; give --u {such}=1%"]
        )
    return known


def of_formula(
    names: Iterable[str],
    values: Mapping[str, float],
    units_of: Mapping[str, str],
    given: Mapping[str, str | float],
    reasons: Mapping[str, str],
) -> tuple[Known, ...]:
    """The inputs of a formula that are not exact.

    Args:
        names: that the formula has.
        values: of all of them [SI].
        units_of: their SI units.
        given: name -> uncertainty.
        reasons: of those that have one.

    Raises:
        InputError: unknown names and what cannot be read, all at once, or nothing is given.
    """
    names = list(names)
    faults = [
        str(UnknownName("quantity of the formula", name, names))
        for name in given
        if name not in names
    ]
    texts = {name: given[name] for name in names if name in given}
    known = _read(texts, reasons, values, units_of, faults)
    if not known and not faults:
        faults = [f"nothing is uncertain; give an uncertainty such as --u {names[0]}=1%"]
    if faults:
        raise InputError("--u", faults)
    return known


def _read(
    texts: Mapping[str, str | float],
    reasons: Mapping[str, str],
    values: Mapping[str, float],
    units_of: Mapping[str, str],
    faults: list[str],
) -> tuple[Known, ...]:
    """What is known of each; faults are added."""
    known = []
    for name, text in texts.items():
        if text == EXACT:
            continue
        try:
            found = stated(text, values[name], units_of[name], name)
        except InputError as error:
            faults.append(str(error))
            continue
        why, unit = reasons.get(name, GIVEN), units_of[name]
        degrees = found.degrees_of_freedom
        known.append(Known(name, _shown(text), why, unit, found.distribution, degrees))
    return tuple(known)


def named(correlation: Correlation, known: Sequence[Known]) -> Correlation:
    """The same with the whole names of the inputs, which were given with or without their unit."""
    names = [one.name for one in known]
    return {
        (units.find_name(one, names) or one, units.find_name(other, names) or other): r
        for (one, other), r in correlation.items()
    }


def _shown(text: Any) -> str:  # noqa: ANN401
    return str(text).replace("+/-", "±").replace("+-", "±").strip()
