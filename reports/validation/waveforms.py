"""Figures of simulations beside a recording over time: overlay and residuals."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from simcompare.model.resampling import interpolated
from simcompare.model.trajectory import TRUTH, Array, Trajectory
from simcompare.reports.render.figures import Band, Figure, Panel, Series, Span
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.render.tables import scale_of
from simcompare.reports.run import runs
from simcompare.reports.validation import validations
from simcompare.results.records.validation import KNOWN
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
_BAND = Style("#B08900")
_NOMINAL = Style("#555555", dash="dot", width=2.0)
EVENT, ZOOMED = "event", "enlarged"


def overlay_figures(run: Run, probe: str) -> list[Figure]:
    """What was measured with the engines over it: a figure for each segment that is drawn."""
    figures = [_overlay(run, probe, case, name) for case, name in validations.drawn_segments(run)]
    return [figure for figure in figures if figure is not None]


def _overlay(run: Run, probe: str, case: int, name: str) -> Figure | None:
    measured = validations.stored(run, validations.MEASURED, "", case)
    if measured is None or probe not in measured.signals:
        return None
    layers = list(_layers(run, probe, case))
    zoom = zoom_window(measured, probe, [row for _, row in _residuals(run, probe, case, measured)])
    events = _events(run, case)
    spans = (*events, *([Span(*zoom, ZOOMED)] if zoom else []))
    panels = [Panel("whole segment", TIME, _axis(run, probe), _dotted(layers), spans=spans)]
    if zoom is not None:
        near = [cut for series in layers for cut in _cut(series, *zoom)]
        scale = scale_of([zoom[1] - zoom[0]], 2)
        inside = tuple(one for one in events if zoom[0] <= one.low <= zoom[1])
        panels.append(
            Panel(
                f"{scale.text(zoom[0])} s to {scale.text(zoom[1])} s, largest gap",
                TIME, _axis(run, probe), _dotted(near), spans=inside, x_limits=zoom,
            )
        )  # fmt: skip
        panels[0] = replace(panels[0], weight=1.3)
    words = f"{validations.label(run, probe)}: measured and simulated"
    title = validations.titled(run, name, words)
    return Figure(f"overlay-{probe}-{case + 1}", title, _overlay_caption(run, case), tuple(panels))


def _axis(run: Run, probe: str) -> str:
    """A quantity with its unit, broken where it is longer than the axis."""
    return "\n".join(textwrap.wrap(validations.with_unit(run, probe), _AXIS_LETTERS))


def _overlay_caption(run: Run, case: int) -> str:
    parts = ["Grey: what was measured. Thin lines: the engines, which often hide each other."]
    if validations.truth(run, validations.BEST, case) is not None:
        parts.append(
            f"Shaded: the {TRUTH} with twice the standard uncertainty that it has from its"
            " parameters."
        )
    if validations.is_fitted(run):
        parts.append(f"Dotted: the {TRUTH} with what was known before any fit.")
    return " ".join(parts) + _event_words(run, case) + validations.chosen_words(run)


def _layers(run: Run, probe: str, case: int) -> Iterator[Series]:
    """Everything that is drawn of a segment, the lowest layer first."""
    truth = validations.truth(run, validations.BEST, case)
    if truth is not None and probe in truth.signals:
        u = truth.signals.get(f"u({probe})")
        yield Series(
            f"{TRUTH} ± 2u", truth.time_s, truth.signals[probe], _BAND,
            None if u is None else 2 * u, shaded=u is not None, line=u is None,
        )  # fmt: skip
    measured = validations.stored(run, validations.MEASURED, "", case)
    if measured is not None:
        times, values = with_gaps(measured.time_s, measured.signals[probe])
        yield Series(validations.MEASURED, times, values, _measured_style(values))
    nominal = validations.truth(run, validations.NOMINAL, case)
    if nominal is not None and probe in nominal.signals and validations.is_fitted(run):
        yield Series(KNOWN, nominal.time_s, nominal.signals[probe], _NOMINAL)
    for name in runs.names(run):
        run_of_engine = validations.stored(run, name, validations.BEST, case)
        if run_of_engine is not None and probe in run_of_engine.signals:
            yield Series(name, run_of_engine.time_s, run_of_engine.signals[probe], _thin(name))


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
    panels = [
        _residual_panel(run, probe, case, name) for case, name in validations.drawn_segments(run)
    ]
    shown = tuple(panel for panel in panels if panel is not None)
    if not shown:
        return None
    caption = (
        "Grey band: noise of a single sample, twice its standard uncertainty. Shaded: the same with"
        " the uncertainty of the parameters; what stays inside of it is explained by what is not"
        " known exactly. A pattern that all engines share is not the error of an engine but of the"
        " model or of the measurement."
    )
    events = "".join(
        dict.fromkeys(_event_words(run, case) for case, _ in validations.drawn_segments(run))
    )
    return Figure(
        f"residual-{probe}", f"{validations.label(run, probe)}: what is left",
        caption + events + validations.chosen_words(run), shown,
    )  # fmt: skip


def _residual_panel(run: Run, probe: str, case: int, name: str) -> Panel | None:
    measured = validations.stored(run, validations.MEASURED, "", case)
    if measured is None or probe not in measured.signals:
        return None
    rows = _residuals(run, probe, case, measured)
    if not rows:
        return None
    u = float(validations.validation(run).cases[case].probes[probe].u)
    lines = tuple(Series(e, *with_gaps(measured.time_s, y), _thin(e)) for e, y in rows)
    largest = max(float(np.nanmax(np.abs(y), initial=0.0)) for _, y in rows)
    reach = 1.1 * max(largest, 2.5 * u) or 1.0
    bands = (Band(-2 * u, 2 * u, "noise of a sample ± 2u", 0.0),) if u else ()
    unit = runs.unit_words(validations.unit(run, probe))
    return Panel(
        validations.segment_name(run, name), TIME, f"simulated − measured{unit}",
        (*_explained(run, probe, case, u), *lines), bands, spans=_events(run, case),
        y_range=(-reach, reach),
    )  # fmt: skip


def _explained(run: Run, probe: str, case: int, u: float) -> Iterator[Series]:
    """Twice what noise and parameters together leave open, about zero."""
    truth = validations.truth(run, validations.BEST, case)
    u_input = None if truth is None else truth.signals.get(f"u({probe})")
    if truth is not None and u_input is not None:
        both = 2 * np.hypot(u_input, u)
        yield Series(
            "noise and parameters ± 2u", truth.time_s, np.zeros(len(both)), _BAND, both,
            shaded=True, line=False,
        )  # fmt: skip


def _residuals(
    run: Run, probe: str, case: int, measured: Trajectory
) -> list[tuple[str, Array]]:  # fmt: skip
    """Engine and simulated minus measured at the samples of the measurement; NaN where neither."""
    residuals = []
    for name in runs.names(run):
        one = validations.stored(run, name, validations.BEST, case)
        if one is not None and probe in one.signals:
            at = interpolated(one.time_s, one.signals[probe], measured.time_s)
            residuals.append((name, at - measured.signals[probe]))
    return residuals


def _events(run: Run, case: int) -> tuple[Span, ...]:
    return tuple(
        Span(time, time, EVENT) for time in validations.event_times(run, case)[:_MAX_EVENTS]
    )


def _event_words(run: Run, case: int) -> str:
    count = len(validations.event_times(run, case))
    if not count:
        return ""
    first = f" (the first {_MAX_EVENTS} of {count})" if count > _MAX_EVENTS else ""
    return f" Dashed upright lines: events of the recording{first}."
