"""Drops of a ball from tables that number their bounces.

The numbers are believed: nothing is left out, and nothing gets another number. What a table does
not hold was not recorded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from simcompare import units
from simcompare.errors import InputError
from simcompare.fitting.bounces.impacts import CLOCKED, INTERVALS, MAX_COUNT, TABLE, Impacts
from simcompare.hardware.logs.text import cell as _cell
from simcompare.hardware.logs.text.cell import split
from simcompare.hardware.recordings import bounce_headings, bounce_table
from simcompare.hardware.recordings.bounce_headings import HEIGHT, INSTANT, INTERVAL
from simcompare.hardware.recordings.bounce_table import BounceTable, Quantity
from simcompare.model import user_file
from simcompare.model.trajectory import Array

#: quantities of a table, and their units
_KNOWN = {"restitution": "1", HEIGHT: "m", INSTANT: "s", INTERVAL: "s", "impact_speed": "m/s"}
#: what a fit is made from, the first that a table holds
USED = (INSTANT, INTERVAL, HEIGHT)
#: by how many u a number may be above what it cannot exceed
_FAR = 4.0
#: standard uncertainty of a drop height without a stated one [m]
_U_DROP_M = 5e-4


def is_table(path: Path) -> bool:
    """Whether a file is a table of bounces, by its headings."""
    lines = _lines(path)
    return bool(lines) and bounce_headings.is_table(
        split(lines[0], max(",;\t", key=lines[0].count))
    )


def check_headings(path: Path) -> None:
    """Raises ``InputError`` where a table begins with its first bounce, without headings."""
    lines = _lines(path)
    # where a semicolon separates, commas are decimal marks
    separator = next((mark for mark in "\t;" if mark in "".join(lines[:1])), ",")
    cells = [split(line, separator) for line in lines]
    numbers = [[_cell.number(cell.replace(",", ".")) for cell in row] for row in cells]
    counted = [row[0] for row in numbers if len(row) > 1 and None not in row]
    if not lines or len(counted) < len(lines) or counted[0] not in (0, 1):
        return
    if len(counted) <= MAX_COUNT and np.all(np.diff(np.array(counted)) == 1):
        known = ", ".join(f"{name}{units.suffix_for(_KNOWN[name])}" for name in USED)
        raise InputError(path.name, [
            "has no headings. If each row is a bounce, write what the columns hold above them,"
            f" such as 'bounce{separator}interval_s'; known are bounce, {known}"
        ])  # fmt: skip


def _lines(path: Path) -> list[str]:
    """The first lines of a file, remarks left out."""
    user_file.check_is_stored(path)
    try:
        with path.open("rb") as file:
            text = bounce_table.decoded(file.read(4096), errors="replace")
    except OSError:
        return []
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


def read(path: Path, u_s: float | None = None) -> Impacts:
    """One drop from a table: impact times where it has them, else intervals or rebound heights.

    Args:
        path: the table.
        u_s: standard uncertainty of the times or intervals, in place of the table's own [s].

    Raises:
        InputError: every fault of the table, or there is nothing in it that a fit can use.
    """
    table = bounce_table.read(path, _KNOWN)
    _check_numbers(table)
    held = {quantity.name for quantity in table.quantities}
    used = next((name for name in USED if name in held), None)
    if used is None:
        raise InputError(path.name, [f"holds {', '.join(sorted(held))}, but none of"
                                     f" {', '.join(USED)}; a fit needs one of these"])  # fmt: skip
    if used == HEIGHT:
        if u_s is not None:
            text = "is of times, but the table holds heights; state theirs in u_rebound_height"
            raise InputError(f"--u-time, {path.name}", [text])
        return from_table(table)
    rows = [q for q in table.quantities if q.name == used]
    u = [float("nan") if q.u is None else q.u for q in rows] if u_s is None else u_s
    read_as = _from_instants if used == INSTANT else from_intervals
    found = read_as([q.value for q in rows], u, numbers=_numbers(rows), source=path.name)
    return replace(found, notes=(*found.notes, *_unused(table, used)))


def _check_numbers(table: BounceTable) -> None:
    last = max((quantity.bounce for quantity in table.quantities), default=0)
    if last > MAX_COUNT:
        raise InputError(table.path.name, [
            f"a row is numbered {last}; a fit takes {MAX_COUNT} bounces of one drop at most:"
            " correct the number, or leave out the late bounces"
        ])  # fmt: skip


def _numbers(rows: Sequence[Quantity]) -> list[int]:
    return [row.bounce for row in rows]


def _unused(table: BounceTable, used: str) -> list[str]:
    """What a table holds besides, and why it was not used."""
    words = []
    if any(q.name == HEIGHT for q in table.quantities):
        words.append("the rebound heights of the table were not used: telephones work them out from"
                     " the times")  # fmt: skip
    if "drop_height" in table.parameters:
        what = "impact times" if used == INSTANT else "intervals"
        height = table.parameters["drop_height"].replace(" ", "")
        words.append(
            f"the drop height was found from the {what}; if the stated one is to count, give it"
            f" with its uncertainty: --prior drop_height={height}:1mm"
        )
    return words


def _from_instants(
    times_s: ArrayLike, u_s: ArrayLike, *, numbers: Sequence[int], source: str = ""
) -> Impacts:
    """One drop from impact times whose numbers are known."""
    times, u = _both(times_s, u_s)
    faults = [
        f"impact {numbers[k + 1]} at {times[k + 1]:g} s is not after impact {numbers[k]} at"
        f" {times[k]:g} s; call a column of times between impacts interval [s]"
        for k in np.flatnonzero(np.diff(times) <= 0).tolist()
    ]
    if len(times) < 2:
        faults.append(f"{len(times)} impact time; two at least are needed with a known drop height,"
                      " three without")  # fmt: skip
    if faults:
        raise InputError(source or "impact times", faults)
    return Impacts(times, u, tuple(numbers), CLOCKED, source, missed=_missed(numbers))


def from_intervals(
    intervals_s: ArrayLike,
    u_s: ArrayLike = np.nan,
    *,
    numbers: Sequence[int] | None = None,
    source: str = "",
) -> Impacts:
    """One drop from times between neighbouring impacts.

    Each interval counts as one measurement with an error of its own. Intervals that a device has
    worked out from instants share errors, so that theirs cancel in sums; this makes the stated
    uncertainty too large by up to a factor of two, never too small.

    Args:
        intervals_s: from impact n to impact n + 1 (k,) [s].
        u_s: standard uncertainty, one or one each; NaN where unknown [s].
        numbers: n of each; 1, 2, 3, … where not given.
        source: name of the file.

    Raises:
        InputError: an interval is not positive, or longer than what came before.
    """
    intervals, u = _both(intervals_s, u_s)
    which = list(range(1, len(intervals) + 1)) if numbers is None else list(numbers)
    faults = [f"interval {n}: {one:g} s is no time between two impacts; it must exceed 0"
              for n, one in zip(which, intervals, strict=True) if not one > 0]  # fmt: skip
    longer, notes = _rising(which, intervals, u, "interval", "s", "is longer than")
    if not len(intervals):
        faults.append("no interval; a fit needs two at least, or one and a known drop height")
    if faults or longer:
        raise InputError(source or "intervals", [*faults, *longer])
    missed = sorted(set(range(which[0], which[-1])) - set(which))
    if missed:
        notes.append(f"the table has no interval {', '.join(map(str, missed))}")
    return Impacts(kind=INTERVALS, source=source, intervals_s=intervals, u_intervals_s=u,
                   interval_numbers=tuple(which), notes=tuple(notes))  # fmt: skip


def from_rebounds(
    heights_m: ArrayLike,
    u_m: ArrayLike = np.nan,
    *,
    numbers: Sequence[int] | None = None,
    drop_height: tuple[float, float] | None = None,
    source: str = "",
) -> Impacts:
    """One drop from rebound heights.

    Args:
        heights_m: of the apexes above the floor (n,) [m].
        u_m: standard uncertainty, one or one each; NaN where unknown [m].
        numbers: after which impact each comes, 0 is the drop; 1, 2, 3, … where not given.
        drop_height: the drop's own height and its standard uncertainty, where it was measured [m].
        source: name of the file.

    Raises:
        InputError: a height is not positive, or a rebound is higher than what came before.
    """
    heights, u = _both(heights_m, u_m)
    which = list(range(1, len(heights) + 1)) if numbers is None else [int(n) for n in numbers]
    faults = []
    if drop_height is not None and 0 in which:
        faults.append("the drop height stands twice: in the head, and as the height of bounce 0;"
                      " give it once")  # fmt: skip
    if drop_height is not None:
        heights = np.concatenate(([drop_height[0]], heights))
        u, which = np.concatenate(([drop_height[1]], u)), [0, *which]
    faults += [f"rebound {n}: {h:g} m is not a height above the floor"
               for n, h in zip(which, heights, strict=True) if not h > 0]  # fmt: skip
    higher, notes = _rising(which, heights, u, "rebound", "m", "is higher than")
    if len(heights) < 2:
        faults.append(f"{len(heights)} height; two at least tell a restitution: add the drop height"
                      " as a row of number 0, or as a line such as # drop_height: 0.8 m above the"
                      " headings")  # fmt: skip
    if faults or higher:
        raise InputError(source or "rebound heights", [*faults, *higher])
    return Impacts(kind=TABLE, source=source, heights_m=heights, u_heights_m=u, notes=tuple(notes),
                   height_numbers=tuple(which), missed=_missed(which))  # fmt: skip


def from_table(table: BounceTable) -> Impacts:
    """One drop from a table of rebound heights.

    Raises:
        InputError: the heights contradict each other.
    """
    rows = [q for q in table.quantities if q.name == HEIGHT]
    name, drop = table.path.name, None
    if "drop_height" in table.parameters:
        height_m = units.to_si(table.parameters["drop_height"], "m", f"{name}, drop_height")
        drop = height_m, _U_DROP_M
    u = [np.nan if q.u is None else q.u for q in rows]
    found = from_rebounds(
        [q.value for q in rows], u, numbers=_numbers(rows), drop_height=drop, source=name
    )
    if drop is not None:
        note = "the drop height has no stated uncertainty; half a millimetre was taken"
        found = replace(found, notes=(*found.notes, note))
    return found


def _both(values: ArrayLike, u: ArrayLike) -> tuple[Array, Array]:
    """Values and an uncertainty for each."""
    found = np.asarray(values, dtype=float)
    return found, np.array(np.broadcast_to(np.asarray(u, dtype=float), found.shape))


def _rising(
    numbers: Sequence[int], values: Array, u: Array, what: str, unit: str, verb: str
) -> tuple[list[str], list[str]]:
    """What is larger than the number before it: faults beyond its uncertainty, else notes."""
    faults, notes = [], []
    steps, spread = np.diff(values), _FAR * np.hypot(u[1:], u[:-1])
    for k in np.flatnonzero(steps > 0).tolist():
        told = (
            f"{what} {numbers[k + 1]}: {values[k + 1]:g} {unit} {verb} the"
            f" {values[k]:g} {unit} before it; a ball that is not struck cannot rise so high"
        )
        if steps[k] > spread[k]:
            faults.append(f"{told}. If a bounce in between was not recorded, leave out its number")
        elif np.isnan(spread[k]):
            notes.append(told)
    return faults, notes


def _missed(numbers: Sequence[int]) -> tuple[int, ...]:
    return tuple(sorted(set(range(numbers[0], numbers[-1])) - set(numbers)))
