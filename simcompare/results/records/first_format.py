"""Records of the first format, which version 0.1 stored, under the names of today."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping
from typing import Any

from simcompare.model.settings import OLD_LEVELS

FIRST_FORMAT = 1

Row = dict[str, Any]


def of_today(data: Mapping[str, Any], today: int) -> Row:
    """A record of the first format as one of the format of today; damage stays in it."""
    kind = next((name for name in ("fit", "validation") if data.get(name)), "run")
    found = {**data, "format": today, "kind": kind}
    _rows(found, "sources", _level)
    _rows(found, "scores", _SCORES[kind])
    if isinstance(data.get("against"), Mapping):
        found["against"] = dict(data["against"])
        _rows(found["against"], "matches", _match)
    if isinstance(data.get("fit"), Mapping):  # a fit of bounces did not say what it is
        found["fit"] = {"by": "bounces", **data["fit"]}
    return found


def _rows(of: Row, key: str, renamed: Callable[[Row], Row]) -> None:
    """Renames every row of a list; what is none is left to the check of types."""
    if isinstance(of.get(key), list | tuple):
        of[key] = [renamed(row) if isinstance(row, dict) else row for row in of[key]]


def _level(row: Row) -> Row:
    name = row.get("contact")
    return {**row, "contact": OLD_LEVELS.get(name, name)} if isinstance(name, str) else row


def _match(row: Row) -> Row:
    """What was called u is the scatter of single repeats."""
    return {"scatter": row.get("u"), **_level(row)}


def _score(row: Row) -> Row:
    return {"scatter": None, **_level(row)}


def _measured_score(row: Row) -> Row:
    """What was called truth was measured."""
    return {**_score(row), "truth": None, "measured": row.get("truth")}


def _run_score(row: Row) -> Row:
    """What was called u is the scatter of single repeats; that of their mean follows from it."""
    scatter, repeats = row.get("u"), row.get("repeats")
    u = scatter
    with contextlib.suppress(OverflowError):  # a number too large for one is left to the types
        if isinstance(scatter, float | int) and isinstance(repeats, int):
            u = scatter / math.sqrt(max(repeats, 1))
    return {**_level(row), "scatter": scatter, "u": u}


_SCORES = {"run": _run_score, "fit": _score, "validation": _measured_score}
