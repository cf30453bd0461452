"""Reports of parameters fitted to measured bounces."""

import json
import math
import re
import warnings
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

from simcompare.model.plain import of_plain, plain
from simcompare.reports import builder
from simcompare.reports.fit import (
    engine_words,
    fits,
    measured_figures,
    measured_tables,
    more_figures,
    short,
    tables,
)
from simcompare.reports.fit import figures as fitted_figures
from simcompare.reports.fit import tuned as fitted_tuned
from simcompare.reports.render import matplotlib_, numbers, plotly_
from simcompare.reports.render.figures import Figure, Matrix, Panel
from simcompare.reports.sections import of_run
from simcompare.reports.sections.fits import BOUNCES
from simcompare.results.records.fit_bounces import Rejected
from simcompare.results.records.fit_forms import Prior, ProfileRow, Unknown
from simcompare.results.records.fit_parts import Value
from simcompare.verbs import fit as fitting
from tests import records
from tests.bounces import IN_AIR, TRUTH, filmed_samples, times_of
from tests.validated import EVIL, cells

ENGINES = "dart,pymunk"
RATE = 48000
MY_BALL = Path(__file__).parent.parent / "examples" / "my_ball.csv"


def sound(path, values, count=8, seed=0):
    """Clicks at the impact times, which scatter by 0.1 ms."""
    import soundfile

    generator = np.random.default_rng(seed)
    times = times_of(values, count) + generator.normal(0, 1e-4, count)
    wave = generator.normal(0, 0.002, int(RATE * (times[-1] + 1)))
    n = np.arange(int(0.02 * RATE))
    for k, time in enumerate(times):
        start = int(time * RATE)
        click = np.exp(-n / RATE / 0.003) * np.sin(2 * np.pi * 2500 * n / RATE + 1.2)
        wave[start : start + len(n)] += 0.6 * 0.8**k * click
    soundfile.write(path, wave, RATE, subtype="PCM_24")
    return str(path)


def fit(recordings, **more):
    return fitting.fit("ball", recordings=recordings, engine=ENGINES, assist="all", **more)


@pytest.fixture(scope="module")
def heard(tmp_path_factory):
    """Two drops that are fitted and one that is held out, whose ball bounces better."""
    folder = tmp_path_factory.mktemp("heard")
    first = sound(folder / "first.wav", TRUTH, seed=1)
    second = sound(folder / "second.wav", {**TRUTH, "drop_height_m": 0.7}, seed=2)
    held = sound(folder / "held.wav", {**TRUTH, "restitution": 0.86}, seed=3)
    return fit([first, second], hold_out=[held], model="constant")


@pytest.fixture(scope="module")
def in_air(tmp_path_factory):
    """A drop with drag; all closed forms are compared."""
    return fit([sound(tmp_path_factory.mktemp("air") / "air.wav", IN_AIR, count=10, seed=4)])


@pytest.fixture(scope="module")
def filmed(tmp_path_factory):
    path = tmp_path_factory.mktemp("film") / "film.csv"
    time, height = filmed_samples(seconds=2.5)
    rows = "\n".join(f"{t:.5f},{y:.5f}" for t, y in zip(time, height, strict=True))
    path.write_text(f"t (s),y (m)\n{rows}\n")
    return fit([str(path)], model="constant")


@pytest.fixture(scope="module")
def falling(tmp_path_factory):
    """A law that engines do not have."""
    path = tmp_path_factory.mktemp("power") / "power.wav"
    values = {**TRUTH, "exponent": 0.1}
    return fit([sound(path, values, seed=5)], model="power")


@pytest.fixture(scope="module")
def tuned(tmp_path_factory):
    """A drop for plain loops, and one held out; one engine cannot."""
    folder = tmp_path_factory.mktemp("tuned")
    first = sound(folder / "first.wav", TRUTH, seed=1)
    held = sound(folder / "held.wav", {**TRUTH, "drop_height_m": 0.7}, seed=2)
    return fitting.fit("ball", recordings=[first], hold_out=[held], model="constant", step="3ms",
                       engine="dart,mujoco,pymunk")  # fmt: skip


RUNS = ("heard", "in_air", "filmed", "falling")


@pytest.fixture(params=RUNS)
def any_run(request):
    return request.getfixturevalue(request.param)


