"""What commas and points in numbers stand for: decimals or thousands."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from simcompare.errors import InputError

_GROUPS = re.compile(r"\d{1,3}(?:,\d{3})+")


def marks(
    label: str,
    body: Sequence[tuple[int, Sequence[str]]],
    kinds: Sequence[str],
    names: Sequence[tuple[str, str]],
) -> tuple[str, str, bool]:
    """Decimal mark, mark of thousands, and whether one was seen.

    Raises:
        InputError: a comma may be either.
    """
    unsure: list[str] = []
    counts: Counter[str] = Counter()
    for line, row in body:
        for k, cell in enumerate(row[: len(kinds)]):
            verdict = mark_of(cell) if kinds[k] == "number" else ""
            counts[verdict] += 1
            if verdict == "?" and len(unsure) < 3:
                unsure.append(doubt(line, names[k][0], cell))
    both = [v for v in (".,", ",.") if counts[v]]  # decimal mark first, then that of thousands
    if len(both) > 1 or (both == [".,"] and counts[","]):
        raise InputError(
            label, ["commas stand for decimals in some numbers and for thousands in others;"
                    " write the log with decimal points and without marks of thousands"],
        )  # fmt: skip
    if both:
        return both[0][0], both[0][1], True
    if counts[","]:
        return ",", "", True
    if counts["?"]:
        raise InputError(label, unsure)
    return ".", "", bool(counts["."])


def without_commas(body: Sequence[tuple[int, Sequence[str]]], kinds: Sequence[str]) -> list[str]:
    """The kinds of a table that commas separate: beside decimal points, "20,04" is a text."""
    by_column: list[set[str]] = [
        {mark_of(row[k]) for _, row in body} if kind == "number" else set()
        for k, kind in enumerate(kinds)
    ]
    if not any("." in found for found in by_column):
        return [*kinds]
    return [
        "text" if {"?", ","} & found and "." not in found and ".," not in found else kind
        for kind, found in zip(kinds, by_column, strict=True)
    ]


def doubt(line: int, name: str, cell: str) -> str:
    """What to say of a number that may be two."""
    plain = cell.strip().replace(",", "")
    return (
        f"line {line}, column {name!r}: {cell.strip()!r} may be {plain} or"
        f" {cell.strip().replace(',', '.')}; write the log with decimal points and without marks of"
        " thousands"
    )


def mark_of(cell: str) -> str:
    """What a number tells of the marks: "." or "," decimal, both with thousands, "?" or nothing."""
    text = cell.strip().lstrip("+-")
    points, commas = text.count("."), text.count(",")
    if not commas:
        return "." if points else ""
    if points:
        return ".," if text.rindex(".") > text.rindex(",") else ",."
    if commas > 1:
        return ".," if _GROUPS.fullmatch(text) else ""
    return "?" if re.fullmatch(r"[1-9]\d{0,2},\d{3}", text) else ","
