"""The page of one sensor: the answer, what makes it up, the lines of the sheet, and the rules."""

from __future__ import annotations

from simcompare import glossary
from simcompare.reports.render.parts import Block, Part, part_of
from simcompare.reports.sensor import figures, tables, words
from simcompare.results.records.sensor import RuleRow, SensorReading

QUESTION = "How uncertain is a reading before calibration, and why?"


def title(found: SensorReading) -> str:
    """Above everything."""
    return f"{found.chip}, {found.part.replace('_', ' ')}"


def block_of(found: SensorReading, rules: tuple[RuleRow, ...]) -> Block:
    """What the page shows."""
    return Block(
        "s1", f"sensor-{found.name}", title(found), QUESTION, found.document, None,
        (_answer(found), _lines(found), *_drawn(found), _rules(rules)),
    )  # fmt: skip


def _answer(found: SensorReading) -> Part:
    sentences = [words.answer(found), *words.further(found)]
    return part_of(
        "Answer", "answer", [figures.shares(found), figures.readings(found)], answer=sentences
    )


def _lines(found: SensorReading) -> Part:
    return part_of(
        "What the sheet says", "sheet", tables=[tables.of_entries(found)._replace(title="")],
        notes=[*words.notes(found), *glossary.legend(tables.WORDS)],
    )  # fmt: skip


def _drawn(found: SensorReading) -> list[Part]:
    if not found.devices:
        return []
    made = tables.of_devices(found)._replace(title="")
    return [part_of("Drawn devices", "devices", tables=[made])]


def _rules(rules: tuple[RuleRow, ...]) -> Part:
    made = tables.of_rules(rules)._replace(title="")
    return part_of("How a value becomes a distribution", "rules", tables=[made])