def changed(run, **more):
    """The same run with another record of its fit."""
    return records.changed(run, fit=replace(run.record.fit, **more))


def of_dict(run, tree):
    """The same run with the record of a fit that JSON would hold."""
    return records.changed(run, fit=of_plain(type(run.record.fit), tree))


def figures(run):
    (block,) = builder.blocks_of([run])
    return {figure.name: figure for figure in block.figures}


def series(panel, label):
    (found,) = [one for one in panel.series if one.label == label]
    return found


def without_scripts(html):
    own = re.sub(r"<script.*?</script>", "", html, flags=re.DOTALL).replace("\u00a0", " ")
    return unescape(own)


# structure


def test_a_fit_has_sections_of_its_own(heard):
    assert of_run(heard.record)[: len(BOUNCES)] == BOUNCES
    names = [part.name for part in builder.blocks_of([heard])[0].parts]
    assert len(set(names)) == len(names)


def test_every_section_is_in_the_html_which_fetches_nothing(any_run, tmp_path):
    html = builder.write_html([any_run], tmp_path / "r.html").read_text(encoding="utf-8")
    own = without_scripts(html)
    for title in ("What is left", "Each engine", "Which closed form", "Bounce by bounce",
                  "What the data can tell", "What other rules would give",
                  "The recording and the range", "How it was made"):  # fmt: skip
        assert f"{title}</" in own
    for sentence in any_run.record.fit.sentences:
        assert sentence.split("(")[0].strip() in own
    assert not re.findall(r"(?:src|href)\s*=\s*[\"'](?!#|data:)", own)


def test_every_figure_has_a_title_and_a_caption_and_is_drawn_by_both(any_run):
    found = figures(any_run)
    assert {"parameters", "speed", "correlation", "profiles", "others"} <= set(found)
    for figure in found.values():
        assert figure.title
        assert figure.caption.endswith(".")
        json.dumps(plotly_.as_dict(figure), allow_nan=False)
        matplotlib_.canvas(figure)


def test_markdown_has_every_table(any_run, tmp_path):
    text = builder.write_markdown([any_run], tmp_path / "r.md").read_text(encoding="utf-8")
    assert text.startswith("# Fit of Bouncing ball to ")
    assert short.short(any_run)[0] in text
    for head in ("Restitution of each engine", "Closed forms", "Combinations of unknowns", "Drops"):
        assert f"### {head}" in text


@pytest.mark.parametrize("count", [1, 14])
def test_a_figure_has_room_below_an_answer_of_any_length(heard, tmp_path, count):
    run = changed(heard, sentences=[f"Sentence {i} of an answer." for i in range(count)])
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a figure without room is drawn with a warning
        content = builder.write_pdf([run], tmp_path / "r.pdf").read_bytes()
    assert content.startswith(b"%PDF")


def test_hostile_names_stay_text(heard, tmp_path):
    record = plain(heard.record.fit)
    for drop in (*record["measured"], *record["held_out"], *record["holdout"]["drops"],
                 *record["other_estimates"]):  # fmt: skip
        drop["source"] = EVIL
    record["measured"][0]["notes"] = [EVIL]
    record["measured"][0]["dropped"] = [
        {"what": "impact", "number": 9, "time_s": 1.0, "reason": EVIL}
    ]
    evil = of_dict(heard, record)
    html = builder.write_html([evil], tmp_path / "r.html").read_text(encoding="utf-8")
    assert "<script>alert" not in html
    assert "&lt;script&gt;alert(1)" in html
    builder.write_pdf([evil], tmp_path / "r.pdf")
    for name in ("left-times", "holdout"):
        matplotlib_.rendered(figures(evil)[name], "png")
    text = builder.write_markdown([evil], tmp_path / "r.md").read_text(encoding="utf-8")
    assert "\x1b" not in text
    assert "<script>" not in text.replace("\\<script\\>", "")


# what was measured


def test_the_report_begins_with_the_sound_and_its_impacts(heard):
    first = next(iter(figures(heard).values()))
    assert first.title == "What was measured: drop 1: first.wav"
    (panel,) = first.panels
    drop = heard.record.fit.measured[0]
    assert series(panel, "impact").x == pytest.approx(drop.times_s)
    assert [note.text for note in panel.notes] == [str(n) for n in drop.numbers]
    loudness = series(panel, "sound")
    assert np.abs(loudness.y).max() == pytest.approx(0.6, rel=0.2)
    assert loudness.x[0] < drop.times_s[0] < drop.times_s[-1] < loudness.x[-1]


