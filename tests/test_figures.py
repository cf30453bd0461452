"""Figures: thinning, energy from positions, and the two renderers."""

import base64
import itertools
import json
import math

import numpy as np
import pytest

from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory
from simcompare.reports.render import matplotlib_, plotly_
from simcompare.reports.render.decimation import decimated
from simcompare.reports.render.figures import (
    Band,
    Bars,
    Figure,
    Panel,
    Series,
    Span,
    fitted_range,
    spread,
)
from simcompare.reports.render.styles import Style, style_of
from simcompare.reports.run import motion_figures

HEIGHT = Probe(observe="ball.position_m", component=2, label="height", unit="m")
G = 9.80665


def panel(*series, **more):
    return Panel("a panel", "time (s)", "height (m)", tuple(series), **more)


def figure(*panels, share_y=False):
    return Figure("name", "A title", "What to see.", panels, share_y)


def line(y, **more):
    return Series("a", np.arange(len(y), dtype=float), np.array(y), Style("#0072B2"), **more)


def two_panels():
    left = panel(line([1.0, 2.0, math.nan]), bands=(Band(0.5, 1.5, "limits", 1.0),))
    points = line([1.0, 2.0], u=np.array([0.1, math.nan]), points=True, line=False)
    right = panel(points, x_ticks=("one\nmore", "<b>two</b>"), log_y=True, y_range=(0.1, 10.0))
    return figure(left, right, share_y=True)


def falling_ball(restitution=1.0, step_s=0.001, drop_m=1.0, duration_s=1.5):
    """A closed form: falls, and bounces once."""
    time_s = np.arange(round(duration_s / step_s) + 1) * step_s
    impact_s = math.sqrt(2 * drop_m / G)
    after = time_s - impact_s
    speed = restitution * G * impact_s
    z = np.where(after < 0, drop_m - G * time_s**2 / 2, speed * after - G * after**2 / 2)
    position = np.column_stack((np.zeros_like(z), np.zeros_like(z), z))
    return Trajectory("engine", time_s, {"ball.position_m": position}), impact_s


# thinning


def test_short_lines_are_left_alone():
    x = np.arange(5000.0)
    assert decimated(x, x)[0] is x


def test_thinning_keeps_extremes_and_ends():
    rng = np.random.default_rng(1)
    y = rng.normal(size=123_457)
    y[60_001], y[99_999] = 40.0, -50.0
    x, thin = decimated(np.arange(len(y), dtype=float), y)
    assert len(thin) <= 5000
    assert thin.max() == 40.0
    assert thin.min() == -50.0
    assert (x[0], x[-1]) == (0.0, 123_456.0)
    assert np.all(np.diff(x) > 0)


def test_thinning_keeps_every_impact_of_a_bounce_at_zero():
    t = np.linspace(0, 20, 200_001)
    x, y = decimated(t, np.abs(np.sin(np.pi * t)))
    lows = [y[np.abs(x - k) < 0.01].min() for k in range(1, 20)]
    assert max(lows) < 1e-3


def test_thinning_keeps_gaps():
    y = np.ones(20_000)
    y[7_000:7_100] = np.nan
    _, thin = decimated(np.arange(20_000.0), y)
    assert np.isnan(thin).any()
    assert np.isnan(decimated(np.arange(20_000.0), np.full(20_000, np.nan))[1]).all()


# looks


def test_engines_differ_by_more_than_colour():
    styles = [style_of(name) for name in ("dart", "mujoco", "pybullet", "pymunk")]
    assert len({style.dash for style in styles}) == 4
    assert len({style.marker for style in styles}) == 4
    assert style_of("an engine of somebody else's") == style_of("an engine of somebody else's")


def test_spread_is_symmetric_and_keeps_to_its_event():
    shifts = [spread(i, 4) for i in range(4)]
    assert sum(shifts) == pytest.approx(0)
    assert max(shifts) < 0.5
    assert spread(0, 1) == 0


