"""What the columns of a stream claim to be, in SI, before anything is converted."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simcompare import units
from simcompare.errors import InputError
from simcompare.hardware.conditioning.units import naming, quantity
from simcompare.hardware.conditioning.work import Work
from simcompare.hardware.mapping import ChannelMap
from simcompare.hardware.mapping_lines import quoted, unit_text
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
    unit = quantity.meant(f"{column.name} {name}", wish.unit if wish else column.unit)
    scale = wish.sign * wish.scale if wish else 1.0
    added = wish.offset if wish else 0.0
    try:
        factor, offset, si = quantity.to_si(column.name, unit) if unit else (1.0, 0.0, "")
    except InputError:
        factor, offset, si = 1.0, 0.0, ""
    return Claim(
        column, wish, name, unit, si, factor, scale * factor, added * factor + offset
    )  # fmt: skip


def near(value: float, expected: float, factor: float) -> bool:
    """Whether a value is what is expected but for a factor."""
    return 1 / factor <= value / expected <= factor


def take(
    work: Work, claim: Claim, unit: str, text: str, before: dict[str, float],
    after: dict[str, float], divisor: float = 1.0,
) -> None:  # fmt: skip
    """Takes the numbers of a column as ``unit`` after division, and records it.

    Args:
        work: the stream.
        claim: the column; the unit that it claims is wrong.
        unit: the one that fits.
        text: why.
        before: numbers that contradict physics.
        after: what they become.
        divisor: of the raw numbers.
    """
    work.repair("unit_mistake", text, channel=claim.column.name, before=before, after=after)
    reread(work, claim, unit, divisor)


def reread(work: Work, claim: Claim, unit: str, divisor: float) -> None:
    """The same without a record of a mistake."""
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
    """What ``channels:`` of a mapping file says then."""
    wish = claim.wish
    scale = (wish.scale if wish else 1.0) / divisor
    turned = (wish.sign if wish else 1) * sign
    more = f", scale: {scale:.6g}" if scale != 1.0 else ""
    more += f", sign: {turned}" if turned != 1 else ""
    name = claim.name.removesuffix(units.suffix_of(claim.name))
    return f"{name}: {{column: {quoted(claim.column.name)}, unit: {unit_text(unit)}{more}}}"


#: words for the rate along an axis that name the axis
_AXIS_RATE = {"vx": "x", "vy": "y", "vz": "z"}


def of_one_thing(
    claims: Sequence[Claim], partner: Mapping[str, str], skip: Collection[str]
) -> list[tuple[Claim, Claim]]:
    """Two quantities of one thing, such as a position and its rate.

    Args:
        claims: all columns.
        partner: SI unit of the one quantity -> that of the other.
        skip: words of a name that say which quantity it is, and nothing of whose.
    """
    things: dict[tuple[str, ...], tuple[list[Claim], list[Claim]]] = {}
    for claim in claims:
        for units_of_both in partner.items():
            if claim.si in units_of_both:
                thing = things.setdefault((*units_of_both, *_thing(claim, skip)), ([], []))
                thing[units_of_both.index(claim.si)].append(claim)
    # two positions of the same name and thing: nobody can tell which one the rate belongs to
    return [(one[0], other[0]) for one, other in things.values() if len(one) == len(other) == 1]


def _thing(claim: Claim, skip: Collection[str]) -> Iterator[str]:
    """Words of a name that say what it belongs to."""
    name = claim.name if claim.wish else claim.column.name
    split = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Za-z])(?=\d)", " ", name)
    for word in re.findall(r"[a-z0-9]+", split.lower()):
        word = _AXIS_RATE.get(word, word)
        if word not in skip:
            yield word


#: how the three components of a vector are told apart, in names that are otherwise the same
_AXES = (("x", "y", "z"), ("X", "Y", "Z"), ("0", "1", "2"), ("1", "2", "3"))


def triads(every_claim: Sequence[Claim]) -> list[tuple[Claim, Claim, Claim]]:
    """Vectors: three columns whose names differ in one letter, x, y, z (or 0, 1, 2)."""
    by_name: dict[str, Claim] = {}
    for claim in every_claim:
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
