"""The page of a table of results: the answer and the picture first, then every row."""

from __future__ import annotations

from dataclasses import replace

from simcompare import glossary
from simcompare.reports.render.parts import Block, Part, part_of
from simcompare.reports.tabled import tables, words
from simcompare.reports.tabled.figures import figures_of
from simcompare.results.records.tabled import TableValidation


def block_of(found: TableValidation) -> Block:
    """What the page shows."""
    return Block(
        "t1", "table", found.title, found.question, found.created, found.software.simcompare,
        (_answer(found), _rows(found), _how(found)),
    )  # fmt: skip


def _answer(found: TableValidation) -> Part:
    told = [tables.told(result) for result in found.results]
    notes = [f"Did not run: {why}" for why in words.not_run(found)]
    return part_of(
        "Answer", "answer", figures_of(found), [tables.verdicts(found), *told], notes,
        answer=words.sentences(found),
    )  # fmt: skip


def _rows(found: TableValidation) -> Part:
    return part_of("Every row", "rows", tables=map(tables.rows, found.results))


def _how(found: TableValidation) -> Part:
    engines = {one.source: one.version for result in found.results for one in result.verdicts}
    versions = ", ".join(f"{name} {version}" for name, version in engines.items() if version)
    notes = [
        *words.notes(found), *glossary.legend(words.WORDS),
        f"Engines: {versions}" if versions else "No engine ran",
        f"Table: {found.recording}, SHA-256 {found.sha256}",
        f"Made on {found.created} with simcompare {found.software.simcompare}",
    ]  # fmt: skip
    made = part_of("How it was made", "how", tables=[tables.columns(found)], notes=notes)
    return replace(made, code=found.command)