def test_fitted_range_holds_bars_and_bands_and_survives_nothing():
    row = line([1.0, math.nan], u=np.array([3.0, math.nan]))
    low, high = fitted_range((row,), (Band(-5, -4, "band"),))
    assert low < -5
    assert high > 4
    assert fitted_range((), ()) == (0.0, 1.0)
    assert fitted_range((line([2.0]),), ())[0] < 2.0


@pytest.mark.parametrize(
    ("y", "found"),
    [
        ([-0.029] * 3, (-0.0319, -0.0261)),
        ([5.0, 5.0 + 1e-7], (4.5, 5.5)),
        ([0.0, 1e-13, -3e-13], (-1e-6, 1e-6)),
        ([0.0, 2e-6], None),
        ([96023.0, 96034.0], None),
        ([math.nan], None),
    ],
)
def test_what_does_not_vary_is_drawn_as_a_calm_line(y, found):
    row = panel(line(y))
    assert figure(row).y_range(row) == (found and pytest.approx(found))
    if found:
        assert fitted_range((line(y),), ()) == pytest.approx(found)


def test_panels_of_one_axis_are_calm_only_together():
    still, moving = panel(line([1.0, 1.0])), panel(line([1.0, 2.0]))
    assert figure(still, moving, share_y=True).y_range(still) is None
    assert figure(still, moving).y_range(still) == pytest.approx((0.9, 1.1))


@pytest.mark.parametrize(
    ("y", "plain"), [([96023.0, 96034.0], True), ([0.0, 2e-6], False), ([0.0, 3e7], False)]
)
def test_only_very_small_and_large_sizes_have_a_power_of_ten(y, plain):
    one = figure(panel(line(y)))
    axis = plotly_.as_dict(one)["layout"]["yaxis"]
    assert axis["exponentformat"] == ("none" if plain else "power")
    page = matplotlib_.canvas(one)
    page.draw_without_rendering()
    assert (page.axes[0].yaxis.get_offset_text().get_text() == "") == plain


def test_names_that_would_run_into_each_other_are_slanted():
    few, many = ("one", "two"), tuple(f"a measure\nnumber {i}" for i in range(8))
    for ticks, slanted in ((few, False), (many, True)):
        one = figure(panel(line([1.0] * len(ticks)), x_ticks=ticks))
        axis = plotly_.as_dict(one)["layout"]["xaxis"]
        assert (axis["tickangle"] != 0) == slanted
        assert axis["automargin"]
        text = matplotlib_.canvas(one).axes[0].get_xticklabels()[0]
        assert (text.get_rotation() != 0) == slanted


def test_numbers_at_the_x_axis_lie_flat():
    axis = plotly_.as_dict(figure(*[panel(line([1.0, 2.0]))] * 3))["layout"]["xaxis"]
    assert axis["tickangle"] == 0
    assert axis["nticks"] <= 5


@pytest.mark.parametrize("limits", [(0.7835, 0.8175), (1.1, 10.9), (0.0, 1.0)])
def test_also_a_narrow_axis_of_a_paper_has_three_numbers(limits):
    narrow = panel(line([1.0, 2.0]), x_limits=limits)
    page = matplotlib_.canvas(figure(narrow, panel(line([1.0, 2.0]), weight=9.0)))
    page.draw_without_rendering()
    low, high = limits
    assert sum(low <= tick <= high for tick in page.axes[0].get_xticks()) >= 3


# energy


@pytest.mark.parametrize("step_s", [0.0005, 0.001, 0.01])
def test_energy_of_free_flight_is_constant_and_falls_with_the_square_of_restitution(step_s):
    trajectory, impact_s = falling_ball(restitution=0.8, step_s=step_s, duration_s=1.0)
    time_s, ratio = motion_figures.relative(trajectory, HEIGHT, G)
    good = np.isfinite(ratio)
    assert ratio[good & (time_s < impact_s)] == pytest.approx(1.0, abs=1e-9)
    assert ratio[good & (time_s > impact_s)] == pytest.approx(0.64, abs=1e-6)
    assert not good[np.argmin(np.abs(time_s - impact_s))]


