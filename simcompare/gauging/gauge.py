"""Worked examples, recomputed and judged."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from simcompare.gauging import registry
from simcompare.gauging.check import Check, Kind, Verdict
from simcompare.gauging.example import Example


@dataclass(frozen=True)
class Row:
    """One number, as ``--json`` prints it.

    Attributes:
        example: name of the worked example.
        quantity: what the number is of.
        published: the reference number, ``None`` where the example was skipped.
        computed: by this program.
        digits: significant digits that agree.
        verdict: "PASS", "NOTE", "DIFF", or "SKIPPED".
        kind: of the reference: "published" or "exact", ``None`` where the example was skipped.
        source: of the reference.
        standard_error: of ``computed``, ``None`` where no trials are drawn.
        remark: why a NOTE is off, and what a SKIPPED one lacks; empty for others.
    """

    example: str
    quantity: str
    published: float | None
    computed: float | None
    digits: float | None
    verdict: Verdict
    kind: Kind | None
    source: str
    standard_error: float | None
    remark: str


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
            nothing = (None, None, None)
            return [
                Row(self.name, "all numbers", *nothing, "SKIPPED", None, self.source, None,
                    self.missing)
            ]  # fmt: skip
        return [_row(self.name, one) for one in self.checks]


def gauged(names: Iterable[str]) -> tuple[Outcome, ...]:
    """Recomputes the examples of these names, which exist; closed forms come last."""
    examples = {name: registry.load(name) for name in names}
    order = sorted(examples, key=lambda name: examples[name].closed_form)
    return tuple(_outcome(name, examples[name]) for name in order)


def _outcome(name: str, example: Example) -> Outcome:
    missing = example.missing()
    checks = () if missing else tuple(_stamped(example, one) for one in example.checks())
    return Outcome(name, example.title, example.source, checks, missing)


def _stamped(example: Example, check: Check) -> Check:
    """The same with kind and source, of its example where it has none of its own."""
    kind = check.kind or example.kind
    return replace(check, kind=kind, source=check.source or example.source)


def _row(name: str, check: Check) -> Row:
    remark = check.remark if check.verdict == "NOTE" else ""
    return Row(
        name, check.quantity, check.value, check.computed, round(check.digits, 1), check.verdict,
        check.kind or None, check.source, check.standard_error or None, remark,
    )  # fmt: skip
