"""The page of runs beside each other: one figure, one table, and all other measures folded."""

from __future__ import annotations

from simcompare.notation import capital
from simcompare.reports.compare import tables, words
from simcompare.reports.compare.compared import Compared
from simcompare.reports.compare.figure import deviations, figure
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Block, Part
from simcompare.reports.run import runs


def block_of(compared: Compared, measure: str) -> Block:
    """What the page shows.

    Args:
        compared: the runs.
        measure: what leads.
    """
    return Block(
        "compare",
        "comparison",
        words.title(compared),
        " ".join(dict.fromkeys(run.record.question for run in compared.runs)),
        origin="",
        version=compared.runs[-1].record.software.simcompare,
        parts=(_answer(compared, measure), _others(compared, measure), _runs(compared)),
    )


def _answer(compared: Compared, measure: str) -> Part:
    shown = tables.tables(compared, measure)
    legend = ". ".join(words.legend(compared, shown))
    noted = (*shown[:-1], shown[-1]._replace(note=f"{legend}."))
    leads = len(noted) == 1  # several stand below all figures
    return Part(
        "Answer",
        "answer",
        short=words.short(compared, measure),
        key_numbers=words.key_numbers(compared, measure),
        figures=_figures(compared, measure),
        notes=words.notes(compared),
        tables=noted if leads else (),
        parts=() if leads else (Part(tables=noted),),
    )


def _others(compared: Compared, measure: str) -> Part:
    """Every other measure, each folded."""
    parts = (
        Part(
            capital(runs.measure_words(name)),
            figures=_figures(compared, name),
            tables=tuple(tables.tables(compared, name)),
            folded=True,
            finding=words.finding(compared, name),
        )
        for name in compared.measures
        if name != measure
    )
    return Part("Other measures", "measures", parts=tuple(parts))


def _figures(compared: Compared, measure: str) -> tuple[Figure, ...]:
    """The measure, and how far it is from its truth where that is not seen there."""
    off = deviations(compared, measure)
    return (figure(compared, measure), *([] if off is None else [off]))


def _runs(compared: Compared) -> Part:
    return Part("Runs", "runs", tables=(tables.what_differs(compared),), folded=True)
