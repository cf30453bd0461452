"""Figures of simulations held against a recording."""

import math
from dataclasses import replace

import numpy as np
import pytest

from simcompare.alignment.clock_line import Alignment
from simcompare.model.trajectory import Trajectory
from simcompare.reports.sections.validation import timings
from simcompare.reports.validation import events as real_events
from simcompare.reports.validation import gap_figures, parameter_tables, tables, waveforms
from tests import validated
from tests.validated import NOISE_RAD, cells, changed, plain, streams


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return validated.make(tmp_path_factory.mktemp("logs"))


@pytest.fixture(scope="module")
def fitted(made):
    return validated.run_of(made, "fitted")


@pytest.fixture(scope="module")
def judged(made):
    return validated.run_of(made, "known")


def test_a_gap_that_the_fit_made_larger_is_told_and_not_drawn(fitted):
    rows = plain(fitted)["gaps"]
    for row in rows:
        row["shares"] |= {"removed": -0.06, "model_form": 1.05, "noise": 0.01, "numerical": 0.0}
    (figure,) = gap_figures.gap_figures(changed(fitted, gaps=rows))
    (panel,) = figure.panels
    assert "made the mean square larger, by up to 6 %" in figure.caption
    assert all((bars.heights >= 0).all() for bars in panel.bars)
    lengths = np.sum([bars.heights for bars in panel.bars], axis=0)
    assert lengths == pytest.approx([row["total"] for row in rows])
    table = tables.gaps(changed(fitted, gaps=rows))[0]
    head = [column.head for column in table.columns].index("Fit took away (%)")
    assert {row[head] for row in cells(table)} == {"−6.0"}


def test_without_a_fit_parameters_and_model_are_not_told_apart(judged):
    (figure,) = gap_figures.gap_figures(judged)
    assert figure.panels[0].bars[0].label == "model form or parameters"
    assert "before the fit" not in figure.panels[0].x_label
    assert gap_figures.parameter_figure(judged) is None


def test_bars_stand_below_the_name_of_their_stretch(fitted):
    (figure,) = gap_figures.gap_figures(streams(fitted, 2))
    (panel,) = figure.panels
    assert panel.y_ticks[:2] == ("part 0:", "pymunk")
    assert panel.y_ticks[3] == "part 1:"
    assert panel.bars[0].heights[0] == panel.bars[0].heights[3] == 0


def test_a_distant_e_n_is_drawn_at_the_edge(judged):
    rows = plain(judged)["values"]
    rows[0]["e_n"] = -480.0
    figure = gap_figures.e_n_figure(changed(judged, values=rows))
    assert min(series.x.min() for series in figure.panels[0].series) == -10
    assert "drawn at the edge" in figure.caption
    assert not any(one["e_n"] == -10 for one in rows)


def test_fitted_parameters_are_drawn_in_units_of_what_was_known(fitted):
    figure = gap_figures.parameter_figure(fitted)
    (series,) = figure.panels[0].series
    rows = {row["name"]: row for row in plain(fitted)["parameters"]}
    length = rows["length_m"]
    assert series.x[0] == pytest.approx((length["fitted"] - 0.24) / 0.01)
    assert series.u[0] == pytest.approx(2 * length["u_fitted"] / 0.01)
    assert figure.panels[0].y_ticks == ("length", "damping")


def test_single_stretches_scatter_about_the_fit(fitted):
    fit = plain(fitted)["fit"]
    rows = {row["name"]: row for row in plain(fitted)["parameters"]}
    names = fit["names"]
    fit["single"] = {
        "a": [rows[n]["fitted"] + rows[n]["u_fitted"] for n in names],
        "b": [rows[n]["fitted"] - 3 * rows[n]["u_fitted"] for n in names],
    }
    figure = gap_figures.parameter_figure(changed(fitted, fit=fit))
    (series,) = figure.panels[1].series
    assert sorted(series.x) == pytest.approx([-3, -3, 1, 1])
    table = parameter_tables.single_fits(changed(fitted, fit=fit))
    (_, *first), (_, *second), (_, *u) = cells(table)
    assert [row[0] for row in cells(table)] == ["a", "b", "u of all together"]
    # numbers have two digits of the uncertainty below them
    for column in zip(first, second, u, strict=True):
        assert len({len(text.partition(".")[2]) for text in column}) == 1
        assert len(column[-1].replace(".", "").lstrip("0")) == 2


def test_of_many_stretches_the_best_and_the_worst_are_drawn(fitted):
    many = streams(fitted, 4)
    found = waveforms.overlay_figures(many, "angle_rad")
    assert [figure.name for figure in found] == ["overlay-angle_rad-1", "overlay-angle_rad-4"]
    assert "Of 4 segments" in found[0].caption
    assert "part 3" in found[1].title


def test_the_zoom_is_where_the_gap_is_largest():
    time_s = np.linspace(0, 10, 1001)
    values = np.sin(2 * np.pi * time_s)
    residual = np.where(time_s > 8, 0.2, 0.01)
    measured = Trajectory("measured", time_s, {"x": values})
    low, high = waveforms.zoom_window(measured, "x", [residual, 0 * residual])
    assert low >= 7
    assert high <= 10.001
    assert high - low == pytest.approx(2.5, rel=0.1)


