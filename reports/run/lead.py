"""The leading measure of a run: what each source has of it, and which sources agree."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from simcompare import notation
from simcompare.comparison.comparison import Score
from simcompare.model.answer import Answer
from simcompare.reports.render import numbers
from simcompare.reports.run import runs
from simcompare.results.run import Run

WITHIN, OUTSIDE, NOTHING, UNJUDGED = "within", "outside", "nothing", "unjudged"
#: nothing in some repeats alone, and in none that is known
MIXED, UNMEASURED = "mixed", "unmeasured"
#: so many more digits are tried to show that a value is outside
_MORE = 2
#: the least whole number that has two digits
_TWO_DIGITS = 10
#: part of the largest value below which another is no more than rounding
_ROUNDING = 1e-9
#: what rounding leaves of a part of a tolerance
_EQUAL = 1e-9


_ZEROS = re.compile(r"\.\d*[1-9]0{4,}$")


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
        size: of the largest value, beside which others may be no more than rounding.
        decimals: how many are worth reading in a table, ``None`` where that is not known.
        instead_of: the measure that should lead and has no value at all, else empty.
    """

    measure: str
    unit: str
    truth: float | None
    width: float | None
    widths: tuple[float, ...]
    answer: Answer | None
    of_events: bool = False
    size: float = 0.0
    decimals: int | None = None
    instead_of: str = ""

    @property
    def lacking(self) -> tuple[str, ...]:
        """That what should lead has no value, as a sentence, where it is so."""
        words = runs.measure_words(self.instead_of)
        return (f"The {words} could not be measured.",) if words else ()

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
        places = None if self.truth is None else self.places(self.truth)
        if self.truth is None or places is None or round(self.truth, places) == self.truth:
            return numbers.plain(self.truth, 4) + self.after
        return self._range([(self.truth, None)], 0)

    @property
    def after(self) -> str:
        """The unit as it follows a number."""
        return "" if self.unit in ("", "1") else f" {self.unit}"

    @property
    def none(self) -> str:
        """No value at all, with its unit."""
        return f"0{self.after}"

    def clean(self, value: float) -> float:
        """A value, 0 where it is no more than rounding beside others, or is 0 in the table."""
        is_zero = self.decimals is not None and notation.is_zero(value, self.decimals)
        return 0.0 if is_zero or abs(value) < _ROUNDING * self.size else value

    def off(self, value: float, width: float | None = None) -> float:
        """How far a value is from the truth, in tolerances."""
        accepted = width or self.width
        if self.truth is None or not accepted:
            return 0.0
        return (value - self.truth) / accepted

    def text(self, value: float) -> str:
        """A value with its unit, to the digit that the tolerance leaves."""
        return self._range([(value, None)], 0)

    def range_of(self, rows: Sequence[Row]) -> str:
        """What rows have, as one value or a range, with the digits that show what is outside."""
        known = [row for row in rows if row.value is not None]
        if self.truth == 0 and known and all(row.kind != OUTSIDE for row in known):
            return self._at_most([abs(row.value or 0.0) for row in known])
        text, places = "–", self._places([row.value or 0.0 for row in known])
        for more in range(_MORE + 1 if known else 0):
            text = self._range([(row.value or 0.0, row.scatter) for row in known], more)
            if all(self._is_shown(row, places, more) for row in known):
                break
        return text

    def _at_most(self, sizes: Sequence[float]) -> str:
        """The largest of some errors in two digits; none at all far below the tolerance."""
        largest = self.clean(max(sizes))
        if largest == 0:
            return self.none
        many = "at most " if len(sizes) > 1 else ""
        return f"{many}{numbers.plain(largest, 2)}{self.after}"

    def span(self, values: Sequence[float]) -> str:
        """The lowest and the highest of some values."""
        return self._range([(value, None) for value in values], 0) if values else "–"

    def ends(self, row: Row) -> str:
        """The lowest and the highest repeat of a source."""
        return self.span(row.ends or ())

    def _is_shown(self, row: Row, places: int | None, more: int) -> bool:
        """Whether so many further digits show that a value is outside, where it is."""
        if row.kind != OUTSIDE or places is None:
            return True
        value = round(row.value or 0.0, places + more)
        return abs(self.off(value, row.width)) > 1 + _EQUAL

    def _range(self, pairs: Sequence[tuple[float, float | None]], more: int) -> str:
        """Values with their scatters, from the lowest to the highest; the same digits once."""
        values = [self.clean(value) for value, _ in pairs]
        scatters = [u for _, u in pairs if u and math.isfinite(u)]
        low, high, places = min(values), max(values), self._places(values)
        if places is None and low == high:
            u = max(scatters, default=None)
            return numbers.with_u(low, u, self.unit, self.truth, 4)
        more += self._is_coarse(max(map(abs, values)), places)
        ends = dict.fromkeys(_digits(value, places, more) for value in (low, high))
        if len(ends) == 1:
            ends = dict.fromkeys(map(_without_zeros, ends))
        return self._with_scatter(
            [*ends], dict.fromkeys(_digits(u, places, more, 2) for u in sorted(scatters))
        )

    def _is_coarse(self, largest: float, places: int | None) -> bool:
        """Whether one digit at most is left of a value of which the table shows more."""
        if places is None or self.decimals is None or self.decimals <= places:
            return False
        return largest > 0 and round(largest * 10.0**places) < _TWO_DIGITS

    def _with_scatter(self, ends: Sequence[str], scatters: Iterable[str]) -> str:
        """One value or a range, and the largest of the scatters, where it is to be seen."""
        after, known = self.after, [*scatters]
        if not known or known[-1] == "0":
            return " to ".join(ends) + after
        largest = known[-1]
        if len(ends) == len(known) == 1:
            both = f"{ends[0]} ± {largest}"
            return f"({both}){after}" if after else both
        at_most = " at most" if len(known) > 1 else ""
        return f"{' to '.join(ends)}{after} (± {largest}{after}{at_most})"

    def _places(self, values: Sequence[float]) -> int | None:
        """The same of several values, which all have the decimals of the largest."""
        return self.places(max(map(abs, values), default=0.0))

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


