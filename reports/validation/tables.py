"""Tables of a validation: rows of the record grouped so that they are short."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from simcompare import units
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Scale, Table, of_engines, scale_of
from simcompare.reports.run import runs
from simcompare.reports.validation import phrases, validations
from simcompare.reports.validation.gap_figures import part_words
from simcompare.results.records.validation import (
    KNOWN,
    AgreementRecord,
    GapRecord,
    ValueRecord,
    WaveformRecord,
)
from simcompare.results.run import Run

R = TypeVar("R", GapRecord, ValueRecord, WaveformRecord)


def _grouped(rows: Sequence[R], second: Callable[[R], str]) -> Iterator[tuple[str, str, list[R]]]:
    """Stream, the second name, and their rows."""
    for stream, other in dict.fromkeys((row.stream, second(row)) for row in rows):
        group = [row for row in rows if (row.stream, second(row)) == (stream, other)]
        yield stream, other, group


def percent(share: float | None, digits: int = 1) -> str:
    """A share of 1 in per cent, with always the same number of decimals."""
    return Scale(0, digits).text(None if share is None else 100 * share)


def waveforms(run: Run) -> Table:
    """How far each engine is from each judged signal."""
    rows = [row for row in validations.validation(run).waveforms if row.judged]
    fitted = validations.is_fitted(run)
    aligned = any(row.aligned for row in rows)
    groups = []
    for stream, probe, group in _grouped(rows, lambda row: row.probe):
        scale = scale_of(row.rmse for row in group)
        groups.append(
            Group(
                validations.titled(run, stream, validations.label(run, probe))
                + scale.unit(validations.unit(run, probe)),
                tuple(_waveform(run, group, e, scale) for e in _sources(group)),
            )
        )
    still = [phrases.is_constant(validations.validation(run), row) for row in rows]
    columns = [Column("RMS error")]
    columns += [Column("before the fit")] if fitted else []
    columns += [Column("clock as recorded", spare=True)] if aligned else []
    columns += [
        Column("Bias", spare=True), Column("Largest"), Column("RMS ÷ range (%)"),
        Column("Magnitude (%)", spare=True), Column("Phase (%)", spare=True),
        Column("Samples", spare=True),
    ]  # fmt: skip
    table = of_engines(columns, groups, _waveform_note(fitted=fitted, aligned=aligned, still=still))
    return table.without(_OF_RANGE) if all(still) else table


#: columns that have no meaning where the measurement does not vary
_OF_RANGE = ("RMS ÷ range (%)", "Magnitude (%)", "Phase (%)")


def _waveform_note(*, fitted: bool, aligned: bool, still: Sequence[bool]) -> str:
    note = "Error is simulated minus measured."
    if not all(still):
        note += (
            " Magnitude: how much too large the simulation is. Phase: how far it is out of step"
            " (Sprague and Geers); 0 is right."
        )
    if any(still):
        note += " A signal that spans no more than its noise has no share of its range."
    if fitted:
        note += " All but “before the fit” are with the fitted parameters."
    if aligned:
        note += " All but “clock as recorded” are with aligned clocks."
    return note


def _sources(rows: Sequence[WaveformRecord]) -> list[str]:
    return list(dict.fromkeys(row.source for row in rows))


def _waveform(
    run: Run, rows: Sequence[WaveformRecord], engine: str, scale: Scale
) -> tuple[str, ...]:
    of_engine = [row for row in rows if row.source == engine]
    is_aligned = any(row.aligned for row in of_engine)

    def one(parameters: str, aligned: bool) -> WaveformRecord | None:
        for row in of_engine:
            if row.parameters == parameters and row.aligned == aligned:
                return row
        return None

    last = validations.last_parameters(run)
    main = one(last, is_aligned)
    assert main is not None
    cells = [engine, scale.text(main.rmse)]
    if validations.is_fitted(run):
        before = one(KNOWN, is_aligned)
        cells.append(scale.text(None if before is None else before.rmse))
    if any(row.aligned for row in validations.validation(run).waveforms if row.judged):
        raw = one(last, aligned=False)
        cells.append(scale.text(None if raw is None else raw.rmse))
    still = phrases.is_constant(validations.validation(run), main)
    shares = (None, None, None) if still else (main.nrmse, main.magnitude, main.phase)
    cells += [scale.text(main.bias), scale.text(main.max_abs)]
    return (*cells, *(percent(share, 2) for share in shares), str(main.n))


def gaps(run: Run) -> list[Table]:
    """What the gap is made of: root mean squares, and how the shares add up."""
    rows = validations.validation(run).gaps
    return [_gap_sizes(run, rows), _gap_shares(run, rows)] if rows else []


def _gap_sizes(run: Run, rows: Sequence[GapRecord]) -> Table:
    fitted = validations.is_fitted(run)
    columns = [Column("Gap before the fit"), Column("after it")] if fitted else [Column("Gap")]
    columns += [Column(phrases.first_up(part_words(run, "model_form", "model form")))]
    columns += [Column("95 % interval", spare=True), Column("Numerical"), Column("Noise")]
    columns += [Column("Fit took away (%)")] if fitted else []
    covered = any(row.covered is not None for row in rows)
    columns += [Column("Covered (%)", spare=True)] if covered else []
    groups = []
    for stream, probe, group in _grouped(rows, lambda row: row.probe):
        scale = scale_of(v for row in group for v in (row.total, row.remaining))
        unit = scale.unit(validations.unit(run, probe))
        groups.append(
            Group(
                validations.titled(run, stream, validations.label(run, probe)) + unit,
                tuple(
                    (*_gap(row, scale, fitted=fitted), *_covered(row, wanted=covered))
                    for row in group
                ),
            )
        )
    noises = " and ".join(dict.fromkeys(row.noise_from for row in rows))
    note = (
        "Root mean squares; the squares of model form, numerical error and noise add up to that of"
        f" the gap{' after the fit' if fitted else ''}. Interval: by a moving-block bootstrap."
        f" Noise: {noises}."
    )
    if fitted:
        note += " A negative share: the fitted parameters made the gap larger."
    if covered:
        note += " Covered: samples whose error is within 2 u of all uncertainties together."
    return of_engines(columns, groups, note)


def _gap(row: GapRecord, scale: Scale, *, fitted: bool) -> tuple[str, ...]:
    cells = [row.source, scale.text(row.total)]
    cells += [scale.text(row.remaining)] if fitted else []
    low, high = scale.text(row.model_form_low), scale.text(row.model_form_high)
    cells += [scale.text(row.model_form), f"{low} … {high}"]
    cells += [_small(row.numerical, scale), _small(row.noise, scale)]
    return (*cells, *([percent(row.shares.removed)] if fitted else []))


def _covered(row: GapRecord, *, wanted: bool) -> tuple[str, ...]:
    return (percent(row.covered, 0),) if wanted else ()


def _small(value: float | None, scale: Scale) -> str:
    """A part that may be too small for the scale of the whole, or unknown."""
    if value is None:
        return "–"
    text = scale.text(value)
    if value > 0 and float(text) == 0:
        return f"< {scale.text(10.0 ** (scale.power - scale.places))}"
    return text


#: shares of a gap, and what they are called: together they are the whole
_SHARES = {
    "parameter": "Parameters alone",
    "cross": "Shared with the rest",
    "model_form": "Model form",
    "numerical": "Numerical",
    "noise": "Noise",
    "excess": "Too much noise",
}


def _gap_shares(run: Run, rows: Sequence[GapRecord]) -> Table:
    """How the shares of the squared gap add up to all of it."""
    groups = [
        Group(validations.titled(run, stream, validations.label(run, probe)),
              tuple(_shares(row) for row in group))
        for stream, probe, group in _grouped(rows, lambda row: row.probe)
    ]  # fmt: skip
    note = (
        "Shares of the squared gap. “Shared with the rest” is negative where parameters and the"
        " rest oppose each other; with “Parameters alone” it is what the fit took away. “Too much"
        " noise”: by how much noise and numerical error exceed what is left."
    )
    columns = [Column(heading) for heading in (*_SHARES.values(), "Sum")]
    return of_engines(columns, groups, note, "How the parts add up (%)")._replace(folded=True)


def _shares(row: GapRecord) -> tuple[str, ...]:
    parts = [getattr(row.shares, key) for key in _SHARES]
    return (row.source, *(percent(part, 2) for part in (*parts, sum(parts))))


def values(run: Run) -> Table | None:
    """Single values, simulated and measured."""
    rows = validations.validation(run).values
    if not rows:
        return None
    columns = [
        Column("Simulated ± u"), Column("Error"), Column("u numerical", spare=True),
        Column("u parameters", spare=True), Column("E_n"),
        Column("In words", text=True, nowrap=True),
    ]  # fmt: skip
    groups = []
    for stream, measure, group in _grouped(rows, lambda row: row.measure):
        symbol = units.symbol(group[0].unit)
        unit = "" if symbol == "1" else f" {symbol}"
        measured = numbers.with_u(group[0].measured, group[0].u_data or None)
        power = _thousands(max(abs(v) for row in group for v in (row.error, row.u_val)))
        of_power = f" 10{numbers.raised(power)}{unit}" if power else unit
        words = validations.titled(run, stream, runs.measure_words(measure))
        title = f"{words}: measured {measured}{unit}"
        title += f"; error and u in{of_power}" if of_power else ""
        scales = [_budget_scale(power, column) for column in zip(*map(_sizes, group), strict=True)]
        groups.append(Group(title, tuple(_value(row, scales) for row in group)))
    note = (
        "Standard uncertainties: numerical from two and four times the step (grid convergence"
        " index), parameters from what is known of each, data: the ± of what was measured. E_n is"
        " the error over twice their root sum of squares (ASME V&V 20-2009; ISO 13528:2022, 9.7)."
    )
    return of_engines(columns, groups, note)


def _sizes(row: ValueRecord) -> tuple[float, float | None, float | None]:
    """Columns of a value that are written in one power of ten."""
    return row.error, row.u_num, row.u_input


def _thousands(size: float) -> int:
    """The power of ten, a multiple of 3, of which a size has 1 to 999; 0 for sizes near 1."""
    return 0 if size == 0 or 0.01 <= size < 1e6 else 3 * math.floor(math.log10(size) / 3)


def _budget_scale(power: int, column: Sequence[float | None]) -> Scale:
    """Three digits of the smallest value, but no more than two places of a number up to 999."""
    scale = scale_of(column, 3)
    places = scale.places - scale.power + power
    return Scale(power, min(max(places, 0), 2 if power else 5))


def _value(row: ValueRecord, scales: Sequence[Scale]) -> tuple[str, ...]:
    parts = zip(_sizes(row)[1:], scales[1:], strict=True)
    budget = [scales[0].text(row.error), *(_small(size, scale) for size, scale in parts)]
    return (
        row.source,
        numbers.with_u(row.simulated, row.u_simulated or None),
        *budget,
        "–" if row.e_n is None else Scale(0, 2).text(row.e_n),
        row.words,
    )


def agreement(run: Run) -> Table | None:
    """Whether the engines agree with each other."""
    rows = validations.validation(run).agreement
    if not rows:
        return None
    columns = (Column("Quantity", text=True), Column("Engines"), Column("Birge ratio"),
               Column("Expected"), Column("In words", text=True, nowrap=True))  # fmt: skip
    cells = tuple(
        (
            validations.titled(run, row.stream, runs.measure_words(row.measure)),
            str(len(row.engines)),
            Scale(0, 2).text(row.ratio),
            f"{row.low:.2f} … {row.high:.2f}",
            "within their step errors" if row.consistent else "beyond their step errors",
        )
        for row in rows
    )
    title = "Do the engines agree with each other?"
    return Table(title, columns, (Group("", cells),), _left_out(rows))


def _left_out(rows: Sequence[AgreementRecord]) -> str:
    """Engines whose own step error is not known."""
    names = dict.fromkeys(name for row in rows for name in row.left_out)
    if not names:
        return ""
    return f"Left out where no step error is known: {', '.join(names)}."
