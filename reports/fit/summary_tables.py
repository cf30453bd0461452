"""The two tables of a fit that a terminal shows: what was found, and what engines must be given."""

from __future__ import annotations

from simcompare.notation import number
from simcompare.reports.fit import fits, tables, tosses
from simcompare.reports.fit.fits import CLOSED
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.results.records.fit_bounces import BouncesFit
from simcompare.results.records.fit_tosses import TossFit
from simcompare.results.run import Run

#: what is above the table of a report
_FOUND = "What was found, assumed and given"
#: significant digits of a number that is typed in; more than its uncertainty knows
_DIGITS = 7


def found(run: Run) -> Table | None:
    """Every parameter with its interval, and where it comes from; ``None`` for tosses."""
    record = fits.of_any(run)
    if isinstance(record, TossFit):
        return None
    if isinstance(record, BouncesFit):
        rows = _of_bounces(record)
    else:
        closed = record.closed_form.parameters
        rows = [(fits.title(name), fits.of_95(row, name), "fitted") for name, row in closed.items()]
    columns = (Column("Parameter", text=True), Column("Value ± 95 %"), Column("How", text=True))
    return Table(_FOUND, columns, (Group("", tuple(rows)),))


def _of_bounces(record: BouncesFit) -> list[tuple[str, ...]]:
    form = record.closed_form
    rows: list[tuple[str, ...]] = [
        (fits.titles(record)[name], fits.told_95(record, row, name), fits.how(form, name))
        for name, row in {**form.found, **form.parameters}.items()
    ]  # fmt: skip
    for name, value in form.fixed.items():
        unit = "" if fits.unit(name) == "1" else f" {fits.unit(name)}"
        rows.append((fits.title(name), f"{numbers.plain(value)}{unit}", "given"))
    return rows


def given(run: Run) -> Table | None:
    """What each engine must be given; ``None`` where none could be fitted."""
    record = fits.of_any(run)
    if isinstance(record, TossFit):
        return tosses.engines(record)
    if not isinstance(record, BouncesFit):
        return _given_signals(run)
    if record.is_tuned:
        return _typed(run)
    return tables.engines(run).without(("Simulations", "Time (s)")) if fits.engines(run) else None


def _typed(run: Run) -> Table | None:
    """What is typed into a plain loop, and what the engine then shows."""
    rows = []
    for source in fits.engines(run):
        typed = ", ".join(
            f"{row.name} = {row.value:.{_DIGITS}g}"
            + ("" if row.unit in ("", "1") else f" {row.unit}")
            for row in source.numbers
        )
        first, effective = source.impacts[0], source.effective["restitution"]
        rows.append((source.name, typed or "–", number(first.restitution, first.u_phase),
                     number(effective.value, effective.u)))  # fmt: skip
    step_ms = numbers.plain(1e3 * fits.bounces(run).valid.engine_step_s, 4)
    columns = (
        Column("Engine", text=True), Column(f"Type in (step {step_ms} ms)", text=True),
        Column("First restitution"), Column("Mean of all"),
    )  # fmt: skip
    return Table("", columns, (Group("", tuple(rows)),)) if rows else None


def _given_signals(run: Run) -> Table | None:
    """What each engine needs to move as the recording does."""
    record, sources = fits.signals(run), fits.wave_engines(run)
    if not sources:
        return None
    names = list(record.closed_form.parameters)
    every = ((CLOSED, record.closed_form.parameters), *((s.name, s.parameters) for s in sources))
    rows = tuple(
        (name, *(number(own[key].value, own[key].u) for key in names)) for name, own in every
    )
    columns = (Column("Source", text=True), *(Column(fits.with_unit(name)) for name in names))
    return Table("", columns, (Group("", rows),))