def test_what_was_left_out_is_marked_with_its_reason_on_the_picture(heard):
    first, *rest = heard.record.fit.measured
    reasons = ("within a flight, 9.0 ms after impact 1 (3%)", "after the last bounce")
    clicks = tuple(Rejected("impact", i + 6, 1.25 + i, text) for i, text in enumerate(reasons))
    drop = replace(first, missed=(4,), dropped=clicks)
    figure = measured_figures.measured_figures(changed(heard, measured=(drop, *rest)))[0]
    (panel,) = figure.panels
    assert series(panel, "left out: within a flight").x == [1.25]
    assert series(panel, "left out: after the last bounce").x == [2.25]
    assert series(panel, "not recorded").x == pytest.approx(first.times_s[3], abs=1e-3)
    assert figure.caption == (
        "The sound, and the impacts in it. 2 impacts were left out (orange). Impact 4 was not"
        " recorded (blue)."
    )


def test_a_track_is_drawn_with_its_arcs(filmed):
    first = next(iter(figures(filmed).values()))
    (panel,) = first.panels
    arcs, points = series(panel, "closed form"), series(panel, "measured")
    assert np.interp(points.x, arcs.x, arcs.y) == pytest.approx(points.y, abs=0.02)


def test_the_engines_move_over_what_was_measured(heard):
    figure = measured_figures.simulated_figure(heard)
    whole, last = figure.panels
    for name in ENGINES.split(","):
        line = series(whole, name)
        lowest = [line.y[np.abs(line.x - time) < 0.004].min()
                  for time in heard.record.fit.measured[0].times_s[:5]]  # fmt: skip
        assert lowest == pytest.approx([0.0] * 5, abs=0.02)
    assert last.x_range[0] > whole.series[0].x[0]


def test_a_fit_that_was_stored_without_the_recording_still_has_a_figure(heard):
    bare = replace(heard, trajectories=())
    first = next(iter(figures(bare).values()))
    assert series(first.panels[0], "measured impact").x == pytest.approx(
        heard.record.fit.measured[0].times_s
    )


# plain loops


def test_a_fit_for_plain_loops_leads_with_what_to_type_in(tuned, tmp_path):
    table = fitted_tuned.typed(tuned)
    sources = {row.name: row for row in tuned.record.fit.sources}
    rows = cells(table)
    assert [row[0] for row in rows] == ["closed form", "dart", "pymunk"]
    for name, told, first, *_ in rows[1:]:
        (number,) = sources[name].numbers
        assert told == f"{number.name} = {numbers.with_u(number.value, number.u)}"
        shown = sources[name].impacts[0]
        assert first == numbers.with_u(shown.restitution, shown.u_phase)
    html = builder.write_html([tuned], tmp_path / "r.html").read_text(encoding="utf-8")
    own = without_scripts(html)
    assert "With the numbers below, 2 of 3 engines bounce so at the first impact" in own
    assert "Could not be fitted" in own
    assert "the longest step" in own
    for title in ("How the bounce was tuned", "Drops that were not fitted"):
        assert f"{title}</" in own
    builder.write_pdf([tuned], tmp_path / "r.pdf")
    text = builder.write_markdown([tuned], tmp_path / "r.md").read_text(encoding="utf-8")
    for head in ("What to type into your own loop", "Impact by impact",
                 "Rebound heights of held-out drops"):  # fmt: skip
        assert f"### {head}" in text


def test_what_was_assumed_stands_near_the_top(tuned):
    (block,) = builder.blocks_of([tuned])
    first = block.parts[0]
    (table,) = [one for one in first.tables if one.title == "What was found, assumed and given"]
    assert not table.folded
    rows = {row[0]: row[2] for row in cells(table)}
    assert rows["gravity"] == "assumed"
    assert rows["restitution"] == "fitted"


def test_a_drop_has_one_height_wherever_it_is_told(in_air):
    told = in_air.record.fit.closed_form.parameters["drop_height_m"].value
    assert in_air.record.parameters["drop_height_m"] == told


