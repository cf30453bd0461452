"""Records read another way: whether one usual mistake, or two, would explain what does not fit.

A mistake in what a recording is said to be (a sign, two columns exchanged, a half turn) does not
show in its numbers. It shows where they are held against something else. So each mistake is undone
for a trial, and what then fits much better is told. Nothing is repaired.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

T = TypeVar("T")

#: a mistake is told where it explains so much: the misfit falls by this factor at least
BETTER = 3.0
#: of mistakes that explain about as much, the first one is told
ALIKE = 1.5
#: those that cannot be told from it are told with it
SAME = 1.001
#: of how many mistakes, the best ones alone, all pairs are tried
PAIRED = 6


@dataclass(frozen=True)
class Change(Generic[T]):
    """A record with one mistake undone.

    Attributes:
        value: the record.
        says: what was changed, such as "left and right exchanged".
        cure: what to write or type to read it so.
    """

    value: T
    says: str
    cure: str


#: a mistake: what becomes of a record without it, ``None`` where it cannot be there
Hypothesis = Callable[[T], Change[T] | None]
Misfit = Callable[[T], float]


@dataclass(frozen=True)
class Suspicion:
    """What would explain a record that does not fit.

    Attributes:
        says: each change in words, one or two.
        cures: what to write or type for each.
        before: misfit of the record as it is.
        after: with the changes.
        also: changes that by symmetry explain exactly as much.
    """

    says: tuple[str, ...]
    cures: tuple[str, ...]
    before: float
    after: float
    also: tuple[str, ...] = ()


def suspected(
    given: T, hypotheses: Sequence[Hypothesis[T]], misfit: Misfit[T], *, paired: int = PAIRED
) -> Suspicion | None:
    """The mistake that explains a misfit, or the two that do where no single one does.

    Args:
        given: the record as it is.
        hypotheses: the mistakes, the likeliest first.
        misfit: how far a record is from what is known, 0 or more; infinite where it cannot be.
        paired: of how many mistakes, the best ones alone, all pairs are tried.
    """
    before = misfit(given)
    alone = [(i, one, misfit(one.value)) for i, h in enumerate(hypotheses) if (one := h(given))]
    alone = [row for row in alone if math.isfinite(row[2])]
    found = _best([((one,), after) for _, one, after in alone])
    good = {i for i, _, _ in sorted(alone, key=lambda row: row[2])[:paired]}
    pairs = []
    for i, one, _ in alone:
        for j in range(i + 1, len(hypotheses)):
            both = hypotheses[j](one.value) if good & {i, j} else None
            if both is not None:
                pairs.append(((one, both), misfit(both.value)))
    twofold = _best(pairs)
    if twofold is not None and (found is None or found[1] > BETTER * twofold[1]):
        found = twofold
    if found is None or not before > BETTER * found[1]:
        return None
    changes, after = found
    says, cures = zip(*((one.says, one.cure) for one in changes), strict=True)
    same = [one.says for _, one, left in alone if left <= SAME * after and one.says not in says]
    return Suspicion(says, cures, before, after, tuple(same) if len(changes) == 1 else ())


def _best(
    tried: Sequence[tuple[tuple[Change[T], ...], float]],
) -> tuple[tuple[Change[T], ...], float] | None:
    """The first of those that fit about best."""
    if not tried:
        return None
    least = min(after for _, after in tried)
    return next(row for row in tried if row[1] <= ALIKE * least)
