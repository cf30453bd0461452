"""What a user may fix, or know beforehand: within what a fit can reach, and said once."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping

from simcompare import units
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.unknowns import BOUNDS, CLOCK, SPEED
from simcompare.results.records.fit_forms import Prior


def faults(
    roles: Roles, fixed: Mapping[str, float], priors: Mapping[str, Prior], sought: Collection[str]
) -> list[str]:
    """Every value outside its limits, and everything that is said in two ways.

    Args:
        roles: the scenario, whose own limits hold as well.
        fixed: what the user fixes, by the closed form's names.
        priors: what the user knows beforehand.
        sought: unknowns that the user names.
    """
    found = [fault for name, value in fixed.items() for fault in _fixed(roles, name, value)]
    found += [fault for name, prior in priors.items() for fault in _prior(roles, name, prior)]
    for name in fixed:
        others = [option for option, names in (("--prior", priors), ("--unknown", sought))
                  if name in names]  # fmt: skip
        found += [f"{_typed(name)} stands in --fix and in {other}; a value is either exact or"
                  " not: leave out one of them" for other in others]  # fmt: skip
    return found


def _fixed(roles: Roles, name: str, value: float) -> Iterator[str]:
    low, high = _range(roles, name)
    if not low <= value <= high:
        yield f"--fix {_typed(name)}={_with_unit(name, value)} is outside {_words(name, low, high)}"


def _prior(roles: Roles, name: str, prior: Prior) -> Iterator[str]:
    low, high = _range(roles, name)
    told = f"--prior {_typed(name)}={_with_unit(name, prior.value)}:{_with_unit(name, prior.u)}"
    if not low <= prior.value <= high:
        yield f"{told}: the value is outside {_words(name, low, high)}{_cure(name, prior)}"
    elif not (prior.u > 0 and math.isfinite(prior.u)):
        yield f"{told}: the uncertainty must be above 0; what is exact is given with --fix"
    elif prior.u > (most := prior.value if name == SPEED else (high - low) / 2):
        yield (f"{told}: the uncertainty is above {_with_unit(name, most)}, so that all of"
               f" {_words(name, low, high)} would be likely{_cure(name, prior)}")  # fmt: skip


def _cure(name: str, prior: Prior) -> str:
    """What is probably meant: a clock's parts per million without their unit."""
    if name != CLOCK:
        return ""
    most = BOUNDS[CLOCK][1]
    value, u = (
        f"{one:g}ppm" if abs(one) > most else f"{1e6 * one:g}ppm" if one else "0"
        for one in (prior.value, prior.u)
    )
    return f"; parts per million are written --prior {_typed(name)}={value}:{u}"


def _range(roles: Roles, name: str) -> tuple[float, float]:
    """What a fit can reach, and the scenario allows."""
    low, high = BOUNDS[name]
    own = next((own for own, called in roles.fitted.items() if called == name), None)
    if own is None:
        return low, high
    parameter = roles.file.parameters[own]
    return max(low, parameter.min), min(high, parameter.max)


def _words(name: str, low: float, high: float) -> str:
    if math.isinf(high):
        return f"{_with_unit(name, low)} and more"
    return f"{_with_unit(name, low)} to {_with_unit(name, high)}"


def _typed(name: str) -> str:
    """As it is typed: without its unit."""
    return name.removesuffix(units.suffix_of(name))


def _with_unit(name: str, value: float) -> str:
    unit = units.symbol(units.unit_of(name))
    return f"{value:g}{'' if unit == '1' else unit}"
