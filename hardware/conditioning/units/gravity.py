"""Columns in g whose length is 1 at rest: gravity, and no gram."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from simcompare import units
from simcompare.hardware.conditioning.units import quantity
from simcompare.hardware.conditioning.units.meaning import Claim, claims, reread, title, triads
from simcompare.hardware.conditioning.units.rest import excerpts, rest
from simcompare.hardware.conditioning.work import Work

#: how far it may be from 1; sheets of cheap sensors allow 0.17 g of offset and scale together
_TOLERANCE = 0.15
#: the same where a name says that it is an acceleration: the next unit is ten times larger
_NAMED_TOLERANCE = 0.2
#: as many of each unit are one g
_IN = {"g_0": 1.0, "mg_0": 1e3, "ug_0": 1e6, "m/s^2": 9.80665}
#: units that an acceleration without any may have; near 1000 and 8000 it may be counts of a chip
_USUAL = ("m/s^2", "g_0")
_AXIS = re.compile(r"(?:^|[^a-z])[xyz](?:$|[^a-z])")


def check(work: Work) -> None:
    """Takes g, mg and their like as gravity where the values say so, with a note."""
    if len(work.time_s) < 2:
        return
    for group in _groups([claim for claim in claims(work) if not claim.si and _ways(claim)]):
        said = bool(group[0].unit)
        size = _size_at_rest(work, group) or (0.0 if said else _mean_size(group))
        near = _TOLERANCE if said else _NAMED_TOLERANCE
        unit = next((w for w in _ways(group[0]) if abs(size / _IN[w] - 1) < near), "")
        if not unit:
            continue
        was = f"in {group[0].unit}" if group[0].unit else "without a unit"
        for claim in group:
            reread(work, claim, unit, 1.0)
        work.info(
            "gravity_unit",
            f"{title(group)} {was}: at rest, or on average, they are {size:.4g} long, as gravity is"
            f" in {unit}; taken so",
            channel=group[0].column.name, after={"rest": size},
        )  # fmt: skip


def _ways(claim: Claim) -> tuple[str, ...]:
    """Units of acceleration that a column may have, none where its unit is of another kind."""
    if not claim.unit:
        named = quantity.measures_acceleration(claim.column.name) or claim.kind == "specific_force"
        return _USUAL if named and claim.wish is None else ()
    return tuple(way for way in units.ways(claim.unit) if way in _IN)


def _groups(undecided: Sequence[Claim]) -> list[Sequence[Claim]]:
    """Vectors; or else all columns together, or one that is called an axis."""
    found: list[Sequence[Claim]] = [*triads(undecided)]
    used = {id(claim) for group in found for claim in group}
    others = [
        c for c in undecided
        if id(c) not in used and c.unit and not quantity.measured(c.column.name)
    ]  # fmt: skip
    alike = [c for c in others if c.unit == others[0].unit]
    if len(alike) > 1 or (alike and _AXIS.search(alike[0].column.name.lower())):
        found.append(alike)
    return found


def _size_at_rest(work: Work, group: Sequence[Claim]) -> float:
    """Length at rest in the unit of the columns, 0 where it is not steady."""
    at_rest = rest(work, group)
    if at_rest is not None:
        return at_rest.size if at_rest.steady else 0.0
    lengths = np.linalg.norm([claim.values(slice(None)) for claim in group], axis=0)
    low, middle, high = np.nanquantile(lengths, (0.1, 0.5, 0.9))
    return float(middle) if high - low < 0.1 * middle else 0.0


def _mean_size(group: Sequence[Claim]) -> float:
    """Length of the mean of three axes that never rest, 0 where most samples are not so long.

    What accelerates a body averages out, gravity does not.
    """
    if len(group) != 3:
        return 0.0
    parts = excerpts(len(group[0].column.values))
    axes = np.concatenate([[claim.values(part) for claim in group] for part in parts], axis=1)
    axes = axes[:, np.isfinite(axes).all(axis=0)]
    mean = float(np.linalg.norm(axes.mean(axis=1))) if axes.size else 0.0
    usual = float(np.median(np.linalg.norm(axes, axis=0))) if axes.size else 0.0
    return mean if mean > 0 and abs(usual / mean - 1) < _NAMED_TOLERANCE else 0.0
