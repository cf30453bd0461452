"""What a fit refuses: what no fit can reach or is said twice, and nonsense that was found."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence

from simcompare import units
from simcompare.errors import InputError
from simcompare.fitting.bounces.averaging import Averaged
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.unknowns import BOUNDS, CLOCK, SCALE, SPEED, base, own_drop
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


def check_scale(drops: Sequence[Impacts], options: Mapping[str, Collection[str]]) -> None:
    """Raises ``InputError`` where a scale is given by an option, but nothing was filmed."""
    if any(drop.track is not None for drop in drops):
        return
    faults = [
        f"{option} gives a scale, which is that of lengths in a video, and no recording is one;"
        " leave it out"
        for option, names in options.items() if SCALE in names
    ]  # fmt: skip
    if faults:
        raise InputError("scale", faults)


def check_found(laws: Averaged, roles: Roles) -> None:
    """Raises ``InputError`` where no restitution was found, or a height that no scene has."""
    best = laws.shares[0].fit
    sources = ", ".join(dict.fromkeys(drop.source for drop in best.problem.drops if drop.source))
    faults = _heights(laws, roles)
    is_far = any(base(name) == "drop_height_m" for name in best.at_bound)
    least = min(best.restitution_at(speed)[0] for speed in best.speeds_m_s)
    is_lossless = least > BOUNDS["restitution"][1]
    if (is_lossless or "restitution" in best.at_bound) and not (is_far and faults):
        faults = [_no_restitution(least if is_lossless else best.as_dict()["restitution"])]
    if faults:
        raise InputError(sources or "fit", faults)


def _no_restitution(value: float) -> str:
    seen = "do not become lower" if value > 0.5 else "end at once"
    return (
        f"the data tell no restitution: the bounces {seen}, which would be a restitution of"
        f" {value:.2g} or beyond; look whether the rows are in order, and what was recorded"
    )


def _heights(laws: Averaged, roles: Roles) -> list[str]:
    """Drop heights that a scenario cannot have: times in another unit are the usual reason."""
    parameter = roles.file.parameters[roles.height]
    unit = units.unit_of(roles.height)
    best, found = laws.shares[0].fit, []
    for drop, impacts in enumerate(best.problem.drops):
        height = float(best.problem.values(best.x, drop)["drop_height_m"])
        for name in best.names:
            if base(name) == "drop_height_m" and own_drop(name) in (None, drop):
                height = laws.unknown(name).value
        if not parameter.min <= height <= parameter.max:
            found.append(
                f"{impacts.source or f'drop {drop + 1}'} would be a drop from {height:.3g} {unit};"
                f" {roles.file.name} takes {parameter.min:g} to {parameter.max:g} {unit}. Look"
                " whether the unit of the recording is the right one, such as ms for s"
            )
    return found
