"""Where dead reckoning ends: how far from the truth, and whether its uncertainty explains that."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from simcompare.reports.estimation import units_of
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.estimation import Estimation, SourceEstimate

#: an error of so many standard uncertainties is still explained by them (about 95 %)
_EXPLAINED = 2.0
#: what is told of an end, and its heading in the table
_COLUMNS = {"end_drift": "Off", "end_along": "Along", "end_across": "Across", "end_turn": "Turned"}


def known(result: Estimation) -> list[SourceEstimate]:
    """Sources of which the end was told."""
    return [one for one in result.done if {"end_drift", "path_length"} <= set(one.numbers)]


def sentences(result: Estimation) -> Iterator[str]:
    """How far, on how long a way, how sure, and whether that is as it must be."""
    rows = known(result)
    if not rows:
        return
    ends = [one.numbers["end_drift"] for one in rows]
    ways = [one.numbers["path_length"].value for one in rows]
    factor, unit = units_of.scale("drift_m", [end.value for end in ends])
    u = factor * max(end.u or 0.0 for end in ends)
    off = _to_place([factor * end.value for end in ends], u)
    drifts = [one.numbers["drift_per_metre"] for one in rows if "drift_per_metre" in one.numbers]
    each = _to_place(
        [1e3 * d.value for d in drifts], 1e3 * max((d.u or 0.0 for d in drifts), default=0)
    )
    yield (
        f"After {_span(ways, 3)} m odometry ends {off} {unit} from the robot"
        f" (u = {numbers.plain(u, 2)} {unit}), {each} mm on each metre."
    )
    shares = [end.value / end.u for end in ends if end.u]
    if len(shares) < len(ends):
        return
    explains = max(shares) <= _EXPLAINED
    yield (
        f"That is {_span(shares, 2)} standard uncertainties: what is not known of wheels, track,"
        f" start and counting {'explains' if explains else 'does not explain'} it."
    )


def table(result: Estimation) -> Table:
    """The end of each source: off by how much, along, across and turned, each with its u."""
    factor, unit = units_of.scale("drift_m", [o.numbers["end_drift"].value for o in known(result)])
    words = [Column("Recording" if result.recording else "Engine", text=True), Column("Way (m)")]
    told = [key for key in _COLUMNS if any(key in one.numbers for one in known(result))]
    columns = [Column(f"{_COLUMNS[key]} ± u ({_unit(key, unit)})") for key in told]
    rows = [
        (
            one.source,
            numbers.plain(one.numbers["path_length"].value, 4),
            *(_with_u(one, key, factor) for key in told),
        )
        for one in known(result)
    ]
    title = "Where odometry ends, less where the robot ends"
    return Table(title, (*words, *columns), (Group("", tuple(rows)),), engines=not result.recording)


def _unit(key: str, unit: str) -> str:
    return "mrad" if key == "end_turn" else unit


def _with_u(source: SourceEstimate, key: str, factor: float) -> str:
    found = source.numbers.get(key)
    if found is None:
        return "–"
    size = 1e3 if key == "end_turn" else factor
    if not found.u:
        return numbers.plain(size * found.value, 3)
    return numbers.with_u(size * found.value, size * found.u)


def _to_place(values: Sequence[float], u: float) -> str:
    """The least and the largest, to the place of the second digit of their uncertainty."""
    if not u > 0:
        return _span(values, 3)
    places = max(0, 1 - math.floor(math.log10(u)))
    low, high = (f"{one:.{places}f}" for one in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def _span(values: Sequence[float], digits: int) -> str:
    low, high = (numbers.plain(one, digits) for one in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"