def test_energy_at_rest_is_shown_although_it_is_in_contact():
    time_s = np.linspace(0.0, 2.0, 2001)
    height = np.maximum(1 - G * time_s**2 / 2, 0.0)
    position = np.column_stack((height * 0, height * 0, height))
    _, ratio = motion_figures.relative(
        Trajectory("e", time_s, {"ball.position_m": position}), HEIGHT, G
    )
    assert ratio[-1] == 0.0


def test_energy_without_height_or_start_is_empty():
    trajectory, _ = falling_ball(duration_s=0.3)
    other = HEIGHT.model_copy(update={"observe": "cart.position_m"})
    assert len(motion_figures.relative(trajectory, other, G)[0]) == 0
    floor = HEIGHT.model_copy(update={"offset": -100.0})
    assert len(motion_figures.relative(trajectory, floor, G)[0]) == 0


# plotly


def test_numbers_that_are_not_finite_become_null():
    found = plotly_.as_dict(figure(panel(line([1.0, math.nan, math.inf, -math.inf]))))
    assert found["data"][0]["y"] == [1.0, None, None, None]
    json.dumps(found, allow_nan=False)


def test_json_cannot_end_its_script_element():
    evil = figure(
        panel(Series("</script><script>alert(1)", np.zeros(1), np.zeros(1), Style("#000")))
    )
    text = plotly_.embedded(evil)
    assert "<" not in text
    assert json.loads(text)["data"][0]["legendgroup"] == "</script><script>alert(1)"


def test_labels_are_not_read_as_markup():
    found = plotly_.as_dict(two_panels())
    assert found["layout"]["xaxis2"]["ticktext"] == ["one<br>more", "&lt;b&gt;two&lt;/b&gt;"]


def test_panels_share_the_axis_and_the_legend():
    row = line([1.0, 2.0])
    found = plotly_.as_dict(figure(panel(row), panel(row), share_y=True))
    assert found["layout"]["yaxis2"]["matches"] == "y"
    assert [trace["showlegend"] for trace in found["data"]] == [True, False]
    assert found["layout"]["xaxis"]["domain"][1] < found["layout"]["xaxis2"]["domain"][0]


def test_logarithmic_range_is_given_in_powers_of_ten():
    axis = plotly_.as_dict(two_panels())["layout"]["yaxis2"]
    assert axis["type"] == "log"
    assert axis["range"] == pytest.approx([-1.0, 1.0])


def test_coordinates_keep_seven_digits():
    found = plotly_.as_dict(figure(panel(line([1 / 3, -1e-9 / 3, 0.0, 12345678.9]))))
    assert found["data"][0]["y"] == [0.3333333, -3.333333e-10, 0.0, 12345680.0]


def test_long_lines_are_embedded_as_binary_numbers_with_their_gaps():
    y = np.linspace(0.0, 1.0, 300)
    y[7] = math.nan
    (trace,) = json.loads(plotly_.embedded(figure(panel(line(y)))))["data"]
    assert trace["y"]["dtype"] == "f4"
    read = np.frombuffer(base64.b64decode(trace["y"]["bdata"]), dtype="<f4")
    assert read == pytest.approx(y, abs=1e-7, nan_ok=True)


def test_long_lines_are_thinned():
    found = plotly_.as_dict(figure(panel(line(np.sin(np.arange(50_000.0))))))
    assert len(found["data"][0]["x"]) <= 5000


# matplotlib


@pytest.mark.parametrize(
    ("format", "head"), [("pdf", b"%PDF"), ("png", b"\x89PNG"), ("svg", b"<?xml")]
)
def test_every_format_is_drawn_and_is_the_same_twice(format, head):
    found = matplotlib_.rendered(two_panels(), format)
    assert found.startswith(head)
    assert found == matplotlib_.rendered(two_panels(), format)


def test_drawing_leaves_the_global_state_alone():
    import matplotlib as mpl
    from matplotlib import pyplot

    before, windows = dict(mpl.rcParams), pyplot.get_fignums()
    matplotlib_.rendered(two_panels(), "svg")
    assert dict(mpl.rcParams) == before
    assert pyplot.get_fignums() == windows