def lead_of(run: Run) -> Lead | None:
    """The measure that the scenario names, else the first that is judged or measured.

    Where the named one has no value in any engine and no truth, the first judged one that has a
    value leads.
    """
    answer = run.record.answer
    measures = [*runs.judged(run), *runs.measures(run)]
    if answer is None or answer.measure not in measures:
        return _lead(run, measures[0], None) if measures else None
    scores = run.record.whole.values()
    known = {score.measure for score in scores if _has_value(score)}
    with_truth = {score.measure for score in scores if score.truth is not None}
    others = [measure for measure in runs.judged(run) if measure in known]
    if answer.measure in known | with_truth or not others:
        return _lead(run, answer.measure, answer)
    return replace(_lead(run, others[0], None), instead_of=answer.measure)


def _has_value(score: Score) -> bool:
    """Whether something is known, of some repeats at least."""
    return score.low is not None or (score.value is not None and math.isfinite(score.value))


def lead_as(run: Run, measure: str) -> Lead:
    """The same of any measure of whole runs."""
    return _lead(run, measure, None)


def _lead(run: Run, measure: str, answer: Answer | None) -> Lead:
    scores = [score for score in run.record.whole.values() if score.measure == measure]
    known = next((score for score in scores if score.truth is not None), scores[0])
    widths = sorted({w for score in scores if (w := width_of(run, score)) is not None})
    least, of_events = min(widths, default=None), measure in run.record.in_events
    size = max((abs(value) for s in scores for value in (s.value, s.truth) if value), default=0.0)
    decimals = notation.places(
        least, (value for s in scores for value in (s.value, s.truth, s.low, s.high))
    )
    return Lead(
        measure, known.unit, known.truth, least, (*widths,), answer, of_events, size, decimals
    )


def width_of(run: Run, score: Score) -> float | None:
    """The tolerance of a score, ``None`` where it has no truth."""
    return None if score.truth is None else runs.width(run, score)


def _digits(value: float, places: int | None, more: int, few: int = 4) -> str:
    """A value with so many decimals and some more, in few digits where they are not known."""
    if places is None:
        return numbers.plain(value, few)
    text = notation.fixed(value, places + more)
    return text if text.strip("0.") else "0"


def _without_zeros(text: str) -> str:
    """A number that many zeros end says no more than without them."""
    return text.rstrip("0") if _ZEROS.search(text) else text
