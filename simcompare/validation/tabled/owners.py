"""What a column of uncertainties is the uncertainty of: one period, ten, or a total time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from simcompare.validation.tabled.meaning import (
    LEFT_OUT,
    MEASURED,
    TOTAL,
    UNCERTAINTY,
    Guess,
    Meaning,
)
from simcompare.validation.tabled.vocabulary import Vocabulary


def with_owners(
    found: Sequence[Meaning], guesses: Sequence[Guess], known: Vocabulary
) -> list[Meaning]:
    """Uncertainties with what they are of: one period, the time of ten, or the total time."""
    made: list[Meaning] = []
    for one, guess in zip(found, guesses, strict=True):
        if one.role == UNCERTAINTY:
            before = made[-1] if made else None
            one = _owned(one, guess, found, before, known)
        made.append(one)
    return made


def _owned(
    one: Meaning, guess: Guess, found: Sequence[Meaning], before: Meaning | None, known: Vocabulary
) -> Meaning:
    said = {*guess.rest} - known.fillers
    if one.entry is not None:
        same = [other for other in found if other.role == MEASURED and other.entry == one.entry]
        repeats = {other.repeat for other in same}  # dT10 may be that of the tenth repeat
        return replace(one, count=next((n for n in guess.numbers if n > 1 and n not in repeats), 1))
    owner = before if not said and before and before.role != LEFT_OUT else None
    if said and said <= TOTAL:  # the time that was read from the watch
        timed = [other for other in found if other.role == MEASURED and other.entry
                 and (other.of_total or other.count > 1)]  # fmt: skip
        owner = timed[0] if timed else None
    if owner is None or owner.entry is None:
        return Meaning(one.heading, LEFT_OUT, note="is an uncertainty of nothing that is used")
    return replace(one, entry=owner.entry, count=owner.count, of_total=owner.of_total)