def test_a_long_legend_is_broken_into_rows():
    rows = [
        Series(f"an engine with a long name, number {i}", np.zeros(1), np.zeros(1), Style("#000"))
        for i in range(7)
    ]
    page = matplotlib_.canvas(figure(panel(*rows), panel(*rows)))
    page.canvas.draw()
    box = page.legends[0].get_window_extent()
    assert box.x0 >= 0
    assert box.x1 <= page.bbox.width


# bars, bands about lines, ranges of x


def stacked(**more):
    layers = (
        Bars("low", np.array([1.0, 3.0]), "#0072B2", "/", ("$1", "")),
        Bars("high", np.array([2.0, 0.0]), "#D55E00"),
    )
    return Panel("", "share (%)", "", (), bars=layers, **more)


def test_bars_stand_on_each_other():
    one = figure(stacked(x_ticks=("a", "b")))
    assert one.y_range(one.panels[0]) == pytest.approx((0.0, 3.24))
    low, high = matplotlib_.canvas(one).axes[0].containers
    assert [bar.get_y() for bar in high] == [1.0, 3.0]
    assert [bar.get_height() for bar in low] == [1.0, 3.0]
    found = plotly_.as_dict(one)
    assert found["layout"]["barmode"] == "stack"
    assert [(t["orientation"], t["y"]) for t in found["data"]] == [
        ("v", [1.0, 3.0]),
        ("v", [2.0, 0.0]),
    ]


def test_bars_lie_beside_names():
    one = figure(stacked(y_ticks=("a", "<b>")))
    assert one.panels[0].x_range == pytest.approx((0.0, 3.24))
    assert one.y_range(one.panels[0]) == (1.5, -0.5)
    axes = matplotlib_.canvas(one).axes[0]
    assert [bar.get_x() for bar in axes.containers[1]] == [1.0, 3.0]
    assert [text.get_text() for text in axes.get_yticklabels()] == ["a", "<b>"]
    found = plotly_.as_dict(one)
    assert found["data"][1]["x"] == [2.0, 0.0]
    assert found["data"][1]["orientation"] == "h"
    assert found["layout"]["yaxis"]["ticktext"] == ["a", "&lt;b&gt;"]
    assert found["layout"]["yaxis"]["range"] == [1.5, -0.5]


def test_bars_hold_their_texts():
    one = figure(stacked(y_ticks=("a", "b")))
    assert plotly_.as_dict(one)["data"][0]["text"] == ["<b>$1</b>", ""]
    assert "text" not in plotly_.as_dict(one)["data"][1]
    axes = matplotlib_.canvas(one).axes[0]
    assert [text.get_text() for text in axes.texts] == [r"\$1", ""]
    assert matplotlib_.rendered(one, "svg").startswith(b"<?xml")


def test_bars_without_length_are_drawn():
    layers = (Bars("none", np.zeros(2), "#000000"),)
    for ticks in ({"x_ticks": ("a", "b")}, {"y_ticks": ("a", "b")}):
        one = figure(Panel("", "", "", (), bars=layers, **ticks))
        assert matplotlib_.rendered(one, "png")
        json.dumps(plotly_.as_dict(one), allow_nan=False)


def test_uncertainty_beside_names_lies():
    row = line([0.0, 1.0], u=np.array([0.5, 0.6]), points=True, line=False)
    one = figure(panel(row, y_ticks=("a", "b")))
    (trace,) = plotly_.as_dict(one)["data"]
    assert trace["error_x"]["array"] == [0.5, 0.6]
    assert "error_y" not in trace
    (bars,) = matplotlib_.canvas(one).axes[0].containers
    assert bars.has_xerr
    assert not bars.has_yerr


