"""Four columns without a unit that are a unit quaternion in every row: plain numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from simcompare.hardware.conditioning.units.meaning import Claim, claims, reread, title
from simcompare.hardware.conditioning.work import Work

#: how far from 1 the length may be, as numbers are written with four digits or more
_ROUNDED = 2e-3
_PART = re.compile(r"(?P<of>.*?)[_. \[]*(?P<part>[wxyzWXYZ]|(?<=[qQ])[0-3]|(?<=[qQ]_)[0-3])\]?")
_PARTS = ({*"wxyz"}, {*"0123"})


def check(work: Work) -> None:
    """Gives them the unit 1, with a note."""
    for group in _fours([claim for claim in claims(work) if not claim.unit]):
        values = np.stack([claim.values(slice(None)) for claim in group])
        length = np.linalg.norm(values, axis=0)
        known = length[np.isfinite(length)]
        if not len(known) or np.abs(known - 1).max() > _ROUNDED:
            continue
        for claim in group:
            reread(work, claim, "1", 1.0)
        work.info(
            "quaternion", f"{title(group)}: together they are 1 long in every row, as quaternions"
            " are; taken as plain numbers", channel=group[0].column.name,
        )  # fmt: skip


def _fours(undecided: Sequence[Claim]) -> Iterator[list[Claim]]:
    """Columns whose names differ in w, x, y, z or in q0, q1, q2, q3 alone."""
    things: dict[str, dict[str, Claim]] = {}
    for claim in undecided:
        match = _PART.fullmatch(claim.column.name)
        if match:
            things.setdefault(match["of"], {}).setdefault(match["part"].lower(), claim)
    return (list(parts.values()) for parts in things.values() if {*parts} in _PARTS)
