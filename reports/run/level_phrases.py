"""Sentences about contact levels: how they begin, and those that say the same as one."""

from __future__ import annotations

import itertools
from collections.abc import Iterable

from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from simcompare.reports.render import numbers
from simcompare.reports.run import audit
from simcompare.results.run import Run


def merged(phrases: Iterable[tuple[str, str]]) -> list[str]:
    """Sentences of a begin and a rest; those after each other with the same rest are one."""
    sentences: list[str] = []
    for rest, group in itertools.groupby(((head, rest) for head, rest in phrases if rest), _rest):
        first, *others = (head for head, _ in group)
        also = "".join(f"; {head[0].lower()}{head[1:].rstrip(',')} the same" for head in others)
        sentences.append(f"{first} {rest}{also}.")
    return sentences


def _rest(phrase: tuple[str, str]) -> str:
    return phrase[1]


def how(run: Run, mode: str) -> str:
    """A level as the begin of a sentence, with the step that all engines took in it."""
    if mode == ASSISTED and run.record.assist == "none":
        return "With none of our helps,"
    if mode == TUNED:
        return f"Tuned{_step(run, mode)},"
    return _HOW.get(mode, f"At the level {mode},")


_HOW = {
    DEFAULT: "By default",
    COEFFICIENTS: "With the coefficients alone,",
    ASSISTED: "With our helps,",
    "fitted": "With the fitted parameters,",
}


def _step(run: Run, mode: str) -> str:
    ran = [source for source in run.record.sources if source.contact == mode]
    steps = {audit.step_of(source) for source in ran if source.status == "ok"}
    step_s = steps.pop() if len(steps) == 1 else None
    return "" if step_s is None else f" at a step of {numbers.plain(1e3 * step_s, 3)} ms"
