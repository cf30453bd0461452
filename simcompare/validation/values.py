"""Single values of all engines held against those of a recording, and against each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from simcompare.inference.compared_values import compared_values
from simcompare.inference.evaluated import Evaluated
from simcompare.inference.simulated import Engine
from simcompare.results.records.validation import AgreementRecord, ValueRecord
from simcompare.statistics.agreement import birge_ratio


def values(engine: Engine, number: int, one: Evaluated) -> Iterator[ValueRecord]:
    """Single values of both, with the three parts of their uncertainty (ASME V&V 20).

    Args:
        engine: what it gave.
        number: of the segment.
        one: the segment.
    """
    for value in compared_values(engine, number, one):
        yield ValueRecord(source=engine.name, stream=one.segment.stream, **vars(value))


def agreement(rows: Sequence[ValueRecord]) -> Iterator[AgreementRecord]:
    """Whether the engines agree among themselves within their own step errors (Birge ratio)."""
    for stream, measure in dict.fromkeys((row.stream, row.measure) for row in rows):
        of_measure = [row for row in rows if (row.stream, row.measure) == (stream, measure)]
        known = {
            row.source: (row.simulated, row.u_num) for row in of_measure if row.u_num is not None
        }
        if len(known) < 2:
            continue
        # two numbers that are equal to rounding agree
        least = 1e-12 * max(abs(value) for value, _ in known.values()) or 1e-300
        ratio = birge_ratio(
            [value for value, _ in known.values()], [max(u, least) for _, u in known.values()]
        )
        yield AgreementRecord(
            stream=stream,
            measure=measure,
            unit=of_measure[0].unit,
            engines=tuple(known),
            left_out=tuple(row.source for row in of_measure if row.u_num is None),
            **vars(ratio),
        )
