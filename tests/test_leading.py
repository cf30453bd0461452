"""The picture and the table that lead: all sources and levels beside the truth."""

import pytest

from simcompare.reports.render import matplotlib_, plotly_
from simcompare.reports.run.lead_figure import lead_figure
from simcompare.reports.run.lead_table import lead_table, legend_words, text
from tests.test_headline import answered, changed, level
from tests.test_reports import make_run

LONG = ["mujoco:implicitfast", "pybullet@0.25ms", "dart", "ode:quickstep@0.5ms"]


def by_label(panel):
    return {series.label: series for series in panel.series}


def three_levels(**more):
    return answered(
        [*level("default", north=0.0, south=0.5), *level("tuned", north=0.81, south=0.83),
         *level("assisted", north=0.8, south=0.801)],
        **more,
    )  # fmt: skip


# the picture


def test_far_and_near_have_a_panel_each_and_only_what_is_judged_is_near():
    whole, near = lead_figure(three_levels()).panels
    assert list(by_label(whole)) == ["by default", "tuned", "assisted"]
    assert list(by_label(near)) == ["tuned", "assisted"]
    assert whole.y_ticks == near.y_ticks == ("north", "south")
    tuned = by_label(near)["tuned"]
    assert tuned.x == pytest.approx([0.81, 0.83])
    assert tuned.u == pytest.approx([0.001] * 2)
    # in the unit of the measure, so that both panels show the same numbers
    assert whole.x_label == near.x_label == "restitution"
    assert by_label(whole)["by default"].x == pytest.approx([0.0, 0.5])


def test_truth_and_tolerance_are_marked_in_both():
    panels = lead_figure(three_levels()).panels
    assert len(panels) == 2
    for panel in panels:
        tolerance, truth = panel.spans
        assert (tolerance.low, tolerance.high) == pytest.approx((0.792, 0.808))
        assert tolerance.rows is None
        assert truth.low == truth.high == pytest.approx(0.8)


def test_values_that_are_all_near_need_one_panel_in_their_own_unit():
    figure = lead_figure(answered(level("assisted", north=0.801, south=0.8)))
    (panel,) = figure.panels
    assert panel.x_label == "restitution"
    assert panel.title == "", "there is nothing to tell it from"
    assert "Arrows" not in figure.caption
    assert "–" not in figure.caption
    assert by_label(panel)["assisted"].x == pytest.approx([0.801, 0.8])


def test_levels_of_a_row_stand_below_each_other_in_their_order():
    whole, _ = lead_figure(three_levels()).panels
    heights = [by_label(whole)[mode].y[0] for mode in ("by default", "tuned", "assisted")]
    assert heights == sorted(heights)
    assert len(set(heights)) == 3
    assert all(abs(height) < 0.5 for height in heights)


def test_what_is_beyond_is_an_arrow_with_its_number():
    run = answered([*level("tuned", north=0.8, south=9e5), *level("assisted", north=0.8)])
    whole, near = lead_figure(run).panels
    assert "Arrows at an edge" in lead_figure(run).caption
    for panel in (whole, near):
        arrow = panel.series[1]
        assert arrow.style.marker == "triangle-right"
        assert panel.x_limits[0] < arrow.x[0] < panel.x_limits[1]
        assert [note.text for note in panel.notes if "900000" in note.text]


def test_what_was_not_measured_is_a_dash_and_what_did_not_run_says_why():
    run = changed(answered(level("tuned", north=0.8, south=0.8, west=None)), "south", value=None)
    (panel,) = lead_figure(run).panels
    assert [(round(note.y), note.text) for note in panel.notes] == [(1, "–"), (2, "– failed")]
    assert lead_figure(run).caption.endswith("– could not be measured.")


def test_a_level_at_which_a_source_did_not_run_says_why_where_that_is_known():
    run = answered([*level("tuned", north=0.8, south=None), *level("assisted", south=0.8)])
    (panel,) = lead_figure(run).panels
    # north was not asked for at the second level, and south failed at the first
    assert sorted((round(note.y), note.text) for note in panel.notes) == [(0, "–"), (1, "– failed")]


def test_repeats_that_differ_are_told_by_their_ends():
    run = changed(three_levels(), "south", value=None, low=0.01, high=0.17)
    whole, _ = lead_figure(run).panels
    bars = [(x, u) for series in whole.series if series.u is not None
            for x, u in zip(series.x, series.u, strict=True)]  # fmt: skip
    assert any(x - u == pytest.approx(0.01) and x + u == pytest.approx(0.17) for x, u in bars)
    assert "from their lowest to their highest" in lead_figure(run).caption
    (row,) = [line for line in shown(run) if line.startswith("south")]
    assert "0.0100 to 0.1700" in row


def test_no_scatter_is_no_bar_and_no_end_of_one():
    run = changed(answered(level("tuned", north=0.8, south=0.8)), "north", scatter=0.0)
    (panel,) = lead_figure(run).panels
    assert [(list(s.y), s.u is None) for s in panel.series] == [([1.0], False), ([0.0], True)]
    # two parts of one level are one entry of the legend
    listed = [row for row in plotly_.as_dict(lead_figure(run))["data"] if row["showlegend"]]
    assert len(listed) == 1


