"""What a column of a table of results may hold."""

from __future__ import annotations

from dataclasses import dataclass

from simcompare.hardware.recordings.results_table import Heading
from simcompare.validation.tabled.vocabulary import Entry

PARAMETER, MEASURED, UNCERTAINTY, COUNT, LEFT_OUT = (
    "parameter", "measured", "uncertainty", "count", "left out",
)  # fmt: skip
#: words of a time that is that of many
TOTAL = frozenset(["time", "total", "t", "zeit", "gesamtzeit", "elapsed"])


@dataclass(frozen=True)
class Meaning:
    """What a column holds.

    Attributes:
        heading: of the column.
        role: parameter, measured, uncertainty, count or left out.
        entry: the parameter or result that it holds, or of which it holds the uncertainty.
        factor: to SI, for one of many that were timed together.
        count: how many were timed together.
        repeat: number among repeats of the same measurement.
        limits: whether an uncertainty is the half-width of a range.
        relative: whether an uncertainty is a part of the value.
        of_total: whether a column of counts says how many were timed together.
        note: why it is left out.
    """

    heading: Heading
    role: str
    entry: Entry | None = None
    factor: float = 1.0
    count: int = 1
    repeat: int | None = None
    limits: bool = False
    relative: bool = False
    of_total: bool = False
    note: str = ""


@dataclass(frozen=True)
class Guess:
    """A column before its neighbours are looked at."""

    meaning: Meaning
    numbers: tuple[int, ...] = ()
    is_counted: bool = False
    is_twice: bool = False
    #: words of an uncertainty that say of what it is
    rest: tuple[str, ...] = ()
