"""Columns without a unit that are a quaternion, or angles of an attitude, by their numbers."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from simcompare.hardware.conditioning.clock.intervals import extent
from simcompare.hardware.conditioning.units import quantity
from simcompare.hardware.conditioning.units.meaning import Claim, claims, reread, title
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.raw import blocks

#: how far from 1 the length may be, as numbers are written with four digits or more
_ROUNDED = 2e-3
_PART = re.compile(r"(?P<of>.*?)[_. \[]*(?P<part>[wxyzWXYZ]|(?<=[qQ])[0-3]|(?<=[qQ]_)[0-3])\]?")
#: beyond so much [rad] a pitch is none, and a roll has gone round; the ends of what degrees can be
_PITCH, _ROLL, _DEGREES = 1.65, 6.4, {"pitch": 91.0, "roll": 181.0, "yaw": 361.0}
#: words beside them that leave an angle an angle; what stands beside the sticks of a remote control
_OF_ANGLES = frozenset(("angle", "euler", "attitude", "imu", "est", "filtered", "kalman"))
_STICKS = frozenset(("throttle", "thrust", "rc", "stick"))
_PARTS = ({*"wxyz"}, {*"0123"})


def check(work: Work) -> None:
    """Gives them their unit, with a note."""
    undecided = [claim for claim in claims(work) if not claim.unit]
    _quaternions(work, undecided)
    _angles(work, undecided)


def _quaternions(work: Work, undecided: Sequence[Claim]) -> None:
    for group in _fours(undecided):
        off = [_off(group, part) for part in blocks(len(work.stream))]
        if not np.any(np.isfinite(off)) or np.nanmax(off) > _ROUNDED:
            continue
        for claim in group:
            reread(work, claim, "1", 1.0)
        work.info(
            "quaternion", f"{title(group)}: together they are 1 long in every row, as quaternions"
            " are; taken as plain numbers", channel=group[0].column.name,
        )  # fmt: skip


def _angles(work: Work, undecided: Sequence[Claim]) -> None:
    """Roll, pitch and yaw of one thing that radians cannot be and degrees can."""
    if any(_STICKS & {*quantity.words(column.name)} for column in work.data):
        return
    things: dict[str, dict[str, Claim]] = {}
    for claim in undecided:
        name = claim.column.name.lower()
        word = next((word for word in _DEGREES if word in quantity.words(name)), "")
        if not {*quantity.words(name)} <= {word, *_OF_ANGLES}:
            continue
        things.setdefault(name.replace(word, ""), {}).setdefault(word, claim)
    for angles in things.values():
        if not {"roll", "pitch"} <= {*angles} <= {*_DEGREES}:
            continue
        largest = {word: _extent(claim) for word, claim in angles.items()}
        fits = all(value <= _DEGREES[word] for word, value in largest.items())
        if fits and (largest["pitch"] > _PITCH or largest["roll"] > _ROLL):
            for claim in angles.values():
                reread(work, claim, "deg", 1.0)
            work.info(
                "attitude", f"{title([*angles.values()])} reach {largest['pitch']:.4g} in pitch and"
                f" {largest['roll']:.4g} in roll, more than radians do; taken as degrees",
                channel=angles["pitch"].column.name,
            )  # fmt: skip


def _off(group: Sequence[Claim], part: slice) -> float:
    """How far the length of four columns is from 1 at most, NaN where nothing is known."""
    length = np.linalg.norm([claim.values(part) for claim in group], axis=0)
    return float(np.nanmax(np.abs(length - 1))) if np.isfinite(length).any() else np.nan


def _extent(claim: Claim) -> float:
    """The largest value without its sign."""
    low, high = extent(claim.column.values)
    return max(-low, high) * abs(claim.factor)


def _fours(undecided: Sequence[Claim]) -> Iterator[list[Claim]]:
    """Columns whose names differ in w, x, y, z or in q0, q1, q2, q3 alone."""
    things: dict[str, dict[str, Claim]] = {}
    for claim in undecided:
        match = _PART.fullmatch(claim.column.name)
        if match:
            things.setdefault(match["of"], {}).setdefault(match["part"].lower(), claim)
    return (list(parts.values()) for parts in things.values() if {*parts} in _PARTS)
