"""Engines against a measurement."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.comparison.against import Match
from simcompare.notation import capital
from simcompare.reports.render import numbers
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Column, Group, of_engines
from simcompare.reports.run import measurement_figures, runs
from simcompare.reports.run.listing import engines, grouped, joined, noun
from simcompare.results.records.run import Measurement
from simcompare.results.run import Run

_INSIDE = {
    True: "✓ agrees with the measurement",
    False: "✗ does not agree with the measurement",
    None: "· cannot be told",
}
_COLUMNS = (
    Column("Mode", text=True), Column("value ± s"), Column("E_n"), Column("Inside", text=True),
)  # fmt: skip
_NOTE = (
    "E_n is the difference over its expanded uncertainty (ISO 13528:2022, 9.7); k = 2, and more for"
    " the scatter of few repeats, such as 2.4 for nine. A value is inside when it lies within the"
    " stated limits or, where there are none, when |E_n| ≤ 1."
)


def measurement(run: Run) -> Part | None:
    """Figure and table of all matches; ``None`` where the run was held against nothing."""
    against = runs.run_record(run).against
    if not against or not against.matches:
        return None
    return Part(
        "Against measurement",
        "measurement",
        answer=sentences(run),
        notices=(against.caution,) if against.caution else (),
        figures=measurement_figures.measured_figures(run),
        facts=_facts(against),
        tables=(of_engines(_COLUMNS, _groups(against.matches), _NOTE),),
    )


def _facts(against: Measurement) -> dict[str, str]:
    """Where the measurement comes from."""
    head = against.head
    facts = {
        "Measurement": f"{head['title']} ({against.file})" if "title" in head else against.file,
        "Source": ", ".join(head[key] for key in ("citation", "url") if key in head),
        "Seen": head.get("seen", ""),
        "Note": head.get("note", ""),
    }
    return {name: text for name, text in facts.items() if text}


def _groups(matches: Sequence[Match]) -> list[Group]:
    """One group of rows for each measured value."""
    by_value = grouped(((match.quantity, match.bounce), match) for match in matches)
    return [
        Group(
            f"{runs.measure_words(quantity)}, event {event}{runs.unit_words(rows[0].unit)}",
            tuple(map(_row, rows)),
            _measured(rows[0]),
        )
        for (quantity, event), rows in by_value.items()
    ]


def _measured(match: Match) -> str:
    if match.low is None or match.high is None:
        return f"measured {numbers.with_u(match.measured, match.u_measured)}"
    return f"stated limits {numbers.plain(match.low)} … {numbers.plain(match.high)}"


def _row(match: Match) -> tuple[str, ...]:
    lost = ": there is no such event in the engine" if match.value is None else ""
    return (
        match.source,
        runs.mode_words(match.contact),
        numbers.with_u(match.value, match.scatter, scale=match.measured),
        numbers.plain(match.e_n, 2),
        f"{_INSIDE[match.inside]}{lost}",
    )


def sentences(run: Run) -> tuple[str, ...]:
    """Which engines agree with what was measured, one sentence for each contact level."""
    return tuple(_sentence(run, mode) for mode in runs.modes(run))


def _sentence(run: Run, mode: str) -> str:
    """Which engines agree with every measured value."""
    matches = [m for m in measurement_figures.matches_of(run) if m.contact == mode]
    return f"{capital(runs.mode_title(mode))}: {agreement(matches)}"


def agreement(matches: Sequence[Match]) -> str:
    """Which engines of one contact level agree with every measured value, in a sentence or two."""
    inside = grouped((match.source, match.inside) for match in matches)
    good = [name for name, own in inside.items() if all(own)]
    unknown = [name for name, own in inside.items() if None in own and False not in own]
    if len(unknown) == len(inside):
        return "it cannot be told whether the engines agree with the measurement."
    words = f"{_agree(good, list(inside))} with the measurement."
    return f"{words} It cannot be told for {joined(unknown)}." if unknown else words


def _agree(good: Sequence[str], every: Sequence[str]) -> str:
    if good:
        return f"{engines(good, every)} {'agrees' if len(good) == 1 else 'agree'}"
    return f"{every[0]} does not agree" if len(every) == 1 else f"no {noun(every)[:-1]} agrees"
