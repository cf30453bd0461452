"""Figures of simulations beside a recording over time: overlay and residuals."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.reports.render.figures import Band, Figure, Panel, Series, Span
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.run import runs
from simcompare.reports.validation import validations
from simcompare.reports.validation.cases import Case, case_of
from simcompare.results.run import Run

TIME = "time (s)"
#: up to so many samples in a panel are drawn as dots
_DOTS = 150
#: a step longer than so many usual ones is a gap
_GAP_STEPS = 3.0
#: periods that the zoomed panel shows, and its shortest and longest share of the segment
_PERIODS, _MIN_SHARE, _MAX_SHARE = 2.5, 0.05, 0.35
#: lines at more events than these hide the signal
_MAX_EVENTS = 100
_ENGINE_WIDTH = 1.6
#: second differences above this part of the range are noise that fills the panel
_ROUGH = 0.03
#: letters of a line beside an axis
_AXIS_LETTERS = 30
_MEASURED = Style("#A9A9A9", width=7.0)
_INPUT = Style("#222222", width=1.4)
_BAND = Style("#B08900")
_NOMINAL = Style("#555555", dash="dot", width=2.0)
EVENT, ZOOMED = "event", "enlarged"


def overlay_figures(run: Run, probe: str) -> list[Figure]:
    """The recording with the engines over it: a figure for each segment that is drawn."""
    cases = (case_of(run, probe, *one) for one in validations.drawn_segments(run))
    return [overlay(case, validations.chosen_words(run)) for case in cases if case is not None]


def overlay(case: Case, more: str = "") -> Figure:
    """The recorded input where there is one, the whole segment, and where the gap is largest.

    Args:
        case: what is drawn.
        more: what the caption says besides.
    """
    layers = list(_layers(case))
    zoom = zoom_window(case.measured, case.probe, list(case.residuals.values()))
    events = _events(case)
    spans = (*events, *([Span(*zoom, ZOOMED)] if zoom else []))
    panels = [
        *_input_panels(case),
        Panel("whole segment", TIME, _axis(case), _dotted(layers), spans=spans, weight=1.3),
    ]
    if zoom is not None:
        near = [cut for series in layers for cut in _cut(series, *zoom)]
        inside = tuple(one for one in events if zoom[0] <= one.low <= zoom[1])
        panels.append(
            Panel("largest gap", TIME, _axis(case), _dotted(near), spans=inside, x_limits=zoom)
        )
    title = case.titled(f"{case.label}: measured and simulated")
    name = f"overlay-{case.probe}-{case.number + 1}"
    return Figure(name, title, _overlay_caption(case) + more, tuple(panels))


def _input_panels(case: Case) -> list[Panel]:
    """The recorded input that drives the engines, the first of several."""
    return [
        Panel("recorded input", TIME, label,
              (Series("recorded input", *with_gaps(one.time_s, values), _INPUT),), weight=0.8)
        for one in case.inputs[:1] for label, values in one.signals.items()
    ]  # fmt: skip


def _axis(case: Case) -> str:
    """A quantity with its unit, broken where it is longer than the axis."""
    words = case.label + runs.unit_words(case.scale[1])
    return "\n".join(textwrap.wrap(words, _AXIS_LETTERS))


def _overlay_caption(case: Case) -> str:
    parts = ["Grey: measured. Thin lines: the engines, which often hide each other."]
    if case.truth is not None:
        parts.append(f"Shaded: the {TRUTH} with the uncertainty of its parameters (2 u).")
    if case.nominal is not None:
        parts.append(f"Dotted: the {TRUTH} before the fit.")
    return " ".join([*parts, *filter(None, (case.lacking, _event_words(case)))])


def _layers(case: Case) -> Iterator[Series]:
    """Everything that is drawn of a segment, the lowest layer first."""
    factor, probe = case.scale[0], case.probe
    if case.truth is not None:
        u = case.truth.signals.get(f"u({probe})")
        yield Series(
            f"{TRUTH} ± 2u", case.truth.time_s, factor * case.truth.signals[probe], _BAND,
            None if u is None else 2 * factor * u, shaded=u is not None, line=u is None,
        )  # fmt: skip
    times, values = with_gaps(case.measured.time_s, factor * case.values)
    yield Series(validations.MEASURED, times, values, _measured_style(values))
    if case.nominal is not None:
        from simcompare.results.records.validation import KNOWN

        nominal = factor * case.nominal.signals[probe]
        yield Series(KNOWN, case.nominal.time_s, nominal, _NOMINAL)
    for name, one in case.engines.items():
        yield Series(name, one.time_s, factor * one.signals[probe], _thin(name))


def _measured_style(values: Array) -> Style:
    """Thick, so that it is seen below the engines; thin where its noise would fill the panel."""
    known = values[np.isfinite(values)]
    if len(known) < 3:
        return _MEASURED
    rough = float(np.median(np.abs(np.diff(known, 2)))) > _ROUGH * float(np.ptp(known))
    return replace(_MEASURED, width=_ENGINE_WIDTH) if rough else _MEASURED


def _thin(engine: str) -> Style:
    return replace(style_of(engine), width=_ENGINE_WIDTH)


def _dotted(rows: Sequence[Series]) -> tuple[Series, ...]:
    """The same with few measured samples as dots, so that it is seen where there are any."""
    return tuple(
        replace(row, points=True)
        if row.label == validations.MEASURED and len(row.x) <= _DOTS
        else row
        for row in rows
    )


def _cut(series: Series, low: float, high: float) -> Iterator[Series]:
    """The part of a line within a range, with one sample more at either side."""
    inside = np.flatnonzero((series.x >= low) & (series.x <= high))
    if not len(inside):
        return
    part = slice(max(inside[0] - 1, 0), inside[-1] + 2)
    u = None if series.u is None else series.u[part]
    yield replace(series, x=series.x[part], y=series.y[part], u=u)


def with_gaps(time_s: Array, values: Array) -> tuple[Array, Array]:
    """The same with a NaN wherever samples are missing, so that no line runs across."""
    if len(time_s) < 3:
        return time_s, values
    steps = np.diff(time_s)
    wide = np.flatnonzero(steps > _GAP_STEPS * np.median(steps))
    return np.insert(time_s, wide + 1, time_s[wide]), np.insert(values, wide + 1, np.nan)


def zoom_window(
    measured: Trajectory, probe: str, residuals: Sequence[Array]
) -> tuple[float, float] | None:
    """The few periods in which engines and measurement are furthest apart.

    Args:
        measured: what was measured.
        probe: which quantity of it.
        residuals: simulated minus measured of each engine, at the samples of ``measured``.
    """
    times, values = measured.time_s, measured.signals[probe]
    if len(times) < 20 or not residuals:
        return None
    length = float(times[-1] - times[0])
    centred = values - np.nanmean(values)
    crossings = int(np.count_nonzero(np.diff(np.signbit(centred))))
    period = 2 * length / crossings if crossings >= 6 else length / 10
    width = float(np.clip(_PERIODS * period, _MIN_SHARE * length, _MAX_SHARE * length))
    squares = np.nanmax(np.nan_to_num(np.square(residuals)), axis=0)
    total = np.concatenate(([0.0], np.cumsum(squares)))
    starts = np.linspace(times[0], times[-1] - width, 200)
    begin, end = np.searchsorted(times, starts), np.searchsorted(times, starts + width)
    means = (total[end] - total[begin]) / np.maximum(end - begin, 1)
    best = float(starts[np.argmax(means)])
    return best, best + width


def residual_figure(run: Run, probe: str) -> Figure | None:
    """Simulated minus measured over time, one panel for each segment that is drawn."""
    every = (case_of(run, probe, *one) for one in validations.drawn_segments(run))
    cases = [case for case in every if case is not None and case.engines]
    if not cases:
        return None
    caption = (
        "Grey band: noise of one sample (2 u). Shaded: the same with the uncertainty of the"
        " parameters. A pattern that all engines share is no error of an engine: it comes from the"
        " model or from the measurement."
    )
    events = "".join(dict.fromkeys(f" {words}" for case in cases if (words := _event_words(case))))
    return Figure(
        f"residual-{probe}", f"{validations.label(run, probe)}: what is left",
        caption + events + validations.chosen_words(run), tuple(map(residual_panel, cases)),
    )  # fmt: skip


def residual_panel(case: Case) -> Panel:
    """Simulated minus measured of one segment, in a unit that a person uses."""
    factor, unit = case.small_scale
    times = case.measured.time_s
    lines = [Series(e, *with_gaps(times, factor * y), _thin(e)) for e, y in case.residuals.items()]
    u = factor * case.u
    reach = 1.1 * max(factor * case.largest, 2.5 * u) or 1.0
    bands = (Band(-2 * u, 2 * u, "noise of a sample ± 2u", 0.0),) if u else ()
    return Panel(
        case.name, TIME, f"simulated − measured{runs.unit_words(unit)}",
        (*_explained(case, factor), *lines), bands, spans=_events(case), y_range=(-reach, reach),
    )  # fmt: skip


def _explained(case: Case, factor: float) -> Iterator[Series]:
    """Twice what noise and parameters together leave open, about zero."""
    u_input = None if case.truth is None else case.truth.signals.get(f"u({case.probe})")
    if case.truth is not None and u_input is not None:
        both = 2 * factor * np.hypot(u_input, case.u)
        yield Series(
            "noise and parameters ± 2u", case.truth.time_s, np.zeros(len(both)), _BAND, both,
            shaded=True, line=False,
        )  # fmt: skip


def _events(case: Case) -> tuple[Span, ...]:
    return tuple(Span(time, time, EVENT) for time in case.events[:_MAX_EVENTS])


def _event_words(case: Case) -> str:
    count = len(case.events)
    if not count:
        return ""
    first = f" (the first {_MAX_EVENTS} of {count})" if count > _MAX_EVENTS else ""
    return f"Dashed upright lines: events of the recording{first}."