def test_the_mean_of_the_closed_form_has_its_uncertainty(tuned):
    record = tuned.record.fit
    told = cells(fitted_tuned.typed(tuned))[0][3]
    assert told == numbers.with_u(record.tuned_mean, record.u_tuned_mean)
    # one law for all speeds: the mean is as well known as the restitution
    assert record.u_tuned_mean == pytest.approx(record.closed_form.parameters["restitution"].u)


def test_each_impact_in_a_plain_loop_is_drawn_beside_the_closed_form(tuned):
    figure = fitted_tuned.impacts_figure(tuned)
    off, late = figure.panels
    for source in tuned.record.fit.sources:
        if source.status == "ok":
            shown = series(off, source.name)
            assert shown.y == pytest.approx([100 * row.deviation for row in source.impacts])
            assert series(late, source.name).y[0] > 0
    # a delay by the contact is no residual of the fit
    (left,) = fitted_figures.residual_figures(tuned)
    assert set(left.legend) <= {"closed form", "± 2u of the measurement", "± 2u, widened"}


def test_the_level_of_a_fit_is_told(tuned, heard):
    assert measured_tables.valid(tuned)["contact level"] == "tuned"
    assert measured_tables.valid(heard)["contact level"] == "assisted, helps: all"
    rows = cells(fitted_tuned.heights(tuned))
    assert rows[0][:2] == ("1", "closed form")
    assert {row[1] for row in rows} == {"closed form", "dart", "pymunk"}


# what is left


def test_residuals_are_measured_less_simulated(heard):
    (figure,) = fitted_figures.residual_figures(heard)
    assert [panel.title for panel in figure.panels] == ["drop 1: first.wav", "drop 2: second.wav"]
    assert figure.panels[0].y_label == "measured − simulated (µs)"
    record = heard.record.fit
    for number, panel in enumerate(figure.panels):
        for source in record.sources:
            drawn = series(panel, source.name).y
            assert drawn == pytest.approx(1e6 * np.array(source.left_s[number]), abs=1e-3)
        closed = series(panel, "closed form")
        assert np.sqrt(np.mean(closed.y**2)) == pytest.approx(
            1e6 * record.closed_form.rms["times"], rel=0.5
        )
        band = series(panel, "± 2u of the measurement")
        assert band.u == pytest.approx(2e6 * np.array(record.measured[number].u_s))


def test_scatter_beyond_what_is_stated_has_a_band_of_its_own(heard):
    record = heard.record.fit
    (figure,) = fitted_figures.residual_figures(heard)
    wide, stated = (series(figure.panels[0], label).u
                    for label in ("± 2u, widened", "± 2u of the measurement"))  # fmt: skip
    assert wide / stated == pytest.approx(math.sqrt(record.closed_form.s2))
    calm = changed(heard, closed_form=replace(record.closed_form, s2=1.0))
    (figure,) = fitted_figures.residual_figures(calm)
    assert "± 2u, widened" not in figure.legend


def test_a_video_shows_times_heights_and_samples(filmed):
    found = figures(filmed)
    assert {"left-times", "left-track"} <= set(found)
    assert "drawn from the arcs" in found["left-times"].caption
    assert "none is stated" in found["left-track"].caption
    (panel,) = found["left-track"].panels
    assert panel.y_label == "measured − simulated (mm)"
    closed = series(panel, "closed form").y
    assert np.sqrt(np.mean(closed**2)) == pytest.approx(
        1e3 * filmed.record.fit.closed_form.rms["track"], rel=1e-6
    )
    assert np.std(series(panel, "pymunk").y) == pytest.approx(3.0, rel=0.3)


def test_engines_without_the_law_have_one_number_and_nothing_else_of_their_own(falling, in_air):
    record = falling.record.fit
    (words,) = engine_words.one_number(record)
    assert "one number for all speeds" in words
    assert words in record.sentences
    # it stands under the table of engines, and once
    assert words in tables.engines(falling).note
    (block,) = builder.blocks_of([falling])
    assert words not in block.parts[0].answer
    rows = cells(tables.engines(falling))
    assert rows[0][1] == numbers.with_u(record.one_number.value, record.one_number.u)
    laws = [end.value for end in record.closed_form.restitution]
    for source in record.sources:
        own = source.parameters["restitution"]
        assert min(laws) < own.value < max(laws)
        assert all(abs(law - own.value) < 3 * own.u for law in laws)
        for name, row in source.parameters.items():
            closed = record.closed_form.parameters[name]
            is_own = name == "restitution"
            assert row.whose == ("engine" if is_own else "closed form")
            assert is_own or (row.value, row.u, row.misfit) == (closed.value, closed.u, 0)
    assert engine_words.one_number(in_air.record.fit) == []


