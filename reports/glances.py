"""What a run, fit or validation shows of itself at one glance; its tables and figures by name."""

from __future__ import annotations

from collections.abc import Iterator

from simcompare import glossary
from simcompare.errors import UnknownName
from simcompare.reports import builder
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.glance import Glance
from simcompare.reports.render.parts import Part
from simcompare.reports.render.tables import Table
from simcompare.reports.run import lead_table, runs, settings
from simcompare.reports.run.listing import grouped, joined
from simcompare.reports.run.not_run import not_run
from simcompare.reports.sections import of_run
from simcompare.reports.sections.measurement import measurement
from simcompare.reports.sensing import words
from simcompare.results.records.run import RunRecord
from simcompare.results.run import Run

_MORE = "More: .table(), .plot(), .scores, .samples(engine, level), .report()"


def glance_of(run: Run) -> Glance:
    """The answer, the table of what leads, what did not run, and the first figure."""
    record, part = run.record, _answer(run)
    found = _table(run, part)
    return Glance(
        title=f"{record.title} – {record.kind}",
        question=record.question,
        settings=settings.settings(run),
        sentences=part.short or part.answer[:1],
        legend=_legend(run, found),
        table=found,
        notes=tuple(_notes(run)),
        figure=next(iter(part.every_figure), None),
        more=_more(run),
    )


def _more(run: Run) -> str:
    """What else a run gives in Python, and where it is stored."""
    sensed = ", .sensors, .readings(signal, engine)" if run.stored_readings else ""
    stored = "" if run.folder is None else f". Stored in {run.folder}"
    return f"{_MORE}{sensed}{stored}"


def _notes(run: Run) -> Iterator[str]:
    """How it stands against a measurement, and what did not run, where and why."""
    if isinstance(run.record, RunRecord):
        against = measurement(run)
        yield from () if against is None else (*against.answer, *against.notices)
        yield from (f"Caution: {caution}" for caution in run.record.cautions)
        if run.record.sensing is not None:
            yield from words.lines(run.record.sensing)
    every = [runs.mode_words(mode) for mode in runs.modes(run)]
    rows = [(row.name, row.modes, row.reason) for row in not_run(run)]
    for (modes, reason), names in grouped(((m, why), name) for name, m, why in rows).items():
        where = "" if modes == ", ".join(every) else f" ({modes})"
        yield f"{joined(list(names))}{where} did not run: {reason}"
    if run.record.interrupted:
        yield "Interrupted: what had finished is kept."


def table(run: Run, measure: str | None = None) -> Table:
    """The table of what leads, or of another measure.

    Raises:
        UnknownName: it was not measured; names what was.
    """
    if measure is None:
        found = _table(run, _answer(run))
    else:
        measured = runs.measures(run)
        if measure not in measured:
            raise UnknownName("measure of this run", measure, measured)
        found = lead_table.lead_table(run, measure)
    return found or Table("Nothing was measured.", (), ())


def figure(run: Run, name: str | None = None) -> Figure:
    """The figure that leads, or another one by its name; of a probe its own name is enough.

    Raises:
        UnknownName: there is none of that name; names those that there are.
    """
    leading = None if name is not None else next(iter(_answer(run).every_figure), None)
    if leading is not None:
        return leading
    known = _figures(run)
    if name not in known:
        raise UnknownName("figure of this run", str(name or "answer"), known)
    return known[name]


def _answer(run: Run) -> Part:
    """The first section of the report."""
    part = of_run(run.record)[0](run)
    assert part is not None
    return part


def _table(run: Run, part: Part) -> Table | None:
    if run.record.kind == "run":
        return lead_table.lead_table(run)
    return next(iter(part.every_table), None)


def _legend(run: Run, shown: Table | None) -> tuple[str, ...]:
    """What the words of the table mean."""
    if shown is None or run.record.kind != "run":
        return ()
    return glossary.legend(lead_table.legend_words([shown]))


def _figures(run: Run) -> dict[str, Figure]:
    """Every figure of the report by its name."""
    (block,) = builder.blocks_of([run])
    names = {one.name: one for one in block.figures}
    # a probe that leads is drawn twice, and the whole of it comes later
    return {_short(name): one for name, one in names.items()}


def _short(name: str) -> str:
    """The name of a figure; of what a probe sees, that of the probe."""
    return name.removeprefix("probe-").removeprefix("motion-")
