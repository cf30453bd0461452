"""Whether what was found can be the motion of a bouncing ball at all; nonsense has no numbers."""

from __future__ import annotations

from simcompare import units
from simcompare.errors import InputError
from simcompare.fitting.bounces.averaging import Averaged
from simcompare.fitting.bounces.roles import Roles
from simcompare.fitting.bounces.unknowns import BOUNDS, base, own_drop


def check(laws: Averaged, roles: Roles) -> None:
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
