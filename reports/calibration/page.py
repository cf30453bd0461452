"""The page of a calibration."""

from __future__ import annotations

from simcompare import glossary
from simcompare.reports.calibration import figures, tables, words
from simcompare.reports.render.parts import Block, Part, part_of
from simcompare.results.records.calibration import CalibrationRecord

QUESTION = "What is the sensor off by, and how well is that known?"
#: words of the tables that are explained below them
WORDS = ("six positions", "levelling", "ellipsoid fit", "condition number")


def title(record: CalibrationRecord) -> str:
    """Heading of the page."""
    return f"Calibration of {record.source}"


def block_of(record: CalibrationRecord) -> Block:
    """What the page shows."""
    return Block(
        "c1", "calibration", title(record), QUESTION, record.created,
        record.software.simcompare or "",
        (_answer(record), _open(record), _known(record)),
    )  # fmt: skip


def _answer(record: CalibrationRecord) -> Part:
    every = [tables.terms(record), tables.truth(record), tables.poses(record)]
    return part_of(
        "Answer", "answer", [figures.of(record)], every, words.notes(record), words.answer(record)
    )


def _open(record: CalibrationRecord) -> Part:
    return part_of("What it cannot tell apart", "open", notes=record.not_separable)


def _known(record: CalibrationRecord) -> Part:
    notes = glossary.legend(WORDS)
    both = [tables.assumed(record), tables.shares(record)]
    return part_of("What was taken as known", "known", tables=both, notes=notes)
