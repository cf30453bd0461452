"""What each source has of the leading measure, and which sources agree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from simcompare.comparison.comparison import Score
from simcompare.reports.run import runs
from simcompare.reports.run.lead import (
    MIXED,
    NOTHING,
    OUTSIDE,
    UNJUDGED,
    UNMEASURED,
    WITHIN,
    Lead,
    Row,
    width_of,
)
from simcompare.results.run import Run

#: a value below this part of the truth is none at all
_NONE = 0.01
#: values agree within this part where the scenario states no tolerance
_ALIKE = 0.01


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


def first_events(run: Run, lead: Lead, mode: str) -> list[Row]:
    """What every source has of the first event alone, where the measure is a mean over events."""
    return [
        Row(score.source, score.value, score.scatter, UNJUDGED)
        for score in run.record.scores
        if (score.measure, score.contact, score.index) == (lead.measure, mode, 1)
        and score.value is not None
    ]


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
    width = width_of(run, score)
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
    agreeing = [Group(tuple(sorted(group, key=lambda row: order[row.name]))) for group in groups]
    return sorted(agreeing, key=lambda group: (-len(group.rows), abs(lead.off(group.middle))))


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
