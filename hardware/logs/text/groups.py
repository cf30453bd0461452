"""Headers of several lines: groups (a marker, a sensor) over the axes of each.

Time;IMU Acceleration;;;IMU Gyroscope;;      ,,box:left,,,box:right,,
s;X;Y;Z;X;Y;Z                                Frame,Sub Frame,X,Y,Z,X,Y,Z

Frame#,Time,heel,,,toe,,
,,X1,Y1,Z1,X2,Y2,Z2
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from simcompare.hardware.logs.text import cell as _cell

#: lines above the names that may hold groups
_LINES = 6
_AXES = frozenset("xyzwXYZW") | {f"{letter}{axis}" for letter in "TRqQ" for axis in "XYZWxyzw"}
#: axes of the markers of a file, which are counted
_COUNTED = re.compile(r"[XYZ]\d+")
#: cells that say what their line holds
_WHAT = ("Type", "Name", "Parent")


def of_markers(cells: Sequence[str], width: int) -> list[str]:
    """Three names for each marker of ``MARKER_NAMES a b``; else the cells as they are."""
    markers = [cell.strip() for cell in cells[1:]]
    if cells[:1] != ["MARKER_NAMES"] or 3 * len(markers) != width:
        return [*cells]
    return [f"{marker} {axis}" for marker in markers for axis in "XYZ"]


def named(
    cells: Sequence[str], units_below: Sequence[str], above: Sequence[Sequence[str]]
) -> tuple[list[str], list[str]]:
    """Names with their groups in front, and units.

    Args:
        cells: the line of names.
        units_below: the line of units, empty where there is none.
        above: cells of the lines above the names, the nearest first.
    """
    names = [cell.strip() for cell in cells]
    units = [*units_below] or [""] * len(names)
    found = False
    for line in above[:_LINES]:
        bare = [cell.strip() for cell in line]
        texts = ["" if cell in _WHAT else cell for cell in bare]
        if len(texts) != len(names) or not any(bare):
            break
        wanted = _to_be_told_apart(names) or (found and "Name" in bare)
        if wanted and any(texts) and not any(map(_is_id, bare)):
            _put_before(_filled(texts), texts, names, units)
            found = True
    return names, units


def _to_be_told_apart(names: Sequence[str]) -> bool:
    full = [name for name in names if name]
    axes = sum(name in _AXES or bool(_COUNTED.fullmatch(name)) for name in full)
    return len({*full}) < len(full) or axes >= min(2, len(full))


def _is_id(text: str) -> bool:
    """Whether a cell numbers something, in decimal or hexadecimal digits, or names a setting."""
    bare = text.strip('" ')
    try:
        int(bare, 16)
    except ValueError:
        is_number = bare and _cell.number(bare) is not None
        return bool(is_number) or bare == "ID" or bare.endswith("=")
    return any(digit.isdigit() for digit in bare)


def _filled(texts: Sequence[str]) -> list[str]:
    """The group of each column: an empty cell belongs to the group on its left."""
    groups, last = [], ""
    for text in texts:
        last = text or last
        groups.append(last)
    return groups


def _put_before(
    groups: Sequence[str], texts: Sequence[str], names: list[str], units: list[str]
) -> None:
    alone = [k for k in range(len(texts)) if texts[k] and (k + 1 == len(texts) or texts[k + 1])]
    for k, group in enumerate(groups):
        if k in alone and groups.count(group) == 1 and _cell.is_unit(names[k]):
            names[k], units[k] = group, units[k] or names[k]  # "Time" over "s"
        elif group and names[k]:
            names[k] = f"{group} {names[k]}"
        else:
            names[k] = group or names[k]