def test_levels_differ_by_more_than_colour():
    run = answered([(n, m, 0.8) for m in ("default", "coefficients", "tuned", "assisted")
                    for n in ("north",)])  # fmt: skip
    styles = [series.style for series in lead_figure(run).panels[0].series]
    assert len({style.marker for style in styles}) == len(styles) == 4


def test_without_truth_or_tolerance_there_is_one_panel():
    (panel,) = lead_figure(answered(level("assisted", north=0.7), truth=None)).panels
    assert panel.spans == ()
    (panel,) = lead_figure(make_run(level("default", north=0.5), tolerances={})).panels
    assert len(panel.spans) == 1
    assert lead_figure(make_run(level("default", north=None))) is None


def test_more_rows_make_a_taller_figure():
    few, many = (
        lead_figure(answered(level("tuned", **{f"e{i}": 0.8 for i in range(count)})))
        for count in (2, 14)
    )
    assert many.height > few.height
    # letters of a row are 13 pixels high, and a figure of usual height has 480
    assert many.height * 480 > 14 * 1.5 * 13


def test_both_renderers_draw_notes_and_long_names():
    run = answered([*level("tuned", **dict.fromkeys(LONG, 0.9)), *level("assisted", dart=None)])
    figure = lead_figure(run)
    assert matplotlib_.rendered(figure, "svg") == matplotlib_.rendered(figure, "svg")
    canvas = matplotlib_.canvas(figure)
    canvas.draw_without_rendering()
    names = [label.get_text() for label in canvas.axes[0].get_yticklabels()]
    assert names == LONG
    window = canvas.bbox
    assert all(
        label.get_window_extent().x0 >= window.x0 for label in canvas.axes[0].get_yticklabels()
    ), "names are not cut off"


def test_heads_come_before_notes_in_the_page():
    run = changed(three_levels(), "south", value=None)
    layout = plotly_.as_dict(lead_figure(run))["layout"]
    texts = [note["text"] for note in layout["annotations"]]
    assert texts[:2] == ["<b>the whole</b>", "<b>near the truth</b>"]
    assert set(texts[2:]) == {"–"}


# the table


def shown(run, measure=None):
    return list(text(lead_table(run, measure), 80))


def test_levels_stand_side_by_side_with_verdicts_and_the_truth_below():
    assert shown(three_levels()) == [
        "restitution, mean of all events and 3 repeats; tolerance 0.008",
        "engine          default  tuned            assisted",
        "─" * 57,
        "north        0.0000(10)  0.8100(10) fail  0.8000(10) pass",
        "south        0.5000(10)  0.8300(10) fail  0.8010(10) pass",
        "closed form      0.8000  0.8000           0.8000",
    ]


def test_it_fits_80_columns_for_14_long_names_at_four_levels():
    names = [f"{LONG[0]}{i}" for i in range(14)]  # 20 and 21 letters
    modes = ("default", "coefficients", "tuned", "assisted")
    run = answered([(name, mode, 0.81234) for mode in modes for name in names])
    lines = shown(run)
    assert max(map(len, lines)) <= 80
    head = next(line for line in lines if line.startswith("engine"))
    assert head.split() == ["engine", *modes], "no column is lost"
    assert sum("fail" in line for line in lines) == 14


def test_what_did_not_run_has_its_state_and_what_was_not_measured_a_dash():
    run = changed(answered(level("tuned", north=0.8, south=0.8, west=None)), "south", value=None)
    rows = {line.split()[0]: line.split()[1:] for line in shown(run)[3:]}
    assert rows["south"][0] == "–"
    assert rows["west"] == ["failed"]


def test_any_measure_has_such_a_table():
    lines = shown(three_levels(), "settling_time")
    assert lines[0].startswith("settling time in s")
    assert lines[-1].split()[:2] == ["closed", "form"]


@pytest.mark.parametrize(
    ("scatter", "cell"),
    [(None, "0.8123"), (0.0, "0.8123"), (0.00004, "0.8123"), (0.0004, "0.8123(4)"),
     (0.0012, "0.8123(12)"), (0.25, "0.81(25)"), (1e-9, "0.8123")],
)  # fmt: skip
def test_digits_of_a_value_end_with_its_scatter_or_with_the_tolerance(scatter, cell):
    run = changed(answered(level("default", north=0.81234)), "north", scatter=scatter)
    (row,) = [line for line in shown(run) if line.startswith("north")]
    assert row.split()[1] == cell


def test_further_digits_show_that_a_value_is_outside():
    run = answered(level("tuned", north=0.80801))
    (row,) = [line for line in shown(changed(run, "north", scatter=None)) if "north" in line]
    assert row.split() == ["north", "0.80801", "fail"]


def test_what_is_far_below_the_tolerance_is_0_and_the_table_says_so():
    run = answered([*level("default", north=-1e-5), *level("tuned", north=0.8)])
    lines = shown(changed(run, "north", scatter=None))
    assert lines[3].split() == ["north", "0", "0.8000", "pass"]
    assert lines[-1] == "0 means less than 0.00005."
    assert "means" not in shown(changed(run, "north", scatter=None, value=0.0))[-1]


def test_legends_explain_what_stands_in_a_table():
    table = lead_table(three_levels())
    assert legend_words([table]) == ["default", "tuned", "assisted", "brackets"]
    bare = lead_table(changed(answered(level("tuned", north=0.8)), "north", value=None))
    assert legend_words([bare]) == ["tuned", "–"]
