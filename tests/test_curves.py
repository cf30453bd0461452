"""Series over an axis of their own: what is drawn over what, and how far it is from the truth."""

from dataclasses import replace

import numpy as np
import pytest

from simcompare.comparison.comparison import Score
from simcompare.reports.render import plotly_
from simcompare.reports.render.styles import style_of
from simcompare.reports.run import curve_figures, event_figures
from simcompare.reports.sections import pictures
from simcompare.reports.sections.headline import headline
from tests.records import changed
from tests.test_reports import make_run

FREQUENCIES = (1.0, 10.0, 100.0)


def swept(modes=("default", "assisted"), unit="Hz", **truths):
    """A run in which an amplitude of 2 % too much and a phase 1 deg too late were measured."""
    run = make_run([("north", mode, 0.8) for mode in modes])
    scores = []
    rows = {
        "frequency": (unit, FREQUENCIES, 1.0, 0.0),
        "amplitude": ("1", (1.0, 0.5, 0.1), 1.02, 0.0),
        "phase": ("deg", (0.0, -90.0, -170.0), 1.0, -1.0),
    }
    for mode in modes:
        for name, (its_unit, values, factor, shift) in rows.items():
            for k, true in enumerate(values):
                value = true * factor + shift
                known = truths.get(name, true)
                scores.append(
                    Score("north", mode, name, "probe", k + 1, value, None, None, its_unit, 1,
                          known, None, "info")
                )  # fmt: skip
    axes = {"amplitude": "frequency", "phase": "frequency"}
    return changed(run, axes=axes, scores=(*run.record.scores, *scores))


def series_of(panel, label="north"):
    return [series for series in panel.series if series.label == label]


def test_everything_over_one_axis_is_one_figure_with_the_truth_below():
    figure = curve_figures.curves_figures(swept(), "frequency")[0]
    assert figure.title == "Amplitude and phase over frequency"
    assert [panel.x_label for panel in figure.panels] == ["frequency (Hz)"] * 2
    amplitude, phase = figure.panels
    assert amplitude.log_x
    assert amplitude.series[0].label == "truth (closed form)"
    np.testing.assert_array_equal(amplitude.series[0].x, FREQUENCIES)
    np.testing.assert_allclose(series_of(phase)[0].y, [-1, -91, -171])


def test_an_axis_of_time_is_called_time_whatever_its_name():
    run = swept(unit="s")
    figure, deviations = pictures.curves(run).figures
    assert figure.title == "Amplitude and phase over time"
    assert deviations.title == "Amplitude and phase over time: deviation from the truth"
    assert {panel.x_label for panel in (*figure.panels, *deviations.panels)} == {"time (s)"}


def test_no_figure_has_more_panels_than_can_be_read():
    run = swept()
    axes = dict.fromkeys(("amplitude", "phase", "more", "and more", "the last"), "frequency")
    run = changed(run, axes=axes)
    found = curve_figures.curves_figures(run, "frequency")
    assert [len(figure.panels) for figure in found] == [3, 2]
    assert [figure.name for figure in found] == ["curves-frequency", "curves-frequency-2"]
    assert found[1].title == "And more and the last over frequency"
    # the first leads the report, the others follow
    assert headline(run).figures[1].name == "curves-frequency"
    assert pictures.curves(run).figures[0].name == "curves-frequency-2"


def test_the_legend_shows_an_engine_as_it_is_with_the_physics_mapped():
    figure = curve_figures.curves_figures(swept(), "frequency")[0]
    assert not figure.legend["north"].style.hollow
    traces = plotly_.as_dict(figure)["data"]
    shown = [trace for trace in traces if trace["showlegend"]]
    assert [trace["name"] for trace in shown] == ["truth (closed form)", "north", "by default"]
    assert shown[1]["marker"]["symbol"] == style_of("north").marker
    # what is hollow is told by an entry of its own, which draws nothing
    assert shown[2]["marker"]["symbol"] == "circle-open"
    assert set(shown[2]["y"]) == {None}


def test_default_is_hollow_and_below_mapped():
    panel = curve_figures.curves_figures(swept(), "frequency")[0].panels[0]
    assert [series.style.hollow for series in series_of(panel)] == [True, False]
    assert [series.line for series in series_of(panel)] == [False, True]


def test_deviations_are_per_cent_except_of_angles():
    amplitude, phase = curve_figures.deviations_figures(swept(), "frequency")[0].panels
    assert amplitude.y_label == "deviation (%)"
    np.testing.assert_allclose(series_of(amplitude)[0].y, 2.0)
    assert phase.y_label == "deviation (deg)"
    np.testing.assert_allclose(series_of(phase)[0].y, -1.0)
    # what the engines do by default is no claim of theirs
    assert len(series_of(amplitude)) == 1


def test_without_a_truth_there_are_no_deviations():
    run = swept(frequency=None, amplitude=None, phase=None)
    assert curve_figures.deviations_figures(run, "frequency") == []
    figure = curve_figures.curves_figures(run, "frequency")[0]
    assert len(series_of(figure.panels[0])) == 2
    assert "truth" not in figure.caption


def test_curves_over_anything_but_time_lead_the_report_and_are_not_drawn_twice():
    run = swept()
    assert [f.name for f in headline(run).figures] == ["answer", "curves-frequency"]
    assert [f.name for f in pictures.curves(run).figures] == ["deviations-frequency"]
    over_time = swept(unit="s")
    leading = headline(over_time).figures
    assert [figure.name for figure in leading] == ["answer", "motion-height_m"]
    assert [f.name for f in pictures.curves(over_time).figures] == [
        "curves-frequency",
        "deviations-frequency",
    ]


def test_an_engine_that_is_far_off_by_default_does_not_press_all_others_flat():
    run = swept()
    far = tuple(
        replace(s, value=100.0) if (s.contact, s.measure) == ("default", "amplitude") else s
        for s in run.record.scores
    )
    figure = curve_figures.curves_figures(changed(run, scores=far), "frequency")[0]
    assert figure.panels[0].y_range[1] < 50
    assert "lie outside" in figure.caption
    calm = curve_figures.curves_figures(run, "frequency")[0]
    assert calm.panels[0].y_range is None
    assert "lie outside" not in calm.caption


def test_curves_are_no_events():
    assert event_figures.event_measures(swept()) == ["restitution"]


def test_a_run_stored_before_there_were_axes_still_reads():
    run = make_run()  # its JSON has none
    assert not run.record.axes
    assert pictures.curves(run) is None


@pytest.mark.parametrize("library", ["plotly", "matplotlib"])
def test_a_logarithmic_axis_is_drawn_as_one(library):
    figure = curve_figures.curves_figures(swept(), "frequency")[0]
    if library == "plotly":
        axis = plotly_.as_dict(figure)["layout"]["xaxis"]
        assert (axis["type"], axis["dtick"], axis["tickformat"]) == ("log", "D2", "~g")
    else:
        from simcompare.reports.render import matplotlib_

        axes = matplotlib_.canvas(figure).axes[0]
        assert axes.get_xscale() == "log"
        assert axes.xaxis.get_major_formatter()(20.0) == "20"


def test_a_truth_of_zero_is_an_error_to_keep_small():
    from simcompare.reports.run import answer

    tolerances = {"restitution": {"relative": None, "absolute": 0.01, "reason": "Because of it."}}
    sources = [("north", "default", 0.002), ("south", "default", 0.02)]
    run = make_run(sources, truth=0.0, tolerances=tolerances)
    assert answer.sentences(run)[0] == (
        "By default the restitution is 0.002 in north; too far off: 0.020 ± 0.001 in south."
    )
