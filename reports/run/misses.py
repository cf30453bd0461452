"""What else is outside its tolerance, beside the leading measure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from simcompare.comparison.comparison import FAIL, Score
from simcompare.reports.run import runs
from simcompare.reports.run.lead import OUTSIDE, Lead, Row, lead_as
from simcompare.reports.run.listing import in_how_many, joined
from simcompare.results.run import Run

#: more engines than this are counted
_NAMED = 2


@dataclass(frozen=True)
class Miss:
    """One measure that engines miss.

    Attributes:
        measure: its name.
        scores: those that fail, by the order of the engines.
    """

    measure: str
    scores: tuple[Score, ...]

    @property
    def names(self) -> list[str]:
        """Of the engines."""
        return [score.source for score in self.scores]

    @property
    def known(self) -> list[bool]:
        """Of each engine whether it has a value, which is then off."""
        return [score.value is not None for score in self.scores]


def fate(misses: Sequence[Miss], *, several: bool) -> str:
    """What is wrong with misses, as the end of a sentence: they are off, or have no value."""
    known = [value for miss in misses for value in miss.known]
    words = "off" if all(known) else "off or unmeasured" if any(known) else "unmeasured"
    return f"{'are' if several else 'is'} {words}"


def misses_of(run: Run, lead: Lead, mode: str, names: Sequence[str]) -> list[Miss]:
    """Measures other than the leading one that some of the engines miss at a level."""
    found = []
    for measure in runs.judged(run):
        scores = [runs.score_of(run, name, mode, measure) for name in names]
        failed = tuple(score for score in scores if score is not None and score.verdict == FAIL)
        if failed and measure != lead.measure:
            found.append(Miss(measure, failed))
    return found


def said(
    run: Run,
    misses: Sequence[Miss],
    every: Sequence[str],
    *,
    named: bool = True,
    value: bool = True,
) -> str:
    """The misses as half a sentence.

    Args:
        run: the run.
        misses: at least one.
        every: all engines at the level.
        named: whether it is told what is off and where; else the misses are counted.
        value: whether the farthest value is told as well.
    """
    several = len(misses) > 1
    count, wrong = (
        f"{len(misses)} other value{'s' if several else ''}",
        fate(misses, several=several),
    )
    if not named:
        return f"but {count} {wrong}"
    far = max(misses, key=lambda miss: max(_share(run, score) for score in miss.scores))
    names = list(dict.fromkeys(name for miss in misses for name in miss.names))
    where = f"in {joined(names)}" if len(names) <= _NAMED else in_how_many(names, every)
    words = f"the {runs.measure_words(far.measure)}"
    told = _farthest(run, far) if value else ""
    if not several:
        return f"but {words} {wrong} {where}{told}"
    return f"but {count} {wrong} {where}" + (f", most of all {words}{told}" if value else "")


def _farthest(run: Run, miss: Miss) -> str:
    """The farthest value in brackets, nothing where none could be measured."""
    lead = lead_as(run, miss.measure)
    far = max(miss.scores, key=lambda score: _share(run, score))
    if far.value is None:
        return ""
    value = lead.range_of([Row(far.source, far.value, None, OUTSIDE, far.tolerance)])
    return f" ({value}{f' instead of {lead.true}' if lead.truth else ''})"


def _share(run: Run, score: Score) -> float:
    return runs.share_of_tolerance(run, score) or 0.0
