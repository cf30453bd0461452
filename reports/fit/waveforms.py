"""Figures and tables of a fit to signals over time."""

from __future__ import annotations

from collections.abc import Sequence

from simcompare.reports.fit import fits
from simcompare.reports.render import numbers
from simcompare.reports.render.figures import Figure
from simcompare.reports.render.tables import Column, Group, Table
from simcompare.reports.validation import phrases, validations, waveforms
from simcompare.reports.validation.cases import Case, inputs_of, lacking_words
from simcompare.results.records.fit_waveforms import JudgedValue
from simcompare.results.run import Run

#: how fitted engines are stored, and how many segments are drawn beside each other
FITTED, MAX_DRAWN = "fitted", 3


def measured_figures(run: Run) -> list[Figure]:
    """The recording with the fitted engines over it: the first segment, and one held out."""
    found = fits.signals(run)
    numbers_ = [0, *([len(found.measured)] if found.held_out else [])]
    cases = [_case(run, found.probes[0], number) for number in numbers_]
    return [waveforms.overlay(case) for case in cases if case is not None]


def residual_figures(run: Run) -> list[Figure]:
    """Simulated minus measured over time: the fitted segments, and those that were held out."""
    found = fits.signals(run)
    count = len(found.measured)
    total = count + len(found.held_out)
    kinds = (("fitted", range(count)), ("held out", range(count, total)))
    figures = []
    for probe in found.probes:
        for kind, numbers_ in kinds:
            every = (_case(run, probe, i) for i in list(numbers_)[:MAX_DRAWN])
            cases = [case for case in every if case is not None and case.engines]
            if cases:
                figures.append(_figure(run, probe, kind, cases))
    return figures


def _figure(run: Run, probe: str, kind: str, cases: Sequence[Case]) -> Figure:
    caption = (
        "Grey band: noise of one sample (2 u). A pattern that all engines share is no error of an"
        " engine: it comes from the model or from the measurement."
    )
    title = f"{_label(run, probe)}: what is left of the segments that were {kind}"
    panels = tuple(map(waveforms.residual_panel, cases))
    return Figure(f"left-{probe}-{kind.replace(' ', '-')}", title, caption, panels)


def _case(run: Run, probe: str, number: int) -> Case | None:
    """One segment as it is drawn; ``None`` where the quantity was not measured in it."""
    measured = validations.stored(run, "measured", "", number)
    if measured is None or probe not in measured.signals:
        return None
    found = fits.signals(run)
    about = [*found.measured, *found.held_out][number]
    shown = {s.name: validations.stored(run, s.name, FITTED, number)
             for s in fits.wave_engines(run)}  # fmt: skip
    own = about.probes[probe]
    return Case(
        number, about.stream, probe, _label(run, probe), str(run.record.probes[probe].unit),
        float(own.u), measured, {name: one for name, one in shown.items() if one is not None},
        inputs=inputs_of(run, number), lacking=lacking_words(own.missing),
    )  # fmt: skip


def parameters(run: Run) -> Table:
    """What was fitted, and what each engine needs to move alike."""
    sources = fits.wave_engines(run)
    rows = []
    for name, row in fits.signals(run).closed_form.parameters.items():
        cells = (fits.of_95(source.parameters[name], name) for source in sources)
        rows.append((phrases.parameter(name), fits.of_95(row, name), *cells))
    columns = [Column("Parameter", text=True, nowrap=True), Column("Fitted ± 95 %")]
    columns += [Column(f"for {source.name}", spare=True) for source in sources]
    note = "An engine's own value makes it move like the recording; it holds for this step alone."
    return Table("", tuple(columns), (Group("", tuple(rows)),), note if sources else "")


def _label(run: Run, probe: str) -> str:
    return str(run.record.probes[probe].label)


def holdout(run: Run) -> Table | None:
    """Values of the segments that were held out, and how well engines predict them."""
    rows = fits.signals(run).holdout.streams
    groups = []
    for segment in rows:
        cells: list[tuple[str, ...]] = []
        for i, value in enumerate(segment.values):
            cells.append((value.measure, "measured", _number(value.measured),
                          _number(value.u_data, 2), "–"))  # fmt: skip
            for engine, own in segment.engines.items():
                cells += _predicted(engine, own.values[i : i + 1])
        groups.append(Group(segment.stream, tuple(cells)))
    if not groups:
        return None
    columns = (Column("Value", text=True), Column("Source", text=True), Column("Found"),
               Column("u"), Column("E_n"))  # fmt: skip
    note = "E_n: the difference over twice its standard uncertainty."
    return Table("Values of the segments that were held out", columns, tuple(groups), note)


def _predicted(engine: str, own: Sequence[JudgedValue]) -> list[tuple[str, ...]]:
    return [
        (row.measure, engine, _number(row.simulated), _number(row.u_val, 2),
         "–" if row.e_n is None else f"{row.e_n:+.2f}".replace("-", "−"))
        for row in own
    ]  # fmt: skip


def _number(value: float | None, digits: int = 5) -> str:
    return "–" if value is None else numbers.plain(value, digits)


def effective(run: Run) -> Table:
    """What each engine shows with its own parameters, in the segments that were fitted."""
    groups = []
    names = dict.fromkeys(n for row in fits.wave_engines(run) for n in row.effective)
    for name in names:
        rows = []
        for source in fits.wave_engines(run):
            row = source.effective.get(name)
            cells = (None, None, None) if row is None else (row.value, row.u, row.measured)
            shown, u, measured = cells
            rows.append((source.name, _number(shown), _number(u, 2), _number(measured)))
        groups.append(Group(fits.with_unit(name), tuple(rows)))
    columns = (Column("Source", text=True), Column("Shown"), Column("u"), Column("Measured"))
    note = "What the reference would need to show the same. Compare engines by this."
    return Table("What engines then show", columns, tuple(groups), note, folded=True)


def valid(run: Run) -> dict[str, str]:
    """Where the fit holds."""
    found = fits.signals(run).valid
    facts = {"step": f"{found.step_s:g} s", "longest segment": f"{found.duration_s:.4g} s"}
    for probe, (low, high) in found.ranges.items():
        unit = run.record.probes[probe].unit
        facts[_label(run, probe)] = f"{low:.4g} to {high:.4g} {unit}"
    return facts
