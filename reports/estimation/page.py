"""The page of an estimation: the answer, one figure, one table; then tests and how it was made."""

from __future__ import annotations

import shlex

from simcompare import glossary
from simcompare.reports.estimation import chips, drift, figures, tables
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.parts import Block, Part, part_of
from simcompare.reports.render.tables import Table
from simcompare.results.records.estimation import Estimation


def block_of(result: Estimation) -> Block:
    """What the page shows."""
    drawn = figures.figures(result)
    answer = part_of("Answer", "answer", drawn[:1], _lead_tables(result), answer=_answer(result))
    parts = [answer, *_tests(result, drawn[1:]), _how(result)]
    return Block(
        "e1",
        "estimation",
        result.title,
        result.question,
        result.created,
        result.software.simcompare or "",
        tuple(parts),
    )


def legend(result: Estimation) -> tuple[str, ...]:
    """What the words of the table mean, a line each."""
    if drift.known(result):
        return tuple(glossary.legend(["odometry error", "u"]))
    outcomes = [found.outcome for one in result.done if (found := one.nees or one.nis)]
    test = "NEES" if any(one.nees for one in result.done) else "NIS"
    words = [test, *outcomes] if outcomes else []
    ways = [way for way in ("filtered", "smoothed") if any(way in s.ways for s in result.done)]
    return tuple(glossary.legend([*ways, *dict.fromkeys(words)]))


def _answer(result: Estimation) -> list[str]:
    missing = [one for one in result.sources if one.reason and result.done]
    return [*result.sentences, *(f"{one.source} did not run: {one.reason}" for one in missing)]


def _lead_tables(result: Estimation) -> list[Table]:
    asked = [chips.table(result), chips.budget(result)]
    return [*filter(None, asked), *([tables.lead(result)] if result.done else [])]


def _tests(result: Estimation, drawn: list[Figure]) -> list[Part]:
    if not result.done:
        return []
    tests = tables.of_tests(result)
    every = [*([tests] if any(group.rows for group in tests.groups) else []),
             *tables.of_states(result)]  # fmt: skip
    return [part_of("Every state and every test", "tests", drawn, every, legend(result))]


def _how(result: Estimation) -> Part:
    sheets = ", ".join(
        f"{name} {one.sheet or 'with errors of its own'}"
        + (f" at {one.rate_Hz:g} Hz" if one.rate_Hz else "")
        for name, one in result.sensors.items()
    )
    versions = {one.source: one.version for one in result.sources}
    engines = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    options = ", ".join(f"{name} = {value:g}" for name, value in result.options.items())
    notes = [
        f"Sensors: {sheets}." if sheets else "",
        f"Options: {options}.",
        f"Engines: {engines}." if engines else "",
        *dict.fromkeys(note for one in result.done for note in one.notes),
        *dict.fromkeys(note for one in chips.rows(result) for note in one.notes),
        f"Made on {result.created} with simcompare {result.software.simcompare}:"
        f" {shlex.join(result.command)}",
    ]
    return part_of("How it was made", "how", notes=notes)