# parameters and effective values


def test_the_table_of_engines_is_the_record(heard):
    closed, *rows = cells(tables.engines(heard))
    record = heard.record.fit
    own = record.closed_form.parameters["restitution"]
    assert closed[:2] == ("closed form", numbers.with_u(own.value, own.u))
    for row, source in zip(rows, record.sources, strict=True):
        given, effective = source.parameters["restitution"], source.effective["restitution"]
        low, high = (float(end) for end in row[2].split(" to "))
        assert row[0] == source.name
        assert row[1] == numbers.with_u(given.value, given.u)
        assert (low, high) == pytest.approx(given.interval95, abs=0.02 * (high - low))
        assert row[3] == numbers.with_u(effective.value, effective.u)
        assert row[4] == str(source.simulations)


def test_an_exponent_has_one_meaning_whatever_the_law(falling, heard):
    meaning = "exponent: −d ln e/d ln v at 4 m/s"
    assert meaning in tables.parameters(falling).note
    assert meaning not in tables.parameters(heard).note


def test_an_engines_interval_holds_its_own_scatter(any_run):
    for source in any_run.record.fit.sources:
        row = source.parameters["restitution"]
        low, high = row.interval95
        assert high - low >= 2 * 1.95 * row.u_num
        assert low < row.value < high


def test_parameter_and_effective_value_are_drawn_apart(heard):
    figure = fitted_figures.parameter_figure(heard)
    panel = figure.panels[0]
    assert panel.y_ticks == ("closed form", "dart", "pymunk")
    parameter, effective = series(panel, "parameter"), series(panel, "effective value ± 2u")
    assert effective.style.hollow
    assert not parameter.style.hollow
    for i, source in enumerate(heard.record.fit.sources):
        assert parameter.x[i + 1] == source.parameters["restitution"].value
        assert effective.x[i] == source.effective["restitution"].value
    own = heard.record.fit.closed_form.parameters["restitution"]
    assert (panel.spans[0].low, panel.spans[0].high) == (own.low, own.high)


def test_an_open_interval_is_told_as_open():
    row = Unknown(value=9.0, u=None, low=7.0, high=None, interval="profile")
    assert fits.interval_words(row) == "above 7"
    assert fits.interval_words(replace(row, low=None)) == "open"
    assert fits.interval_words(replace(row, low=None, high=3.0)) == "below 3"
    infinite = Value(None, None)
    assert fits.value_words(infinite, "terminal_speed_m_s") == "no drag seen"


def test_an_engine_that_failed_is_told_with_its_reason(heard, tmp_path):
    record = plain(heard.record.fit)
    record["sources"][0] |= {"status": "failed", "reason": "it fell through", "parameters": {},
                             "effective": {}}  # fmt: skip
    record["sources"][0].pop("left")
    broken = of_dict(heard, record)
    html = builder.write_html([broken], tmp_path / "r.html").read_text(encoding="utf-8")
    assert "it fell through" in html
    assert "1 of 2 engines" in html
    assert "dart" not in fitted_figures.residual_figures(broken)[0].legend


# closed forms, speed, identifiability


def test_bars_of_closed_forms_end_but_keep_their_numbers(in_air):
    rows = in_air.record.fit.choice.candidates
    figure = more_figures.forms_figure(in_air)
    (bars,) = figure.panels[0].bars
    assert max(row.delta for row in rows) > 30 == bars.heights.max()
    assert bars.texts[-1] == numbers.plain(rows[-1].delta, 2)
    assert len(cells(tables.forms(in_air))) == len(rows)


def test_one_closed_form_has_no_bars(heard):
    assert more_figures.forms_figure(heard) is None


