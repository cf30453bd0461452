"""The leading measure of a run: what each source has of it, and which sources agree."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from simcompare.compare import Score
from simcompare.reports import numbers, runs
from simcompare.results import Run

WITHIN, OUTSIDE, NOTHING, UNJUDGED = "within", "outside", "nothing", "unjudged"
#: a value below this part of the truth is none at all
_NONE = 0.01
#: values agree within this part where the scenario states no tolerance
_ALIKE = 0.01
#: so many more digits are tried to show that a value is outside
_MORE = 2
#: what rounding leaves of a part of a tolerance
_EQUAL = 1e-9


@dataclass(frozen=True)
class Lead:
    """The measure that a report leads with.

    Attributes:
        measure: its name.
        unit: its unit.
        truth: its true value, ``None`` where there is none.
        width: half-width of the band that is accepted, ``None`` where nothing is judged; the
            tightest, where sources are held to several.
        widths: every one of these, each once.
        answer: what the scenario says of it, ``None`` where it says nothing.
    """

    measure: str
    unit: str
    truth: float | None
    width: float | None
    widths: tuple[float, ...]
    answer: Mapping[str, Any] | None

    @property
    def words(self) -> str:
        """Its name as people say it."""
        return runs.measure_words(self.measure)

    @property
    def is_judged(self) -> bool:
        """Whether there is a truth and a tolerance about it."""
        return self.truth is not None and self.width is not None

    @property
    def accepted(self) -> str:
        """The tolerance, or the tolerances of several sources, as a number."""
        return " or ".join(dict.fromkeys(numbers.plain(width, 2) for width in self.widths))

    def off(self, value: float, width: float | None = None) -> float:
        """How far a value is from the truth, in tolerances."""
        accepted = width or self.width
        if self.truth is None or not accepted:
            return 0.0
        return (value - self.truth) / accepted

    def text(self, value: float | None, u: float | None = None, more: int = 0) -> str:
        """A value with its scatter and unit, to the digit that the tolerance leaves.

        Args:
            value: the value.
            u: its scatter, left out where it is no more than rounding.
            more: further digits.
        """
        if value is None:
            return "–"
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        places = self.places(value)
        if places is None:
            return numbers.with_u(value, u, self.unit, self.truth, 4)
        shown, scatter = (f"{v:.{places + more}f}" for v in (value, u or 0.0))
        shown = shown.lstrip("-") if float(shown) == 0 else shown.replace("-", "−")
        if float(scatter) == 0 or not math.isfinite(float(scatter)):
            return shown + unit
        both = f"{shown} ± {scatter}"
        return f"({both}){unit}" if unit else both

    def told(self, row: Row) -> str:
        """A value with as many digits as it takes to see that it is outside."""
        value = row.value
        for more in range(_MORE + 1):
            text = self.text(value, row.u, more)
            places = None if value is None else self.places(value)
            if row.kind != OUTSIDE or value is None or places is None:
                return text
            if abs(self.off(round(value, places + more), row.width)) > 1 + _EQUAL:
                return text
        return text

    def places(self, value: float) -> int | None:
        """Decimals that the tolerance leaves, ``None`` where a power of ten reads better."""
        if not self.width or numbers.plain(max(abs(value), self.width)).count("·"):
            return None
        return max(0, -math.floor(math.log10(self.width)))


@dataclass(frozen=True)
class Row:
    """What one source has of the leading measure at one level.

    Attributes:
        name: of the source.
        value: mean over the repeats; ``None`` where it could not be measured.
        u: their standard deviation, ``None`` for a single one.
        kind: within the tolerance, outside, nothing at all, or not judged.
        width: its own tolerance, ``None`` where it is not judged.
    """

    name: str
    value: float | None
    u: float | None
    kind: str
    width: float | None = None


class Group(NamedTuple):
    """Sources whose values agree.

    Attributes:
        rows: of these sources.
    """

    rows: tuple[Row, ...]

    @property
    def names(self) -> list[str]:
        """Of the sources."""
        return [row.name for row in self.rows]

    @property
    def row(self) -> Row:
        """One that stands for all: their mean, and the largest scatter."""
        known = [row.value for row in self.rows if row.value is not None]
        scatters = [row.u for row in self.rows if row.u is not None]
        mean = sum(known) / len(known) if known else None
        widths = [row.width for row in self.rows if row.width is not None]
        most = max(scatters, default=None)
        return Row("", mean, most, self.rows[0].kind, max(widths, default=None))


def lead_of(run: Run) -> Lead | None:
    """The measure that the scenario names, else the first that is judged or measured."""
    answer = run.record.get("answer")
    measures = [*runs.judged(run), *runs.measures(run)]
    if answer is not None and answer["measure"] in measures:
        return _lead(run, answer["measure"], answer)
    return _lead(run, measures[0], None) if measures else None


def lead_as(run: Run, measure: str) -> Lead:
    """The same of any measure of whole runs."""
    return _lead(run, measure, None)


def rows_of(run: Run, lead: Lead, mode: str) -> list[Row]:
    """What every source that ran at a level has of the leading measure."""
    found = []
    for name in runs.ran(run, mode):
        score = runs.score_of(run, name, mode, lead.measure)
        value, u = (None, None) if score is None else (score.value, score.u)
        if value is not None and not math.isfinite(value):
            value = None
        width = None if score is None else _width(run, score)
        found.append(Row(name, value, u, _kind(lead, value, width), width))
    return found


def groups_of(lead: Lead, rows: Sequence[Row]) -> list[Group]:
    """Sources that agree within the tolerance, the largest group first.

    One whose values scatter by more than the tolerance stands apart from those that do not.
    """
    known = [row for row in rows if row.value is not None]
    alike = lead.width or _ALIKE * max((abs(row.value or 0) for row in known), default=0.0)
    groups: list[list[Row]] = []
    for row in sorted(known, key=lambda r: ((r.u or 0.0) > alike, r.value)):
        last = groups[-1] if groups else None
        same = last is not None and ((last[0].u or 0.0) > alike) == ((row.u or 0.0) > alike)
        if last is not None and same and (row.value or 0.0) - (last[0].value or 0.0) <= alike:
            last.append(row)
        else:
            groups.append([row])
    order = {row.name: i for i, row in enumerate(rows)}
    found = [Group(tuple(sorted(group, key=lambda row: order[row.name]))) for group in groups]
    return sorted(found, key=lambda group: (-len(group.rows), abs(lead.off(group.row.value or 0))))


def _lead(run: Run, measure: str, answer: Mapping[str, Any] | None) -> Lead:
    scores = [s for s in run.scores if s.measure == measure and s.index is None]
    known = next((score for score in scores if score.truth is not None), scores[0])
    widths = sorted({w for score in scores if (w := _width(run, score)) is not None})
    return Lead(measure, known.unit, known.truth, min(widths, default=None), (*widths,), answer)


def _width(run: Run, score: Score) -> float | None:
    return None if score.truth is None else runs.width(run, score)


def _kind(lead: Lead, value: float | None, width: float | None) -> str:
    if value is None:
        return NOTHING
    if lead.truth is None or width is None:
        return UNJUDGED
    if abs(value - lead.truth) <= width:
        return WITHIN
    least = max(width, _NONE * abs(lead.truth))
    return NOTHING if abs(value) <= least < abs(lead.truth) else OUTSIDE
