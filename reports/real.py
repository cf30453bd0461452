"""Figures of simulations beside a recording: overlay, residuals, what the gap is made of, E_n."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from simcompare.reports import runs
from simcompare.reports.figures import (
    MEASURED_STYLE,
    TRUTH_STYLE,
    Band,
    Bars,
    Figure,
    Panel,
    Series,
    Style,
    spread,
    style_of,
)
from simcompare.results import TRUTH, Run
from simcompare.trajectory import Array, Trajectory

TIME = "time (s)"
MEASURED = "measured"
BEST, NOMINAL = "best", "nominal"
#: stretches of a recording that are drawn; a table has all
MOST_STRETCHES = 2
#: parts of a gap: key of the record, words, colour (Okabe and Ito), hatch
PARTS = (
    ("removed", "parameters", "#0072B2", "/"),
    ("model_form", "model form", "#D55E00", "x"),
    ("numerical", "numerical", "#009E73", "."),
    ("noise", "noise of the measurement", "#999999", ""),
)
_NOMINAL_STYLE = Style("#777777", dash="dot", width=2.0)


def validation(run: Run) -> Mapping[str, Any]:
    """The record of the validation."""
    found: Mapping[str, Any] = run.record["validation"]
    return found


def stored(run: Run, source: str, variant: str, case: int) -> Trajectory | None:
    """One trajectory of a case."""
    for one in run.trajectories:
        if (one.source, one.contact, one.repeat) == (source, variant, case):
            return one.trajectory
    return None


def judged_probes(run: Run) -> list[str]:
    """Probes that are judged, the leading one first."""
    return [name for name, one in validation(run)["compare"].items() if one["judged"]]


def cases(run: Run) -> list[tuple[int, str]]:
    """Number and words of the stretches that are drawn."""
    found = [(i, str(case["stream"])) for i, case in enumerate(validation(run)["cases"])]
    return found[:MOST_STRETCHES]


def overlay_figure(run: Run, probe: str) -> Figure:
    """What was measured with the engines over it, one panel a stretch."""
    about = validation(run)["compare"][probe]
    label = f"{about['label']}{runs.unit_words(about['unit'])}"
    panels = tuple(
        Panel(
            f"stretch {name}" if name != "log" else "", TIME, label, tuple(_overlay(run, probe, i))
        )
        for i, name in cases(run)
    )
    caption = (
        "Black: what was measured. Shaded: the reference with the standard uncertainties of its"
        " parameters, twice"
    )
    if validation(run)["fit"] is not None:
        caption += "; dotted: the reference with what was known before any fit"
    return Figure(
        f"overlay-{probe}", f"{about['label']}: measured and simulated", f"{caption}.", panels
    )


def _overlay(run: Run, probe: str, case: int) -> Iterator[Series]:
    truth = stored(run, TRUTH, BEST, case)
    if truth is not None and probe in truth.signals:
        u = truth.signals.get(f"u({probe})")
        yield Series(
            "reference", truth.time_s, truth.signals[probe], TRUTH_STYLE,
            None if u is None else 2 * u, shaded=u is not None,
        )  # fmt: skip
    nominal = stored(run, TRUTH, NOMINAL, case)
    if nominal is not None and validation(run)["fit"] is not None:
        yield Series("known before", nominal.time_s, nominal.signals[probe], _NOMINAL_STYLE)
    measured = stored(run, MEASURED, "", case)
    if measured is not None and probe in measured.signals:
        times, values = with_gaps(measured.time_s, measured.signals[probe])
        yield Series(MEASURED, times, values, MEASURED_STYLE)
    for name in runs.names(run):
        found = stored(run, name, BEST, case)
        if found is not None:
            yield Series(name, found.time_s, found.signals[probe], style_of(name))


def with_gaps(time_s: Array, values: Array) -> tuple[Array, Array]:
    """The same with a NaN wherever samples are missing, so that no line runs across."""
    steps = np.diff(time_s)
    wide = np.flatnonzero(steps > 5 * np.median(steps))
    return np.insert(time_s, wide + 1, time_s[wide]), np.insert(values, wide + 1, np.nan)


def residual_figure(run: Run, probe: str) -> Figure:
    """Simulated minus measured over time."""
    about = validation(run)["compare"][probe]
    label = f"simulated − measured{runs.unit_words(about['unit'])}"
    panels = []
    for i, name in cases(run):
        measured = stored(run, MEASURED, "", i)
        if measured is None or probe not in measured.signals:
            continue
        series = [
            Series(source, times, values, style_of(source))
            for source in runs.names(run)
            if (found := stored(run, source, BEST, i)) is not None
            for times, values in [_residual(found, measured, probe)]
        ]
        u = 2 * float(validation(run)["cases"][i]["probes"][probe]["u"])
        bands = [Band(-u, u, "noise of a sample, k = 2", 0.0)] if u else []
        title = f"stretch {name}" if name != "log" else ""
        panels.append(Panel(title, TIME, label, (*series, *_events(run, i, series)), tuple(bands)))
    caption = (
        "What is left between each engine and the measurement. A pattern that all engines share is"
        " not their error but that of the model or of the measurement."
    )
    return Figure(f"residual-{probe}", f"{about['label']}: what is left", caption, tuple(panels))


def _residual(found: Trajectory, measured: Trajectory, probe: str) -> tuple[Array, Array]:
    inside = (measured.time_s >= found.time_s[0]) & (measured.time_s <= found.time_s[-1])
    times = measured.time_s[inside]
    values = np.interp(times, found.time_s, found.signals[probe])
    return with_gaps(times, values - measured.signals[probe][inside])


def _events(run: Run, case: int, series: list[Series]) -> list[Series]:
    """Events of the recording as marks on the axis of the residuals."""
    about = validation(run)["cases"][case]
    times = [
        event["time_s"] - about["start_s"]
        for event in validation(run)["events"]
        if event["stream"] == about["stream"]
        and 0 <= event["time_s"] - about["start_s"] <= about["duration_s"]
    ]
    if not times or not series:
        return []
    style = Style("#000000", marker="triangle-up")
    return [Series("event", np.array(times), np.zeros(len(times)), style, points=True, line=False)]


def gap_figure(run: Run) -> Figure | None:
    """What the gap of each engine is made of, in shares of its mean square."""
    rows = validation(run)["gaps"]
    panels = []
    for probe in judged_probes(run):
        own = [row for row in rows if row["probe"] == probe]
        if not own:
            continue
        layers = tuple(
            Bars(
                words, np.array([100 * max(row["shares"][key], 0.0) for row in own]), colour, hatch
            )
            for key, words, colour, hatch in PARTS
        )
        several = len({row["stream"] for row in own}) > 1
        ticks = tuple(f"{r['source']}\n{r['stream']}" if several else r["source"] for r in own)
        label = validation(run)["compare"][probe]["label"]
        panels.append(
            Panel(str(label), "", "share of the squared gap (%)", (), x_ticks=ticks, bars=layers)
        )
    if not panels:
        return None
    caption = (
        "The mean square of what is between the simulation with the parameters known before and"
        " the measurement, split. Parameters: what fitting them took away. Model form: what is"
        " left and is neither noise nor step error."
    )
    return Figure("gap", "What the gap is made of", caption, tuple(panels[:3]))


def e_n_figure(run: Run) -> Figure | None:
    """E_n of every measured value."""
    rows = [row for row in validation(run)["values"] if row["e_n"] is not None]
    names = list(dict.fromkeys((row["measure"], row["stream"]) for row in rows))
    if not names:
        return None
    several = len({stream for _, stream in names}) > 1
    engines = list(dict.fromkeys(row["source"] for row in rows))
    series = []
    for i, engine in enumerate(engines):
        own = [row for row in rows if row["source"] == engine]
        x = [names.index((row["measure"], row["stream"])) + spread(i, len(engines)) for row in own]
        y = [row["e_n"] for row in own]
        series.append(
            Series(engine, np.array(x), np.array(y), style_of(engine), points=True, line=False)
        )
    ticks = tuple(
        runs.measure_words(name) + (f"\n{stream}" if several else "") for name, stream in names
    )
    panel = Panel(
        "",
        "",
        "E_n",
        tuple(series),
        (Band(-1.0, 1.0, "within the noise level", 0.0),),
        x_ticks=ticks,
    )
    caption = (
        "Difference over its expanded uncertainty (k = 2). Between −1 and 1 the difference cannot"
        " be told from the uncertainties; that alone validates nothing."
    )
    return Figure("e-n", "Measured values", caption, (panel,))