def test_drag_shows_in_ratios_but_not_in_the_restitution(in_air):
    (panel,) = fitted_figures.speed_figure(in_air).panels
    law, ratio = series(panel, "closed form ± 2u"), series(panel, "closed form's ratio")
    measured = series(panel, "measured ratio ± 2u")
    assert (ratio.y < law.y[0] - 0.001).all()
    assert measured.y == pytest.approx(ratio.y, abs=0.005)
    assert measured.x == pytest.approx(ratio.x)
    assert np.all(np.diff(measured.x) < 0)  # every bounce is slower than the one before
    for source in in_air.record.fit.sources:
        assert series(panel, source.name).y == pytest.approx(law.y[0], abs=0.002)


def test_the_matrix_holds_the_correlations(heard):
    (panel,) = more_figures.correlation_figure(heard).panels
    known = heard.record.fit.identifiability
    assert panel.matrix.values == pytest.approx(np.array(known.correlation))
    assert panel.y_ticks[1] == "drop height of drop 1"


def test_a_profile_crosses_its_level_at_the_ends_of_the_interval(in_air):
    figure = more_figures.profile_figures(in_air)[0]
    record = in_air.record.fit
    for panel, row in zip(figure.panels, record.profiles, strict=False):
        curve = series(panel, "profile")
        best, over_all = (form[row.name] for form in (
            record.closed_form.own, record.closed_form.parameters
        ))  # fmt: skip
        low = np.interp(best.value - 1.96 * best.u, curve.x, curve.y)
        assert low == pytest.approx(3.84, rel=0.15)
        assert curve.y.min() == pytest.approx(0, abs=0.01)
        (span,) = panel.spans
        assert (span.low, span.high) == (
            max(over_all.low, curve.x.min()), min(over_all.high, curve.x.max())
        )  # fmt: skip
    assert "over all closed forms" in figure.caption


# hold-out, other residuals, what was measured


def test_a_held_out_drop_is_shown_with_its_e_n(heard):
    figure = more_figures.holdout_figure(heard)
    drop = heard.record.fit.holdout.drops[0]
    own = series(figure.panels[0], "of the held-out drop ± 2u")
    assert own.x[0] == drop.restitution == pytest.approx(0.86, abs=1e-3)
    assert own.u[0] == 2 * drop.u_restitution
    shown = series(figure.panels[1], "closed form").x[0]
    assert shown == min(abs(drop.e_n), 10.0) > 1
    rows = cells(tables.holdout(heard))
    assert [row[0] for row in rows] == ["closed form", "dart", "pymunk"]
    assert rows[0][3] == numbers.plain(abs(drop.e_n), 3)


def test_without_a_held_out_drop_nothing_was_validated(in_air, tmp_path):
    assert more_figures.holdout_figure(in_air) is None
    html = builder.write_html([in_air], tmp_path / "r.html").read_text(encoding="utf-8")
    assert "so the fit was not tested" in html


def test_another_residual_moves_the_restitution(in_air):
    figure = more_figures.others_figure(in_air)
    (panel,) = figure.panels
    rows = in_air.record.fit.other_estimates
    assert panel.series[0].x.tolist() == [row.value for row in rows]
    table = cells(tables.others(in_air))
    assert table[0][3] == "no"  # the mean ratio does not know drag
    low, high = fits.interval(in_air.record.fit.closed_form.parameters["restitution"])
    for row, cell in zip(rows, table, strict=True):
        assert cell[3] == ("yes" if low <= row.value <= high else "no")


def test_names_of_other_rules_are_narrow_enough_for_a_phone(in_air):
    (panel,) = more_figures.others_figure(in_air).panels
    assert len(panel.y_ticks) == len(in_air.record.fit.other_estimates)
    assert max(len(line) for tick in panel.y_ticks for line in tick.splitlines()) <= 16


def test_heights_without_times_put_no_impact_into_the_legend(tmp_path):
    run = fitting.fit("ball", recordings=[MY_BALL], engine="pymunk", out=tmp_path, step="1ms")
    (panel,) = measured_figures.simulated_figure(run).panels
    assert [one.label for one in panel.series] == ["closed form", "pymunk"]


def test_what_was_measured_and_where_it_holds_are_told(heard):
    rows = cells(measured_tables.measured(heard))
    assert [row[2] for row in rows] == ["fitted", "fitted", "held out"]
    low, high = heard.record.fit.valid.speed_m_s
    told = measured_tables.valid(heard)["valid for impacts at"]
    assert told == f"{numbers.plain(low, 3)} to {numbers.plain(high, 3)} m/s"