def test_lines_do_not_cross_a_gap():
    time_s = np.array([0.0, 0.1, 0.2, 0.3, 0.9, 1.0, 1.1])
    times, values = waveforms.with_gaps(time_s, np.arange(7.0))
    assert np.flatnonzero(np.isnan(values)) == pytest.approx([4])
    assert len(times) == 8


def test_events_are_marked_on_the_aligned_clock(fitted):
    events = [
        {"name": "push", "time_s": t, "stream": s, "u_s": None, "value": None}
        for t, s in ((1.5, "log"), (99.0, "log"), (1.0, "elsewhere"))
    ]
    shifted = [Alignment(0.5, 0.0, 0.0, 0.0, "events", text="By events.")]
    run = changed(fitted, events=events, alignments=shifted)
    (overlay,) = waveforms.overlay_figures(run, "angle_rad")
    marks = [span.low for span in overlay.panels[0].spans if span.label == "event"]
    assert marks == [1.0]
    assert "events of the recording" in overlay.caption
    residual = waveforms.residual_figure(run, "angle_rad")
    assert [span.low for span in residual.panels[0].spans] == [1.0]


def test_the_residual_shows_noise_and_parameters(judged):
    (panel,) = waveforms.residual_figure(judged, "angle_rad").panels
    (band,) = panel.bands
    noise_deg = math.degrees(NOISE_RAD)
    assert panel.y_label == "simulated − measured (°)"
    assert (band.low, band.high) == pytest.approx((-2 * noise_deg, 2 * noise_deg))
    shaded = next(series for series in panel.series if series.shaded)
    assert (shaded.u >= 2 * noise_deg - 1e-12).all()
    assert shaded.u.max() > 10 * noise_deg


def timed(run, **more):
    """The same run as if it had compared impacts."""
    interval = {
        "number": 1, "simulated_s": 0.512, "measured_s": 0.5, "u_data_s": 0.003, "u_num_s": 0.004,
        "u_input_s": None, "e_n": None,
    }  # fmt: skip
    row = {
        "source": "pymunk", "stream": "log", "series": "impact_times", "matched": 2, "missed": 1,
        "extra": 0, "bias_s": 0.01, "rmse_s": 0.0123, "max_abs_s": 0.02, "times_s": [0.0, 0.512],
        "measured_s": [0.0, 0.5], "intervals": [interval], **more,
    }  # fmt: skip
    return changed(run, timings=[row])


def test_intervals_between_events_are_drawn_with_what_is_known_of_their_uncertainty(fitted):
    figure = real_events.figure(timed(fitted))
    (panel,) = figure.panels
    (series,) = panel.series
    assert series.y[0] == pytest.approx(0.012)
    assert series.u[0] == pytest.approx(2 * 0.005)
    assert panel.y_label == "simulated − measured (s)"


def test_events_without_a_partner_are_counted(fitted):
    (row,) = cells(real_events.summary(timed(fitted)))
    assert row == ("pymunk", "2", "1", "0", "0.0100", "0.0123", "0.0200")
    assert cells(real_events.intervals(timed(fitted)))[0][4:] == ("0.00300", "0.00400", "–", "–")
    lost = timed(fitted, matched=0, bias_s=None, rmse_s=None, max_abs_s=None, intervals=[])
    assert cells(real_events.summary(lost))[0][4:] == ("–", "–", "–")
    assert real_events.figure(lost) is None


def test_a_run_without_events_has_no_section_on_them(fitted):
    assert real_events.summary(fitted) is None
    assert timings(fitted) is None
    assert timings(timed(fitted)).tables


def test_no_quantity_is_left_out_of_the_picture_of_the_gap(fitted):
    found = plain(fitted)
    probes = [f"q{i}" for i in range(5)]
    rows = [{**row, "probe": probe} for probe in probes for row in found["gaps"]]
    compare = {probe: found["compare"]["angle_rad"] | {"label": probe} for probe in probes}
    figures = gap_figures.gap_figures(changed(fitted, gaps=rows, compare=compare))
    assert [figure.name for figure in figures] == ["gap", "gap-2", "gap-3"]
    assert [panel.title for figure in figures for panel in figure.panels] == probes


def test_a_noisy_measurement_does_not_fill_the_panel(fitted):
    def width(run):
        (figure,) = waveforms.overlay_figures(run, "angle_rad")
        return next(s.style.width for s in figure.panels[0].series if s.label == "measured")

    noisy = tuple(
        replace(s, trajectory=rough(s.trajectory)) if s.source == "measured" else s
        for s in fitted.trajectories
    )
    assert width(fitted) > 3 * width(replace(fitted, trajectories=noisy))


def rough(trajectory):
    noise = np.random.default_rng(0).normal(0, 1, len(trajectory.time_s))
    return Trajectory("measured", trajectory.time_s, {"angle_rad": noise})
