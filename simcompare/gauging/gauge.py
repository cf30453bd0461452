"""Published worked examples, recomputed and judged."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from simcompare.gauging import registry
from simcompare.gauging.check import Check, Verdict
from simcompare.gauging.example import Example


@dataclass(frozen=True)
class Row:
    """One number, as ``--json`` prints it.

    Attributes:
        example: name of the worked example.
        quantity: what the number is of.
        published: as it is printed in the source, ``None`` where the example was skipped.
        computed: by this program.
        digits: significant digits that agree.
        verdict: "PASS", "NOTE", "DIFF", or "SKIPPED".
    """

    example: str
    quantity: str
    published: float | None
    computed: float | None
    digits: float | None
    verdict: Verdict


@dataclass(frozen=True)
class Outcome:
    """What came out of one worked example.

    Attributes:
        name: of the example.
        title: what it is.
        source: of its numbers.
        checks: its numbers, none where something is missing.
        missing: what is not on this machine, and how to get it.
    """

    name: str
    title: str
    source: str
    checks: tuple[Check, ...]
    missing: str

    @property
    def rows(self) -> list[Row]:
        """A row for each number; one that says what is missing where there is none."""
        if self.missing:
            return [Row(self.name, self.missing, None, None, None, "SKIPPED")]
        return [
            Row(self.name, one.quantity, one.value, one.computed, round(one.digits, 1), one.verdict)
            for one in self.checks
        ]


def gauged(names: Iterable[str]) -> tuple[Outcome, ...]:
    """Recomputes the examples of these names, which exist; closed forms come last."""
    examples = {name: registry.load(name) for name in names}
    order = sorted(examples, key=lambda name: examples[name].closed_form)
    return tuple(_outcome(name, examples[name]) for name in order)


def _outcome(name: str, example: Example) -> Outcome:
    missing = example.missing()
    checks = () if missing else tuple(example.checks())
    return Outcome(name, example.title, example.source, checks, missing)