def test_what_was_left_out_is_told_with_its_reason(heard):
    assert measured_tables.left_out(heard) is None
    click = Rejected("impact", 6, 1.25, "a click of the switch")
    first, *rest = heard.record.fit.measured
    first = replace(first, missed=(4,), dropped=(click,))
    rows = cells(measured_tables.left_out(changed(heard, measured=(first, *rest))))
    assert rows[0] == ("first.wav", "impact 6", "1.25", "a click of the switch")
    assert rows[1][1] == "impact 4"


def test_priors_and_fixed_values_are_told(heard):
    assert {row[:2] for row in cells(measured_tables.known(heard))} == {
        ("gravity (m/s²)", "assumed"), ("clock skew", "assumed"),
    }  # fmt: skip
    bare = replace(heard.record.fit.closed_form, fixed={}, priors={})
    assert measured_tables.known(changed(heard, closed_form=bare)) is None
    closed = replace(
        bare, fixed={"terminal_speed_m_s": 9.0},
        priors={"drop_height_m": Prior(1.0, 0.002)}, pulls={"drop_height_m": -2.5},
    )  # fmt: skip
    fixed, prior = cells(measured_tables.known(changed(heard, closed_form=closed)))
    assert fixed[:3] == ("terminal speed (m/s)", "fixed", "9")
    assert prior == ("drop height (m)", "prior", "1.0000 ± 0.0020", "−2.5", "")


# matrices


def matrix_figure(values):
    names = ("a", "$b$")
    panel = Panel("", "", "", (), x_ticks=names, y_ticks=names, matrix=Matrix(np.array(values)))
    return Figure("m", "M", "C.", (panel,))


def test_a_matrix_has_its_numbers_in_the_cells():
    found = plotly_.as_dict(matrix_figure([[1.0, -0.5], [math.nan, 1.0]]))
    (trace,) = found["data"]
    assert trace["type"] == "heatmap"
    assert trace["text"] == [["1.00", "−0.50"], ["–", "1.00"]]
    assert trace["z"] == [[1.0, -0.5], [None, 1.0]]
    assert (trace["zmin"], trace["zmax"]) == (-1, 1)
    # the first row is at the top
    assert found["layout"]["yaxis"]["range"] == [1.5, -0.5]


def test_a_matrix_is_drawn_on_paper_with_its_numbers():
    (axes,) = matplotlib_.canvas(matrix_figure([[1.0, -0.5], [0.25, 1.0]])).axes
    assert [text.get_text() for text in axes.texts] == ["1.00", "−0.50", "0.25", "1.00"]
    assert axes.get_ylim() == (1.5, -0.5)
    assert len(axes.images) == 1


def test_numbers_below_the_axes_are_written_whole():
    figure = more_figures._profile_panel(
        ProfileRow("restitution", (0.79998, 0.80002), (4.0, 4.0), None, None),
        Unknown(value=0.8, u=1e-5, low=None, high=None, interval="normal"),
    )
    page = matplotlib_.canvas(Figure("p", "P", "C.", (figure,)))
    page.canvas.draw()
    assert page.axes[0].xaxis.get_offset_text().get_text() == ""


# the terminal


def test_the_command_says_how_far_the_fit_can_be_trusted_and_its_advice_works(call, tmp_path):
    asked = (
        "fit",
        "ball",
        "-r",
        str(MY_BALL),
        "--engine",
        "pymunk",
        "--no-report",
        "-o",
        str(tmp_path),
    )
    code, said, _ = call(*asked)
    words = " ".join(said.split())
    assert code == 0
    assert "The data cannot tell air drag from a restitution that depends on speed" in words
    assert "No drop was kept back (--hold-out), so the fit was not tested." in words
    assert "Value ± 95 %" in words
    assert "± 95 %: the true value lies in this range with 95 % probability" in words
    # two meanings of ± in one view: what stands in brackets is one u
    assert "u in brackets: 0.7969(48) means u = 0.0048" in words
    advice = re.search(r"such as (--fix \S+)\.", words)
    code, said, _ = call(*asked, *advice[1].split())
    assert code == 0
    assert "terminal speed" in said
    assert "cannot tell air drag" not in said
