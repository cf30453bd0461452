"""Sentences about contact levels: how they begin, and those that say the same as one."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

from simcompare.model.settings import ASSISTED, BY_HAND, COEFFICIENTS, DEFAULT, TUNED
from simcompare.reports.run.listing import joined
from simcompare.results.run import Run


def merged(run: Run, phrases: Iterable[tuple[str, str]]) -> list[str]:
    """Sentences of a level and a rest; levels after each other with the same rest are one.

    Args:
        run: the run.
        phrases: contact levels, and what is said of each; nothing is said of an empty one.
    """
    said = [(mode, rest) for mode, rest in phrases if rest]
    return [f"{head([mode for mode, _ in group], run)} {rest}." for rest, group in _together(said)]


def _together(said: Sequence[tuple[str, str]]) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    for rest, group in itertools.groupby(said, lambda phrase: phrase[1]):
        yield rest, list(group)


def head(modes: Sequence[str], run: Run) -> str:
    """The begin of a sentence about some levels."""
    first, *others = (how(run, mode) for mode in modes)
    if not others:
        return first
    heads = [first, *(f"{other[0].lower()}{other[1:]}" for other in others)]
    return f"{joined([one.rstrip(',') for one in heads])},"


def how(run: Run, mode: str) -> str:
    """A level as the begin of a sentence."""
    if mode == ASSISTED and run.record.assist == "none":
        return "Assisted by nothing,"
    if mode == TUNED:
        return "Tuned,"
    return _HOW.get(mode, f"At the level {mode},")


_HOW = {
    DEFAULT: "By default",
    COEFFICIENTS: "With coefficients alone,",
    ASSISTED: "Assisted,",
    BY_HAND: "With values set by hand,",
    "fitted": "With the fitted parameters,",
}
