"""The leading measure of a run: what each source has of it, and which sources agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from simcompare.compare.comparison import Score
from simcompare.model.answer import Answer
from simcompare.reports.render import numbers
from simcompare.reports.run import runs
from simcompare.results.run import Run

WITHIN, OUTSIDE, NOTHING, UNJUDGED = "within", "outside", "nothing", "unjudged"
#: nothing in some repeats alone, and in none that is known
MIXED, UNMEASURED = "mixed", "unmeasured"
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
        of_events: whether it is the mean over the events of a repeat, such as all its bounces.
    """

    measure: str
    unit: str
    truth: float | None
    width: float | None
    widths: tuple[float, ...]
    answer: Answer | None
    of_events: bool = False

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

    @property
    def true(self) -> str:
        """The true value with its unit."""
        if self.truth is not None and self.width and self.places(self.truth) is not None:
            text = self._of([(self.truth, None)], 0)
            if float(f"{self.truth:.{self.places(self.truth)}f}") == self.truth:
                return numbers.plain(self.truth, 4) + self._unit
            return text
        return numbers.plain(self.truth, 4) + self._unit

    @property
    def _unit(self) -> str:
        return "" if self.unit in ("", "1") else f" {self.unit}"

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
        return "–" if value is None else self._of([(value, u)], more)

    def told(self, rows: Sequence[Row]) -> str:
        """What rows have, as one value or a range, with the digits that show what is outside."""
        known = [row for row in rows if row.value is not None]
        text = "–"
        for more in range(_MORE + 1 if known else 0):
            text = self._of([(row.value or 0.0, row.scatter) for row in known], more)
            if all(self._seen(row, more) for row in known):
                break
        return text

    def ends(self, row: Row) -> str:
        """The lowest and the highest repeat of a source."""
        return self._of([(end, None) for end in row.ends or ()], 0) if row.ends else "–"

    def _seen(self, row: Row, more: int) -> bool:
        """Whether the digits that are told show that a value is outside, where it is."""
        value = row.value or 0.0
        places = self.places(value)
        if row.kind != OUTSIDE or places is None:
            return True
        return abs(self.off(round(value, places + more), row.width)) > 1 + _EQUAL

    def _of(self, pairs: Sequence[tuple[float, float | None]], more: int) -> str:
        """Values from the lowest to the highest; the same digits are told once."""
        after = "" if self.unit in ("", "1") else f" {self.unit}"
        (low, u), (high, _) = min(pairs, key=lambda p: p[0]), max(pairs, key=lambda p: p[0])
        if self.places(high) is None:
            if low == high:
                return numbers.with_u(low, u, self.unit, self.truth, 4)
            return " to ".join(dict.fromkeys(numbers.plain(v, 4) for v in (low, high))) + after
        ends = dict.fromkeys(self._digits(value, more) for value in (low, high))
        scatters = {self._digits(u, more) for _, u in pairs if u and math.isfinite(u)}
        most = max(scatters, key=float, default="0")
        if float(most) == 0:
            return " to ".join(ends) + after
        if len(ends) == len(scatters) == 1:
            both = f"{next(iter(ends))} ± {most}"
            return f"({both}){after}" if after else both
        at_most = " at most" if len(scatters) > 1 else ""
        return f"{' to '.join(ends)}{after} (± {most}{after}{at_most})"

    def _digits(self, value: float, more: int) -> str:
        text = f"{value:.{(self.places(value) or 0) + more}f}"
        return text.lstrip("-") if float(text) == 0 else text.replace("-", "−")

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
        scatter: their standard deviation, ``None`` for a single one.
        kind: within the tolerance, outside, nothing at all, nothing in some repeats, not measured
            in any, or not judged.
        width: its own tolerance, ``None`` where it is not judged.
        ends: lowest and highest of the repeats that could be measured, where those are known.
        repeats: how many these are.
        lacking: why there is no value, where the source does not give a signal.
    """

    name: str
    value: float | None
    scatter: float | None
    kind: str
    width: float | None = None
    ends: tuple[float, float] | None = None
    repeats: int = 0
    lacking: str = ""


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
    def middle(self) -> float:
        """Mean of their values, to order groups by."""
        known = [row.value for row in self.rows if row.value is not None]
        return sum(known) / max(len(known), 1)


def lead_of(run: Run) -> Lead | None:
    """The measure that the scenario names, else the first that is judged or measured."""
    answer = run.record.answer
    measures = [*runs.judged(run), *runs.measures(run)]
    if answer is not None and answer.measure in measures:
        return _lead(run, answer.measure, answer)
    return _lead(run, measures[0], None) if measures else None


def first_events(run: Run, lead: Lead, mode: str) -> list[Row]:
    """What every source has of the first event alone, where the measure is a mean over events."""
    return [
        Row(score.source, score.value, score.scatter, UNJUDGED)
        for score in run.scores
        if (score.measure, score.contact, score.index) == (lead.measure, mode, 1)
        and score.value is not None
    ]


def lead_as(run: Run, measure: str) -> Lead:
    """The same of any measure of whole runs."""
    return _lead(run, measure, None)


def rows_of(run: Run, lead: Lead, mode: str) -> list[Row]:
    """What every source that ran at a level has of the leading measure."""
    return [
        _row(run, lead, name, runs.score_of(run, name, mode, lead.measure))
        for name in runs.ran(run, mode)
    ]


def _row(run: Run, lead: Lead, name: str, score: Score | None) -> Row:
    if score is None:
        return Row(name, None, None, UNMEASURED)
    value = score.value if score.value is not None and math.isfinite(score.value) else None
    ends = None if score.low is None or score.high is None else (score.low, score.high)
    width = _width(run, score)
    # of several steps each has a truth of its own
    truth = lead.truth if score.truth is None else score.truth
    kind = _kind(truth, value, width, ends)
    return Row(name, value, score.scatter, kind, width, ends, score.repeats, score.lacking)


def groups_of(lead: Lead, rows: Sequence[Row]) -> list[Group]:
    """Sources that agree within the tolerance, the largest group first.

    One whose values scatter by more than the tolerance stands apart from those that do not.
    """
    known = [row for row in rows if row.value is not None]
    alike = lead.width or _ALIKE * max((abs(row.value or 0) for row in known), default=0.0)
    groups: list[list[Row]] = []
    for row in sorted(known, key=lambda r: ((r.scatter or 0.0) > alike, r.value)):
        last = groups[-1] if groups else None
        same = last is not None and ((last[0].scatter or 0.0) > alike) == (
            (row.scatter or 0.0) > alike
        )
        if last is not None and same and (row.value or 0.0) - (last[0].value or 0.0) <= alike:
            last.append(row)
        else:
            groups.append([row])
    order = {row.name: i for i, row in enumerate(rows)}
    found = [Group(tuple(sorted(group, key=lambda row: order[row.name]))) for group in groups]
    return sorted(found, key=lambda group: (-len(group.rows), abs(lead.off(group.middle))))


def _lead(run: Run, measure: str, answer: Answer | None) -> Lead:
    every = [s for s in run.scores if s.measure == measure]
    scores = [s for s in every if s.index is None]
    known = next((score for score in scores if score.truth is not None), scores[0])
    widths = sorted({w for score in scores if (w := _width(run, score)) is not None})
    least, of_events = min(widths, default=None), len(scores) < len(every)
    return Lead(measure, known.unit, known.truth, least, (*widths,), answer, of_events)


def _width(run: Run, score: Score) -> float | None:
    return None if score.truth is None else runs.width(run, score)


def _kind(
    truth: float | None,
    value: float | None,
    width: float | None,
    ends: tuple[float, float] | None,
) -> str:
    if value is None:  # of some repeats there may be one
        same = ends is None or ends[0] == ends[1]
        return UNMEASURED if same else MIXED
    if truth is None or width is None:
        return UNJUDGED
    if abs(value - truth) <= width:
        return WITHIN
    least = max(width, _NONE * abs(truth))
    if not abs(value) <= least < abs(truth):
        return OUTSIDE
    return NOTHING if max(map(abs, ends or (value,))) <= least else MIXED
