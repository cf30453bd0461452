"""Figures of what a gap is made of, of single values and of fitted parameters."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from simcompare.model.trajectory import Array
from simcompare.reports.render.figures import Bars, Figure, Panel, Series, Span, spread
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.run import runs
from simcompare.reports.validation import answer_values, phrases, validations
from simcompare.results.records.validation import (
    CalibrationRecord,
    GapRecord,
    ParameterRecord,
    ValueRecord,
)
from simcompare.results.run import Run

R = TypeVar("R", GapRecord, ValueRecord)
#: parts of a gap: key of the record, words, colour (Okabe and Ito), hatch
PARTS = (
    ("removed", "parameters", "#0072B2", "/"),
    ("model_form", "model form", "#D55E00", "x"),
    ("numerical", "numerical error", "#009E73", "."),
    ("noise", "noise of the measurement", "#7F7F7F", ""),
)
#: what the second part is where nothing was fitted
UNFITTED = "model form or parameters"
#: a part shorter than this share of the longest bar has no room for its number
_ROOM = 0.08
#: E_n beyond this is drawn at the edge: how many times it is 1 no longer matters
_FAR = 10.0
#: lying bars need the width of half a page
_PANELS = 2
#: rows that a figure of usual height holds
_ROWS, _POINT_ROWS = 10, 7
_FITTED, _ALONE = Style("#0072B2"), Style("#000000", marker="diamond", hollow=True)


def gap_figures(run: Run) -> list[Figure]:
    """How large the gap of each engine is and what it is made of."""
    rows = [row for row in validations.validation(run).gaps if row.total > 0]
    panels = [
        _gap_panel(run, probe, of_probe)
        for probe in validations.judged_probes(run)
        if (of_probe := [row for row in rows if row.probe == probe])
    ]
    parts = [panels[i : i + _PANELS] for i in range(0, len(panels), _PANELS)]
    figures = [_gap_figure(run, number, tuple(part)) for number, part in enumerate(parts, start=1)]
    if len(figures) == 1:
        return figures
    return [
        replace(figure, title=f"{figure.title} ({number} of {len(figures)})")
        for number, figure in enumerate(figures, start=1)
    ]


def _gap_figure(run: Run, number: int, panels: tuple[Panel, ...]) -> Figure:
    height = _height(max(len(panel.y_ticks or ()) for panel in panels) / _ROWS)
    name = "gap" if number == 1 else f"gap-{number}"
    caption = _gap_caption(run) if number == 1 else "The same for the other quantities."
    return Figure(name, "What the gap is made of", caption, panels, height=height)


def _height(share: float) -> float:
    return float(np.clip(round(share, 2), 0.7, 3.0))


def part_words(run: Run, key: str, words: str) -> str:
    """A part of the gap in words; without a fit, parameters cannot be told from the model."""
    return UNFITTED if key == "model_form" and not validations.is_fitted(run) else words


def _gap_panel(run: Run, probe: str, rows: Sequence[GapRecord]) -> Panel:
    places = by_segment(rows, lambda row: row.source)
    ticks = [tick for tick, _ in places]
    longest = max(row.total for row in rows)
    layers = []
    for key, words, colour, hatch in PARTS:
        if key == "removed" and not validations.is_fitted(run):
            continue
        shares = np.array([0.0 if row is None else _drawn(row)[key] for _, row in places])
        lengths = shares * np.array([0.0 if row is None else row.total for _, row in places])
        texts = tuple(
            f"{100 * share:.0f} %" if length > _ROOM * longest else ""
            for share, length in zip(shares, lengths, strict=True)
        )
        layers.append(Bars(part_words(run, key, words), lengths, colour, hatch, texts))
    unit = runs.unit_words(validations.unit(run, probe))
    before = " before the fit" if validations.is_fitted(run) else ""
    return Panel(validations.label(run, probe), f"gap{before}, root mean square{unit}", "", (),
                 bars=tuple(layers), y_ticks=tuple(ticks))  # fmt: skip


def by_segment(rows: Sequence[R], name: Callable[[R], str]) -> list[tuple[str, R | None]]:
    """Names and rows for an axis: under the name of each segment, as a row of its own, its rows."""
    streams = list(dict.fromkeys(row.stream for row in rows))
    places: list[tuple[str, R | None]] = []
    for stream in streams:
        if len(streams) > 1:
            places.append((f"{validations.short(stream)}:", None))
        places += [(name(row), row) for row in rows if row.stream == stream]
    return places


def _drawn(row: GapRecord) -> dict[str, float]:
    """Shares that a bar can show: negative ones are nothing, and the others fill it."""
    shares = {key: max(getattr(row.shares, key), 0.0) for key, *_ in PARTS}
    total = sum(shares.values()) or 1.0
    return {key: share / total for key, share in shares.items()}


def _gap_caption(run: Run) -> str:
    before = "the simulation with the parameters known before" if validations.is_fitted(run) else (
        "the simulation"
    )  # fmt: skip
    text = [f"Length: how far {before} is from the measurement. Colours: shares (mean square)."]
    if validations.is_fitted(run):
        text.append(
            "Parameters: what fitting them took away. Model form: what is left beside noise and"
            " numerical error."
        )
    else:
        text.append("Nothing was fitted, so wrong parameters look like a wrong model.")
    return " ".join([*text, *_worse(run)])


def _worse(run: Run) -> Iterator[str]:
    """What bars cannot show: parts that came out negative."""
    rows = validations.validation(run).gaps
    worse = [row for row in rows if row.shares.removed < -0.005]
    if worse:
        places = dict.fromkeys(
            row.source
            + (f" on {where}" if (where := validations.segment_name(run, row.stream)) else "")
            for row in worse
        )
        most = max(-row.shares.removed for row in worse)
        yield (
            f"For {phrases.listed(list(places))} the fitted parameters made the mean square larger,"
            f" by up to {100 * most:.0f} %; no bar can show that."
        )
    if any(row.clipped for row in rows):
        yield "No model form is drawn where noise and numerical error exceed what is left."


def e_n_figure(run: Run) -> Figure | None:
    """E_n of every single value, engines beside each other."""
    rows = answer_values.judged(validations.validation(run).values)
    if not rows:
        return None
    one_each = list({(row.stream, row.measure): row for row in rows}.values())
    places = by_segment(one_each, lambda row: row.measure)
    index = {(row.stream, row.measure): i for i, (_, row) in enumerate(places) if row}
    engines = list(dict.fromkeys(row.source for row in rows))
    series = []
    for i, engine in enumerate(engines):
        of_engine = [row for row in rows if row.source == engine]
        x = np.clip([row.e_n or 0.0 for row in of_engine], -_FAR, _FAR)
        shift = spread(i, len(engines), 0.7)
        y = np.array([index[row.stream, row.measure] + shift for row in of_engine])
        series.append(Series(engine, x, y, style_of(engine), points=True, line=False))
    reach = max(1.6, *(1.1 * float(np.abs(one.x).max()) for one in series))
    panel = Panel(
        "", "E_n = error ÷ (2 × standard uncertainty of the error)", "", tuple(series),
        spans=(Span(-1.0, 1.0, "within the uncertainty"), Span(0.0, 0.0)),
        y_ticks=tuple(runs.measure_words(tick) for tick, _ in places), x_limits=(-reach, reach),
    )  # fmt: skip
    caption = (
        "Error is simulated minus measured. Between −1 and 1 it may be chance; but large"
        " uncertainties hide large errors."
    )
    if any(abs(row.e_n or 0.0) > _FAR for row in rows):
        caption += f" Values beyond ±{_FAR:g} are drawn at the edge; the table has them."
    return Figure(
        "e-n", "Single values beside their uncertainty", caption, (panel,),
        height=_height(len(places) / _POINT_ROWS),
    )  # fmt: skip


def parameter_figure(run: Run) -> Figure | None:
    """How far the fit moved each parameter, and how single segments scatter about it."""
    fit = validations.validation(run).fit
    if fit is None:
        return None
    rows = {row.name: row for row in validations.validation(run).parameters}
    names = [name for name in fit.names if name in rows]
    ticks = tuple(phrases.parameter(name) for name in names)
    panels = [*_moved(names, rows, ticks), *_scatter(fit, names, rows, ticks)]
    if not panels:
        return None
    caption = "Each parameter in units of a standard uncertainty."
    if any(panel.title == _MOVED for panel in panels):
        caption += (
            " A fitted value far outside of what was known is a warning: the model may lack"
            " something."
        )
    if any(panel.title == _SINGLE for panel in panels):
        caption += " Segments that disagree by more than the band say the same."
    return Figure("parameters", "Fitted parameters", caption, tuple(panels), share_y=True)


_MOVED, _SINGLE = "fitted beside what was known", "each segment fitted alone"
_ONE_BAND = Span(-2.0, 2.0, "± 2u")


def _moved(
    names: Sequence[str], rows: Mapping[str, ParameterRecord], ticks: tuple[str, ...]
) -> Iterator[Panel]:
    known = [
        (i, (row.fitted - row.known) / row.u_known, 2 * (row.u_fitted or 0.0) / row.u_known)
        for i, name in enumerate(names)
        if (row := rows[name]).u_known and row.known is not None and row.fitted is not None
    ]
    if not known:
        return
    y, x, u = (np.array(column, dtype=float) for column in zip(*known, strict=True))
    fitted = Series("fitted ± 2u", x, y, _FITTED, u, points=True, line=False)
    yield Panel(_MOVED, "(fitted − known) ÷ u of what was known", "", (fitted,),
                spans=(_ONE_BAND, Span(0.0, 0.0)), y_ticks=ticks,
                x_limits=_about_zero(x, u))  # fmt: skip


def _scatter(
    fit: CalibrationRecord,
    names: Sequence[str],
    rows: Mapping[str, ParameterRecord],
    ticks: tuple[str, ...],
) -> Iterator[Panel]:
    usable = [i for i, name in enumerate(names) if rows[name].u_fitted]
    if not fit.single or not usable:
        return
    x, y = [], []
    for number, values in enumerate(fit.single.values()):
        for i in usable:
            row = rows[names[i]]
            moved = values[fit.names.index(names[i])] - (row.fitted or 0.0)
            x.append(moved / (row.u_fitted or 1.0))
            y.append(i + spread(number, len(fit.single)))
    single = Series("one segment alone", np.array(x), np.array(y), _ALONE, points=True, line=False)
    yield Panel(_SINGLE, "(alone − together) ÷ u of the fit", "", (single,),
                spans=(_ONE_BAND, Span(0.0, 0.0)), y_ticks=ticks,
                x_limits=_about_zero(np.array(x), np.zeros(len(x))))  # fmt: skip


def _about_zero(x: Array, u: Array) -> tuple[float, float]:
    reach = 1.15 * max(2.2, float(np.max(np.abs(x) + u)))
    return -reach, reach
