"""What the columns of a stream claim to be, in SI, before anything is converted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning.units import naming
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping import ChannelMap
from simcompare.hardware.raw import RawColumn
from simcompare.model.trajectory import Array


@dataclass(frozen=True)
class Claim:
    """One column as it will become a channel: value in SI = factor·raw + offset.

    Attributes:
        column: the raw column.
        wish: what the mapping says of it.
        name: name of the channel, without unit.
        unit: declared unit, empty where there is none.
        si: its SI unit, empty where the declared unit is none or unknown.
        unit_si: one declared unit in SI.
        factor: from raw to SI, with scale and sign.
        offset: added afterwards.
    """

    column: RawColumn
    wish: ChannelMap | None
    name: str
    unit: str
    si: str
    unit_si: float
    factor: float
    offset: float

    def values(self, part: slice | NDArray[np.int64]) -> Array:
        """Some values in SI (in the raw unit where that is unknown)."""
        return np.asarray(self.column.values[part] * self.factor + self.offset)

    @property
    def kind(self) -> str:
        """Kind that the mapping, else the log, gives it."""
        return (self.wish.kind if self.wish else "") or self.column.kind


def claims(work: Work) -> list[Claim]:
    """Every channel that the stream will have, those without a known unit included."""
    return [
        _claim(column, wish, name)
        for column in work.data
        for wish, name in naming.channels_of(work, column)
    ]


def _claim(column: RawColumn, wish: ChannelMap | None, name: str) -> Claim:
    unit = naming.unit_text(f"{column.name} {name}", wish.unit if wish else column.unit)
    scale = wish.sign * wish.scale if wish else 1.0
    added = wish.offset if wish else 0.0
    try:
        factor, offset, si = units.si_of(unit, "") if unit not in ("", "g") else (1.0, 0.0, "")
    except InputError:
        factor, offset, si = 1.0, 0.0, ""
    return Claim(
        column, wish, name, unit, si, factor, scale * factor, added * factor + offset
    )  # fmt: skip


def reread(work: Work, claim: Claim, unit: str, divisor: float = 1.0) -> None:
    """Takes the numbers of a column as ``unit`` after division; the unit that it claimed was wrong.

    The caller records it.
    """
    column = claim.column
    if claim.wish is None:
        column.unit = unit
        if divisor != 1.0:
            _divide(column, divisor)
        return
    if claim.wish.scale == 1.0 and divisor == 1.0:
        column.unit = unit
    channels = {
        name: wish.model_copy(update={"unit": unit, "scale": wish.scale / divisor})
        if wish is claim.wish
        else wish
        for name, wish in work.mapping.channels.items()
    }
    work.mapping = work.mapping.model_copy(update={"channels": channels})


def _divide(column: RawColumn, divisor: float) -> None:
    column.values /= divisor
    if column.limits is not None:
        column.limits = (column.limits[0] / divisor, column.limits[1] / divisor)
    if column.u is not None:
        column.u = column.u / divisor


def mapping_line(claim: Claim, unit: str, divisor: float = 1.0, sign: int = 1) -> str:
    """The line of a mapping file that says so."""
    wish = claim.wish
    scale = (wish.scale if wish else 1.0) / divisor
    turned = (wish.sign if wish else 1) * sign
    more = f", scale: {scale:.6g}" if scale != 1.0 else ""
    more += f", sign: {turned}" if turned != 1 else ""
    name = claim.name.removesuffix(units.suffix_of(claim.name))
    return f"{name}: {{column: {claim.column.name!r}, unit: {unit}{more}}}"


#: how the three components of a vector are told apart, in names that are otherwise the same
_AXES = (("x", "y", "z"), ("X", "Y", "Z"), ("0", "1", "2"), ("1", "2", "3"))


def triads(found: Sequence[Claim]) -> list[tuple[Claim, Claim, Claim]]:
    """Vectors: three columns whose names differ in one letter, x, y, z (or 0, 1, 2)."""
    by_name: dict[str, Claim] = {}
    for claim in found:
        by_name.setdefault(claim.name, claim)
        by_name.setdefault(claim.column.name, claim)
    made: list[tuple[Claim, Claim, Claim]] = []
    used: set[int] = set()
    for name, first in by_name.items():
        for x, y, z in _AXES:
            for at in [i for i, letter in enumerate(name) if letter == x][::-1]:
                others = [by_name.get(name[:at] + letter + name[at + 1 :]) for letter in (y, z)]
                second, third = others
                if second is None or third is None or id(first) in used:
                    continue
                if first.si == second.si == third.si and _one_sensor(first, second, third):
                    made.append((first, second, third))
                    used |= {id(first), id(second), id(third)}
    return made


def _one_sensor(*three: Claim) -> bool:
    return len({(c.column.sensor, c.wish.sensor if c.wish else "") for c in three}) == 1


def title(triad: Sequence[Claim]) -> str:
    """The three columns in words."""
    return ", ".join(repr(claim.column.name) for claim in triad)
