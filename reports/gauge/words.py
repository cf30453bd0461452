"""What is said of worked examples that were recomputed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import groupby

from simcompare import glossary
from simcompare.gauging.gauge import Outcome

_LEGEND = ("published", "exact", "PASS", "NOTE", "DIFF", "digits")


def answer(outcomes: Sequence[Outcome]) -> str:
    """How many reference numbers are met, and of which kind they are."""
    count = Counter(check.verdict for one in outcomes for check in one.checks)
    total, examples = sum(count.values()), sum(1 for one in outcomes if one.checks)
    if not total:
        return "Nothing was recomputed."
    told_of = f"{examples} worked example" + ("s" if examples > 1 else "")
    tail = f"{count['PASS']} PASS, {count['NOTE']} NOTE, {count['DIFF']} DIFF"
    kinds = Counter(check.kind for one in outcomes for check in one.checks)
    told = " and ".join(f"{kinds[kind]} {kind}" for kind in ("published", "exact") if kinds[kind])
    numbers = f"{total} reference number" + ("s" if total > 1 else "")
    return f"{numbers} ({told}) of {told_of}: {tail}."


def notes(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """Why some numbers are off, and what was skipped."""
    for one in outcomes:
        if one.missing:
            yield f"{one.name}, skipped: {one.missing}"
        noted = [check for check in one.checks if check.verdict == "NOTE"]
        for remark, checks in groupby(noted, key=lambda check: check.remark):
            yield f"{one.name}, NOTE at {'; '.join(c.quantity for c in checks)}: {remark}"


def legend() -> list[str]:
    """What kinds and verdicts mean."""
    return list(glossary.legend(_LEGEND))


def sources(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """Where the reference numbers are from, each source once."""
    for one in outcomes:
        told = dict.fromkeys((one.source, *(check.source for check in one.checks)))
        yield f"{one.name}: {' '.join(told)}"
