"""The one table of a validation that a terminal shows: how far each engine is off."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.validation import answer_gap, answer_values, phrases
from simcompare.results.records.validation import Validation, WaveformRecord

#: quantities of more than so many are told for all engines together
_MANY = 2


def summary(validation: Validation) -> Table | None:
    """The gap of each engine in each judged quantity, and how many values agree.

    Args:
        validation: the record of the validation.
    """
    probes = list(dict.fromkeys(row.probe for row in validation.waveforms if row.judged))
    if not probes:
        return _of_events(validation)
    fitted = validation.fit is not None
    columns = [Column("Engine", text=True), Column("Off by (RMS)")]
    columns += [Column("Before the fit")] if fitted else []
    columns += [Column("Largest")]
    scores = answer_values.scores(validation)
    columns += [Column("Values that agree")] if scores and len(probes) <= _MANY else []
    groups = []
    for probe in probes:
        rows = answer_gap.judged_rows(validation, probe)
        engines = phrases.engines_of(rows)
        names: dict[str, Sequence[str]] = {name: [name] for name in engines}
        if len(probes) > _MANY:
            names = {phrases.whose(engines, engines): engines}
        cells = tuple(
            (name, *_gap(validation, [r for r in rows if r.source in of]), *_agreeing(scores, of))
            for name, of in names.items()
        )
        cells = tuple(row[: len(columns)] for row in cells)
        groups.append(Group(phrases.first_up(phrases.label(validation, probe)), cells))
    return Table("", tuple(columns), tuple(groups), engines=len(probes) <= _MANY)


def _gap(validation: Validation, rows: Sequence[WaveformRecord]) -> list[str]:
    unit = rows[0].unit
    cells = [phrases.size_span([row.rmse for row in rows], unit)]
    if validation.fit is not None:
        sources = {row.source for row in rows}
        before = [r for r in answer_gap.before_the_fit(validation, rows) if r.source in sources]
        cells.append(phrases.size_span([r.rmse for r in before], unit) if before else "–")
    return [*cells, phrases.human(max(row.max_abs for row in rows), unit)]


def _agreeing(scores: Sequence[answer_values.Judged], engines: Sequence[str]) -> list[str]:
    own = [score for score in scores if score.source in engines]
    if not own:
        return ["–"] if scores else []
    good, count = answer_values.within(own)
    return [f"{good} of {count}"]


def _of_events(validation: Validation) -> Table | None:
    """How many events belong together, where nothing else was compared."""
    rows = tuple(
        (row.source, phrases.spaced(row.stream), f"{row.matched} of {row.matched + row.missed}",
         str(row.extra), "–" if row.rmse_s is None else phrases.human(row.rmse_s, "s"))
        for row in validation.timings
    )  # fmt: skip
    columns = (Column("Engine", text=True), Column("Segment", text=True),
               Column("Events with a partner"), Column("Not measured"),
               Column("Apart (RMS)"))  # fmt: skip
    return Table("", columns, (Group("", rows),)) if rows else None


def words(validation: Validation) -> tuple[str, ...]:
    """Words of the table that a legend explains.

    Args:
        validation: the record of the validation.
    """
    return ("RMS", "E_n") if answer_values.scores(validation) else ("RMS",)
