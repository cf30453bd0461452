"""Estimations as tables: a row a source, a column a way; and a row a state for each source."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare.notation import capital
from simcompare.reports.estimation import drift, units_of
from simcompare.reports.estimation.words import lead_state, leading, ways_of
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.estimation import Estimation, SourceEstimate

#: below the states: how sure a sensor is of itself leaves out what is the same in all its readings
_ALONE = (
    "Both are rms over all instants and draws. The u of a sensor alone is that of its noise: errors"
    " that are the same in every reading, such as an offset, are not in it."
)


def lead(result: Estimation) -> Table:
    """How far each way is off in the state that leads, and what the test says; or its end."""
    if drift.known(result):
        return drift.table(result)
    state = lead_state(result)
    ways = ways_of(result, state)
    sizes = [_rms(one, way, state) for one in result.done for way in ways]
    factor, unit = units_of.scale(state, sizes)
    best = result.done[0].ways[0]
    columns = [
        Column("Recording" if result.recording else "Engine", text=True),
        *(Column(capital(way)) for way in ways),
        Column("u"),
        Column("NEES" if any(one.nees for one in result.done) else "NIS"),
        Column("Filter", text=True),
    ]
    rows = []
    for one in result.done:
        verdict, stated = leading(one), one.error_of(best, state)
        rows.append(
            (
                one.source,
                *(units_of.text(_rms(one, way, state), factor) for way in ways),
                units_of.text(None if stated is None else stated.u, factor),
                "–" if verdict is None else numbers.plain(verdict.value, 3),
                "–" if verdict is None else verdict.outcome,
            )
        )
    found = Table(
        f"{result.labels[state]}: rms error ({unit})",
        tuple(columns),
        (Group("", tuple(rows)),),
        engines=not result.recording,
    )
    filtered = any(leading(one) is not None for one in result.done)
    return found if filtered else found.without(("NIS", "Filter"))


def _rms(source: SourceEstimate, way: str, state: str) -> float | None:
    found = source.error_of(way, state)
    return None if found is None else found.rms_error


def of_states(result: Estimation) -> Iterator[Table]:
    """For each source every state: error and stated uncertainty of each way."""
    words = [Column("State", text=True), Column("Way", text=True)]
    columns = (*words, Column("rms error"), Column("u"), Column("Unit", text=True))
    for source in result.done:
        rows = []
        for state, label in result.labels.items():
            own = [one for one in source.errors if one.state == state]
            factor, unit = units_of.scale(state, [one.rms_error or one.u for one in own])
            rows += [
                (label, one.way, units_of.text(one.rms_error, factor),
                 units_of.text(one.u, factor), unit)
                for one in own
            ]  # fmt: skip
        yield Table(source.source, columns, (Group("", tuple(rows)),), _ALONE, folded=True)


def of_tests(result: Estimation) -> Table:
    """Every test of consistency."""
    columns = [Column("Engine" if not result.recording else "Recording", text=True)]
    columns += [Column("Test", text=True), Column("Value"), Column("Expected"), Column("Inside")]
    columns += [Column("Outcome", text=True)]
    rows = []
    for one in result.done:
        named = {"NEES": one.nees, "NIS": one.nis}
        named |= {f"whiteness, {r.name}": r.whiteness for r in one.readings}
        for name, found in named.items():
            if found is None:
                continue
            limits = f"{numbers.plain(found.low, 3)} … {numbers.plain(found.high, 3)}"
            inside = "–" if found.inside is None else f"{100 * found.inside:.0f} %"
            row = (one.source, name, numbers.plain(found.value, 3), limits, inside, found.outcome)
            rows.append(row)
    note = "Inside: instants at which the mean over the draws is in the band of that test."
    return Table("Tests of consistency", tuple(columns), (Group("", tuple(rows)),), note)
