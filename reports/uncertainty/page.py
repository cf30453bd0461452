"""The page of ``uncertainty``: the answer, one picture, the budget; then each engine's."""

from __future__ import annotations

from dataclasses import replace

from simcompare import glossary
from simcompare.reports.render.parts import Block, Part, part_of
from simcompare.reports.uncertainty import answer, tables
from simcompare.reports.uncertainty.figures import figure_of
from simcompare.results.records.uncertainty import Uncertainty


def block_of(result: Uncertainty) -> Block:
    """What the page shows."""
    more = [_way(result, number) for number in range(1, len(result.known))]
    return Block(
        "u1", "uncertainty", result.title, result.question, result.created,
        result.software.simcompare or "", (_answer(result), *more, _inputs(result), _how(result)),
    )  # fmt: skip


def _answer(result: Uncertainty) -> Part:
    if not result.known:
        return part_of("Answer", "answer", answer=answer.sentences(result))
    made = [tables.budget_of(result)]
    if len(result.ways) > 1 or result.known[0][1].monte_carlo:
        made.append(tables.ways_of(result))
    notes = [f"Did not run: {why}" for why in answer.not_run(result)]
    return part_of(
        "Answer", "answer", [figure_of(result)], made, notes, answer=answer.sentences(result)
    )


def _way(result: Uncertainty, number: int) -> Part:
    way, found = result.known[number]
    return part_of(
        f"By {way.source}", way.source, [figure_of(result, number)],
        [tables.budget_of(result, number)], finding=answer.coverage(found.budget),
    )  # fmt: skip


def _inputs(result: Uncertainty) -> Part:
    """Where the uncertainties come from."""
    facts = {f"{one.name} ({one.stated})": one.reason for one in result.inputs}
    facts |= {f"{one} with {other}": f"correlation {r:g}" for one, other, r in result.correlation}
    return part_of("Where the uncertainties come from", "inputs", facts=facts)


def _how(result: Uncertainty) -> Part:
    words = [*tables.BUDGET_WORDS, *tables.WAYS_WORDS]
    made = f"Made on {result.created} with simcompare {result.software.simcompare}"
    notes = [*answer.notes(result), *glossary.legend(words), made]
    return replace(part_of("How it was made", "how", notes=notes), code=result.command)