def test_a_shaded_line_has_its_band_below_it():
    one = figure(panel(line([1.0, 2.0], u=np.array([0.1, 0.2]), shaded=True)))
    band, row = plotly_.as_dict(one)["data"]
    assert band["y"] == pytest.approx([0.9, 1.8, 2.2, 1.1])
    assert band["x"] == [0, 1, 1, 0]
    assert (band["showlegend"], row["showlegend"]) == (False, True)
    assert "error_y" not in row
    axes = matplotlib_.canvas(one).axes[0]
    assert len(axes.collections) == len(axes.lines) == 1
    assert axes.collections[0].get_datalim(axes.transData).y1 == pytest.approx(2.2)


def test_a_band_without_a_line_is_in_the_legend():
    one = figure(panel(line([1.0, 2.0], u=np.array([0.1, 0.2]), shaded=True, line=False)))
    (band,) = plotly_.as_dict(one)["data"]
    assert band["showlegend"]
    page = matplotlib_.canvas(one)
    assert not page.axes[0].lines
    assert [text.get_text() for text in page.legends[0].get_texts()] == ["a"]


def test_ranges_and_instants_of_x_are_marked():
    spans = (Span(0.2, 0.4, "a part"), Span(0.7, 0.7, "an event"), Span(0.8, 0.8, "an event"))
    one = figure(panel(line([1.0, 2.0]), spans=spans))
    shapes = plotly_.as_dict(one)["layout"]["shapes"]
    assert [(s["type"], s["x0"], s["x1"]) for s in shapes] == [
        ("rect", 0.2, 0.4),
        ("line", 0.7, 0.7),
        ("line", 0.8, 0.8),
    ]
    assert [s["showlegend"] for s in shapes] == [True, True, False]
    page = matplotlib_.canvas(one)
    assert [t.get_text() for t in page.legends[0].get_texts()] == ["a", "a part", "an event"]


def test_a_part_of_x_is_enlarged():
    one = figure(panel(line([1.0, 2.0, 3.0]), x_limits=(0.5, 1.5)))
    assert plotly_.as_dict(one)["layout"]["xaxis"]["range"] == [0.5, 1.5]
    assert matplotlib_.canvas(one).axes[0].get_xlim() == (0.5, 1.5)


def test_a_dollar_sign_is_no_mathematics():
    row = Series("$a_{", np.arange(2.0), np.arange(2.0), Style("#000000"))
    one = figure(Panel("$t_{", "$x_{", "$y_{", (row,), x_ticks=("$k_{", "b")))
    assert matplotlib_.rendered(one, "svg").startswith(b"<?xml")


def test_a_taller_figure_is_taller():
    flat, tall = figure(stacked(y_ticks=("a", "b"))), figure(stacked(y_ticks=("a", "b")))
    tall = Figure(tall.name, tall.title, tall.caption, tall.panels, height=2.0)
    sizes = [matplotlib_.canvas(one).get_figheight() for one in (flat, tall)]
    assert sizes[1] == pytest.approx(2 * sizes[0])


@pytest.mark.parametrize(("height", "alike"), [(1.0, True), (0.02, False)])
def test_a_map_has_one_scale_unless_it_would_be_a_line(height, alike):
    one = figure(panel(line([0.0, 0.0, 2 * height]), is_map=True))
    assert (matplotlib_.canvas(one).axes[0].get_aspect() == 1.0) == alike
    assert ("scaleanchor" in plotly_.as_dict(one)["layout"]["yaxis"]) == alike


def test_numbers_along_a_logarithmic_axis_do_not_touch():
    y = np.linspace(1.0, 2.0, 50)
    row = Series("a", np.geomspace(0.002, 50.0, 50), y, Style("#0072B2"))
    page = matplotlib_.canvas(figure(*[panel(row, log_x=True)] * 2))
    page.draw_without_rendering()
    axes = page.axes[0]
    low, high = axes.get_xlim()
    texts = [
        t for t in axes.get_xticklabels() if t.get_text() and low <= t.get_position()[0] <= high
    ]
    boxes = [text.get_window_extent() for text in texts]
    assert len(boxes) >= 3
    assert all(left.x1 < right.x0 for left, right in itertools.pairwise(boxes))
