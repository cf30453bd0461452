"""Reports: what stands in them, that they need nothing beside them, and how numbers are written."""

import errno
import json
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from simcompare import notation
from simcompare.comparison.comparison import Score
from simcompare.errors import OutputError, UnknownName
from simcompare.model.audit import AuditRow
from simcompare.model.trajectory import TRUTH, Trajectory
from simcompare.reports import builder
from simcompare.reports.render import numbers, output, plotly_
from simcompare.reports.run import reproduce, runs
from simcompare.reports.run.audit import state_of
from simcompare.reports.run.not_run import NotRun, not_run
from simcompare.results.records import stored as records
from simcompare.results.records.run import FORMAT
from simcompare.results.run import Run, Stored
from tests.records import with_source

EVIL = "<script>alert('x')</script> it broke | badly"
TOLERANCES = {
    "restitution": {"relative": 0.01, "absolute": None, "reason": "Because a class reads 1 %."},
    "settling_time": {"relative": None, "absolute": 0.1, "reason": "Because a watch reads 0.1 s."},
}


# tiny runs that no engine made


def source(name, contact, status="ok", reason=None, **more):
    ok = status == "ok"
    return {
        "name": name, "version": "1.2" if ok else None, "contact": contact, "status": status,
        "reason": reason, "steps": 100 if ok else None, "repeats": 3 if ok else 0,
        "wall_s": {"import": 0.1 if ok else None, "build": 0.003, "step": 0.3},
        "notes": [], "noise": "", "audit": [audit_row(contact)] if ok else [],
        "mapping": "restitution is translated", "known_limits": [], **more,
    }  # fmt: skip


def audit_row(contact):
    """What an engine that has no restitution of its own was given."""
    value = None if contact == "default" else 0.8
    return AuditRow("ball restitution", 0.8, "bounciness", value, value or 0.0, "1")


def trajectory(name, contact, height=1.0):
    time_s = np.linspace(0.0, 1.0, 101)
    z = np.abs(height * np.cos(4 * time_s))
    position = np.column_stack((z * 0, z * 0, z))
    return Trajectory(name, time_s, {"ball.position_m": position}, contact=contact)


def scores(name, contact, value, truth=0.8):
    default = contact == "default"
    found = []
    for measure, v, true in (("restitution", value, truth), ("settling_time", None, 4.0)):
        true = None if truth is None else true
        judged = not default and true is not None
        width = (0.008 if measure == "restitution" else 0.1) if judged else None
        good = judged and v is not None and abs(v - true) <= width
        verdict = ("pass" if good else "fail") if judged else "info"
        unit = "1" if measure == "restitution" else "s"
        found.append(
            Score(name, contact, measure, "height_m", None, v, 0.001, 0.0006, unit, 3, true, width,
                  verdict)
        )  # fmt: skip
    found += [
        Score(name, contact, "restitution", "height_m", k, value, 0.001, 0.0006, "1", 3, truth,
              None, "info")
        for k in (1, 2)
    ]  # fmt: skip
    return found


def make_run(sources=None, *, truth=0.8, against=None, interrupted=False, **more):
    """A run of the engines given as (name, mode, value), a value of None for one that failed."""
    sources = sources or [("north", "default", 0.0), ("north", "assisted", 0.801)]
    ok = [row for row in sources if row[2] is not None]
    found = [s for name, mode, value in ok for s in scores(name, mode, value, truth)]
    stored = [Stored(n, m, i, trajectory(n, m)) for n, m, _ in ok for i in range(3)]
    if truth is not None:
        stored += [Stored(TRUTH, "", i, trajectory(TRUTH, "")) for i in range(3)]
    record = {
        "kind": "run", "format": FORMAT, "run": None, "created": "2026-01-01T00:00:00+00:00",
        "scenario": "toy",
        "title": "A toy <scene>", "question": "Does it bounce & rest?",
        "parameters": {"drop_height_m": 1.0, "gravity_m_s2": 9.81},
        "parameter_texts": {"drop_height_m": "Height of the drop."},
        "step_s": 0.01, "duration_s": 1.0, "repeats": 3, "seed": 0, "preset": None,
        "dither": {"parameter": "drop_height_m", "span": 0.004, "count": 3, "reason": "Phases."},
        "truth": TRUTH if truth is not None else None,
        "probes": {"height_m": {"observe": "ball.position_m", "component": 2, "offset": 0.0,
                                "label": "Height", "unit": "m"}},
        "tolerances": TOLERANCES, "scenario_sha256": "0" * 64, "engines_asked": "all",
        "scenario_asked": "toy", "against_asked": "ball.csv" if against else None,
        "software": {"simcompare": "0.1.0", "python": "3.11", "numpy": None},
        "machine": {"system": "Linux", "processor": "CPU", "python_implementation": "cpython"},
        "sources": [
            source(n, m) if v is not None else source(n, m, "failed", EVIL) for n, m, v in sources
        ],
        "against": against, "interrupted": interrupted, "scores": [vars(one) for one in found],
        **more,
    }  # fmt: skip
    return Run(records.of_plain(record), tuple(stored))


def match(name, mode, value, inside, bounce=1, **more):
    return {
        "source": name, "contact": mode, "quantity": "rebound_height", "bounce": bounce,
        "value": value, "scatter": None if value is None else 0.001,
        "measured": 0.6, "u_measured": 0.01, "low": 0.58, "high": 0.62, "unit": "m",
        "inside": inside, "e_n": None if value is None else (value - 0.6) / 0.02, **more,
    }  # fmt: skip


def measured(*matches):
    head = {
        "title": "A measured ball",
        "citation": "A. Author, J. Phys. 1 (2020) 2",
        "url": "https://example.org/paper",
        "seen": "in the abstract",
        "note": "One ball.",
    }
    return {
        "file": "ball.csv",
        "sha256": "0",
        "head": head,
        "parameters": {},
        "caution": None,
        "matches": matches,
    }


AGAINST = measured(match("north", "default", None, False), match("north", "assisted", 0.61, True))
RUNS = {
    "both modes": make_run(),
    "default only": make_run([("north", "default", 0.0), ("south", "default", 0.5)]),
    "assisted only": make_run([("north", "assisted", 0.8)]),
    "no truth": make_run(truth=None),
    "against": make_run(against=AGAINST),
    "one failed": make_run([("north", "assisted", 0.9), ("south", "assisted", None)]),
    "nothing ran": make_run([("north", "default", None), ("north", "assisted", None)]),
    "no tolerances": make_run(tolerances={}),
    "no probes": make_run(probes={}),
    "no gravity": make_run(parameters={"drop_height_m": 1.0}),
}


@pytest.fixture(params=RUNS)
def run(request):
    return RUNS[request.param]


@pytest.fixture
def html(tmp_path):
    def write(*found):
        path = builder.write_html(found, tmp_path / "report.html")
        # the script of the figures is the same in every report and is not of interest here
        return path.read_text(encoding="utf-8").replace(plotly_.script(), "")

    return write


def titles(run):
    return [part.name for part in builder.blocks_of([run])[0].parts]


# numbers


@pytest.mark.parametrize(
    ("value", "u", "text"),
    [
        (0.7999771, 7.1287e-5, "0.799977 ± 0.000071"),
        (0.80000758, 1.9355e-6, "0.8000076 ± 0.0000019"),
        (1.36134e-5, 1.7898e-6, "(1.36 ± 0.18)·10⁻⁵"),
        (3.92944, 0.0024037, "3.9294 ± 0.0024"),
        (0.6724, 0.3612, "0.67 ± 0.36"),
        (4567.0, 123.0, "4570 ± 120"),
        (0.5, 0.0996, "0.50 ± 0.10"),
        (-2.286e-5, 7.1287e-5, "(−2.3 ± 7.1)·10⁻⁵"),
        (3.929, 0.0, "3.929"),
        (0.0, 0.0, "0"),
        (0.8, None, "0.8"),
        (2.5e6, 1.0e4, "(2.500 ± 0.010)·10⁶"),
        (None, None, "–"),
        (float("nan"), 0.1, "–"),
        (1.0, float("nan"), "1"),
    ],
)
def test_value_with_its_uncertainty(value, u, text):
    assert numbers.with_u(value, u) == text


def test_rounding_of_the_truth_counts_as_nothing():
    assert numbers.with_u(-6.7e-16, 7.3e-16, scale=0.88) == "0"


def test_units_stand_behind_brackets():
    assert numbers.with_u(1.234, 0.02, "s") == "(1.234 ± 0.020) s"
    assert numbers.with_u(1.2e-5, 1e-6, "m") == "(1.20 ± 0.10)·10⁻⁵ m"
    assert numbers.with_u(1.5, None, "m") == "1.5 m"


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (18.0, 6, "18"), (0.0, 6, "0"), (99.9, 2, "100"), (0.00012, 3, "1.2·10⁻⁴"),
        (-1.5, 6, "−1.5"), (41550.0, 6, "41550"), (-9993004896.57, 6, "−9.993·10⁹"),
        (0.001, 6, "0.001"), (None, 6, "–"),
    ],
)  # fmt: skip
def test_numbers_alone(value, digits, text):
    assert numbers.plain(value, digits) == text


@pytest.mark.parametrize(
    ("value", "u", "tolerance", "text"),
    [
        (1.953602, None, 0.0059, "1.9536"), (-2.538e-5, None, 0.01, "0"),
        (11.50189, None, 0.0144, "11.502"), (123.456, None, None, "123.5"),
        (0.0, None, 0.1, "0"), (None, None, 0.1, "–"), (0.8, 7e-5, 0.0016, "0.8000"),
        (0.79834, 0.00112, 0.0016, "0.7983 ± 0.0011"), (0.79834, 3e-4, 0.0016, "0.7983 ± 0.0003"),
        (1.234e-9, None, 2e-11, "1.234·10⁻⁹"), (9.876e9, None, 0.01, "9.876·10⁹"),
    ],
)  # fmt: skip
def test_digits_of_a_value_follow_its_tolerance(value, u, tolerance, text):
    assert numbers.with_u(value, u, digits=4, places=notation.places(tolerance)) == text


def test_a_number_is_rounded_before_its_power_is_taken():
    assert numbers.plain(9.99e-10, 2) == "1·10⁻⁹"


def test_dust_beside_the_tolerance_is_nothing():
    run = make_run([("north", "assisted", 0.8)], truth=0.0)
    score = Score(
        "north", "assisted", "settling_time", "", None, 4.7e-14, None, None, "s", 1, 1e-14, 0.1,
        "pass",
    )  # fmt: skip
    assert runs.value_words(run, score) == "0"
    assert runs.share_of_tolerance(run, score) == 0


# what leads


def test_what_is_measured_first_leads_and_not_what_has_the_first_tolerance():
    tolerances = dict(reversed(TOLERANCES.items()))
    run = make_run(tolerances=tolerances)
    assert runs.judged(run) == runs.measures(run) == ["restitution", "settling_time"]
    without = make_run(tolerances={"settling_time": TOLERANCES["settling_time"]})
    assert runs.measures(without) == ["settling_time", "restitution"]


# HTML


def test_every_kind_of_run_makes_every_kind_of_report(run, tmp_path):
    builder.write_html([run], tmp_path / "r.html")
    text = builder.write_markdown([run], tmp_path / "r.md").read_text(encoding="utf-8")
    assert text.startswith("# A toy \\<scene\\>")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["r.html", "r.md"]


def test_figures_hold_valid_json_without_nan(run, html):
    found = re.findall(r'<script type="application/json">(.*?)</script>', html(run), re.DOTALL)
    assert len(found) == len(builder.blocks_of([run])[0].figures)
    for text in found:
        json.loads(text, parse_constant=lambda name: pytest.fail(name))


def test_nothing_is_loaded_from_anywhere(html):
    text = html(make_run(against=AGAINST))
    assert not re.findall(r'\ssrc\s*=\s*["\']?', text)
    assert not re.findall(
        r"<(?:link|img|iframe|object|embed)\b(?! rel=\"icon\" href=\"data:,\")", text
    )
    assert not re.findall(r"@import|url\(", text)
    assert re.findall(r'https?://[^"<]*', re.sub(r'<a href="[^"]*">[^<]*</a>', "", text)) == []
    assert '<a href="https://example.org/paper">' in text


def test_a_link_that_is_no_web_address_is_not_a_link(html):
    against = json.loads(json.dumps(AGAINST))
    against["head"]["url"] = "javascript:alert(1)"
    assert 'href="javascript' not in html(make_run(against=against))


def test_plotly_is_inlined_once_and_not_imported(tmp_path):
    path = builder.write_html([make_run(), make_run()], tmp_path / "r.html")
    text = path.read_text(encoding="utf-8")
    assert text.count(plotly_.script()) == 1
    assert "</script" not in plotly_.script()


def test_html_needs_no_heavy_package(tmp_path):
    import subprocess
    import sys

    code = (
        "import sys; from tests.test_reports import make_run; from pathlib import Path;"
        "from simcompare.reports import builder;"
        f"builder.write_html([make_run()], Path({str(tmp_path / 'r.html')!r}));"
        "heavy = ('pandas', 'plotly', 'matplotlib', 'duckdb', 'scipy');"
        "print([name for name in heavy if name in sys.modules])"
    )
    root = Path(__file__).parent.parent
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_reports_of_fits_load_nothing_of_validations():
    import subprocess
    import sys

    code = (
        "import sys; import simcompare.verbs.fit; from simcompare.cli import fit_tables;"
        "from simcompare.reports.sections import fits;"
        "theirs = ('simcompare.results.records.validation', 'simcompare.verbs.fit_tosses',"
        " 'simcompare.hardware.sensors.drive_mistakes', 'scipy.stats', 'scipy.optimize');"
        "print([name for name in theirs if name in sys.modules])"
    )
    root = Path(__file__).parent.parent
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_text_from_outside_is_escaped(html):
    text = html(RUNS["one failed"])
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert(&#39;x&#39;)&lt;/script&gt; it broke" in text
    assert "<h1>A toy &lt;scene&gt; – run</h1>" in text


def test_engine_that_failed_is_a_row_with_its_reason(html):
    run = make_run([("north", "assisted", 0.8), ("south", "assisted", None)])
    assert not_run(run) == [NotRun("south", "assisted", "failed", EVIL)]
    assert html(run).count("it broke") >= 3  # scoreboard, scores, what each was given


def test_verdicts_are_words_and_symbols(html):
    text = html(make_run([("north", "assisted", 0.801), ("south", "assisted", 0.9)]))
    assert "✓ pass" in text
    assert "✗ fail" in text
    assert "Because a class reads 1 %." in text


def test_default_is_shown_and_not_judged(html):
    text = html(RUNS["default only"])
    assert "tolerances met" not in text
    assert "<td" in text
    assert "✓" not in text


def test_an_engine_agrees_with_a_measurement_and_is_never_called_validated(html):
    text = html(make_run(against=AGAINST))
    assert "By default, as it comes: north does not agree with the measurement." in text
    assert "Assisted, with our helps: north agrees with the measurement." in text
    assert "validated" not in text.lower()
    for fact in ("A. Author, J. Phys. 1 (2020) 2", "in the abstract", "One ball.", "0.58 … 0.62"):
        assert fact in text


def test_sections_without_data_are_left_out():
    assert titles(RUNS["both modes"]) == [
        "answer", "events", "energy", "contrast", "signals", "scores", "given", "setup",
    ]  # fmt: skip
    assert "measurement" in titles(RUNS["against"])
    assert "energy" not in titles(RUNS["no gravity"])
    assert "energy" not in titles(RUNS["no probes"])
    assert "contrast" not in titles(RUNS["no truth"])
    assert "events" not in titles(RUNS["no truth"])
    assert "scores" not in titles(RUNS["nothing ran"])


def test_further_probes_have_a_section_of_their_own():
    probes = make_run().record.probes
    second = probes["height_m"].model_copy(update={"label": "Sideways", "component": 0})
    run = make_run(probes={**probes, "side_m": second})
    assert [f.name for f in builder.blocks_of([run])[0].part("signals").figures] == [
        "probe-height_m",
        "probe-side_m",
    ]
    leading = builder.blocks_of([run])[0].figures[:2]
    assert [figure.name for figure in leading] == ["answer", "motion-height_m"]
    # at one level the motion is seen already
    alone = make_run([("north", "assisted", 0.8)], probes=run.record.probes)
    (figure,) = builder.blocks_of([alone])[0].part("signals").figures
    assert figure.name == "probe-side_m"


def test_most_of_many_signals_are_folded_away(html):
    probe = make_run().record.probes["height_m"]
    probes = {f"p{i}_m": probe.model_copy(update={"label": f"Signal {i}"}) for i in range(6)}
    text = html(make_run(probes=probes))
    assert "<details><summary>The same for Signal 2; Signal 3; Signal 4; Signal 5</summary>" in text
    assert len(re.findall(r'id="run1-figure-probe-p\d_m"', text)) == 6


def test_scores_speak_of_the_truth_only_where_there_is_one(html):
    assert "Deviations are from the closed form" in html(make_run())
    assert "Deviations are from" not in html(make_run(truth=None))


def test_several_runs_have_a_block_each(html):
    text = html(RUNS["both modes"], RUNS["against"])
    assert '<article id="run1">' in text
    assert '<article id="run2">' in text
    assert '<a href="#run2">' in text
    anchors = re.findall(r'\bid="([^"]+)"', text)
    assert len(anchors) == len(set(anchors))
    for target in re.findall(r'href="#([^"]+)"', text):
        assert target in anchors


def test_every_section_has_a_name_of_its_own():
    for run in RUNS.values():
        assert len({*titles(run)}) == len(titles(run))


# what the engines were given


@pytest.mark.parametrize(
    ("wanted", "given", "held", "state"),
    [
        (0.8, 0.8, 0.8, "same"), (0.8, None, 0.0, "unset"), (0.8, 1.0, 1.0, "translated"),
        (0.8, 0.8, None, "unread"), (None, 1e-9, 1e-9, "same"), (0.0, 0.0, 0.0, "same"),
        (0.1, 0.1, 0.10000000000000001, "same"), (0.0, None, None, "unset"),
    ],
)  # fmt: skip
def test_audit_tells_own_values_from_translated_ones(wanted, given, held, state):
    row = AuditRow("ball restitution", wanted, "bounciness", given, held, "1")
    assert state_of(row) == state


def test_what_was_left_without_a_getter_is_told_in_its_note_and_comes_first(html):
    unread = replace(audit_row("default"), read_value=None, note="its motor was left on")
    rows = (
        replace(unread, quantity="contact", scenario_value=None, note="left at 0.04"),
        replace(unread, quantity="wheel.friction"),
    )
    run = with_source(make_run([("north", "default", 0.0)]), 0, audit=rows)
    left, *_ = builder.blocks_of([run])[0].part("given").tables
    assert [row[2] for row in left.groups[0].rows] == ["wheel.friction", "contact"]
    assert html(run).count("its motor was left on") == 2


# the figures


def test_measurement_of_one_event_is_a_band_and_of_several_are_points():
    one = builder.blocks_of([make_run(against=AGAINST)])[0].part("measurement").figures[0]
    assert one.panels[1].bands[0].centre == 0.6
    assert one.panels[0].x_ticks == ("north\n(none)",)
    rows = [match("north", mode, 0.6, True, k) for mode in ("default", "assisted") for k in (1, 2)]
    run = make_run(against=measured(*rows))
    several = builder.blocks_of([run])[0].part("measurement").figures[0]
    row, engine = several.panels[0].series
    assert row.label == "measured"
    assert row.u == pytest.approx(100 * 0.02 / 0.6)
    assert engine.y == pytest.approx(0.0)


def test_contrast_is_in_tolerances_and_has_no_zero():
    run = make_run([("north", "default", 0.8), ("north", "assisted", 0.816)])
    figure = builder.blocks_of([run])[0].part("contrast").figures[0]
    default, assisted = (panel.series[0].y for panel in figure.panels)
    assert default[0] == pytest.approx(1e-3)
    assert assisted[0] == pytest.approx(2.0)
    assert np.isnan(assisted[1])  # the rest time was not measured


def test_motion_shows_truth_below_the_engines_at_every_level_on_one_axis():
    run = make_run()
    (figure,) = builder.blocks_of([run])[0].part("signals").figures
    assert figure.share_y
    assert [panel.title for panel in figure.panels] == [
        "by default, as it comes",
        "assisted, with our helps",
    ]
    assert [series.label for series in figure.panels[1].series] == [f"truth ({TRUTH})", "north"]


def test_the_answer_shows_the_motion_of_the_engines_by_themselves():
    run = make_run([("north", mode, 0.8) for mode in ("default", "tuned", "assisted")])
    figure = builder.blocks_of([run])[0].figures[1]
    assert [panel.title for panel in figure.panels] == [
        "by default, as it comes", "tuned, in a plain loop",
    ]  # fmt: skip


def test_a_solid_line_is_drawn_below_dashed_ones():
    run = make_run([("dart", "tuned", 0.8), ("box2d", "tuned", 0.8)])
    (panel,) = builder.blocks_of([run])[0].figures[1].panels
    dashes = {series.label: series.style.dash for series in panel.series}
    assert (dashes["box2d"], dashes["dart"]) == ("solid", "dash")
    assert [*dashes] == [f"truth ({TRUTH})", "box2d", "dart"]


def test_figures_are_files(tmp_path):
    found = builder.write_figures([RUNS["no gravity"]], tmp_path / "new" / "folder", "pdf")
    assert [path.name for path in found] == [
        f"toy-{name}.pdf"
        for name in (
            "answer",
            "motion-height_m",
            "events-restitution",
            "contrast",
            "probe-height_m",
        )
    ]
    assert all(path.stat().st_size > 1000 for path in found)


def test_figures_of_several_runs_do_not_overwrite_each_other(tmp_path):
    found = builder.write_figures([RUNS["no truth"]] * 2, tmp_path, "svg")
    assert len({path.name for path in found}) == len(found) == 8


def test_unknown_figure_format_is_named(tmp_path):
    with pytest.raises(UnknownName, match="did you mean svg"):
        builder.write_figures([make_run()], tmp_path, "svgz")


# Markdown


def test_markdown_tables_are_whole(tmp_path):
    run = make_run(
        [("north", "default", 0.0), ("north", "assisted", 0.801), ("so|uth", "assisted", None)]
    )
    lines = builder.write_markdown([run], tmp_path / "r.md").read_text("utf-8").splitlines()
    columns = [len(re.findall(r"(?<!\\)\|", line)) for line in lines]
    for i, line in enumerate(lines):
        if line.startswith("|---"):
            block = columns[i - 1 : i + 2]
            assert len(set(block)) == 1, lines[i - 1 : i + 2]
    assert any("0.8010 ± 0.0010 |" in line and "✓ pass" in line for line in lines)
    assert not any("<script>" in line for line in lines)


# the command


def test_command_names_everything_of_a_scenario_that_is_gone():
    assert reproduce.command(make_run(preset="soft ball")) == (
        "simcompare run toy --engine all --contact default,assisted --preset 'soft ball'"
        " --set drop_height_m=1.0 --set gravity_m_s2=9.81 --step 0.01s --seeds 3"
    )


def test_command_names_only_what_differs_from_a_known_scenario():
    import hashlib

    from simcompare.scenarios import catalogue

    name = catalogue.names()[0]
    file = catalogue.load(name)
    own = file.resolve()
    known = {
        "scenario": name,
        "scenario_asked": name,
        "scenario_sha256": hashlib.sha256(file.path.read_bytes()).hexdigest(),
        "step_s": own.world.step_s,
        "repeats": own.dither.count if own.dither else 1,
    }
    run = make_run(parameters=dict(own.parameters), **known)
    assert (
        reproduce.command(run) == f"simcompare run {name} --engine all --contact default,assisted"
    )
    first = next(iter(own.parameters))
    run = make_run(parameters={**own.parameters, first: 0.123}, **known)
    assert reproduce.command(run).endswith(f"--set {first}=0.123")


@pytest.mark.parametrize("asked", ["itf_tennis_rebound", "'../my data/ball.csv'"])
def test_command_names_scenario_and_table_as_they_were_asked_for(asked):
    more = {"scenario_asked": "mine/toy", "against_asked": asked.strip("'")}
    command = reproduce.command(make_run(against=AGAINST, **more))
    assert command.startswith("simcompare run mine/toy ")
    assert command.endswith(f" --against {asked}")


# files


def test_full_disk_leaves_nothing_behind_and_keeps_the_old_report(tmp_path, monkeypatch):
    path = tmp_path / "report.html"
    (tmp_path / "run.json").touch()
    path.write_text("the old one", encoding="utf-8")

    def full(self, content):
        self.open("wb").close()
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(
        OutputError, match=r"report\.html.*No space left on device.*nothing was kept"
    ):
        builder.write_html([make_run()], path)
    assert {p.name for p in tmp_path.iterdir()} == {"report.html", "run.json"}
    assert path.read_text(encoding="utf-8") == "the old one"


def test_folder_that_is_a_file_is_an_output_error(tmp_path):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match="cannot be written"):
        output.write(tmp_path / "file" / "report.html", b"content", b"content")


def test_missing_plotly_is_a_sentence_with_its_cure(monkeypatch):
    plotly_.script.cache_clear()
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(OutputError, match="pip install plotly"):
        plotly_.script()


def test_a_report_replaces_no_device_and_follows_a_link(tmp_path):
    os.mkfifo(tmp_path / "pipe.md")
    with pytest.raises(OutputError, match="is no file, and is left as it is"):
        builder.write_markdown([make_run()], tmp_path / "pipe.md")
    assert (tmp_path / "pipe.md").is_fifo()
    (tmp_path / "real.md").write_text("")
    (tmp_path / "link.md").symlink_to(tmp_path / "real.md")
    builder.write_markdown([make_run()], tmp_path / "link.md")
    assert (tmp_path / "link.md").is_symlink()
    assert "A toy" in (tmp_path / "real.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("format", ["html", "md", "pdf", "png", "svg"])
def test_a_report_replaces_its_like_and_nothing_else(tmp_path, format):
    def write(name):
        if format in ("png", "svg"):
            return builder.write_figures([make_run()], tmp_path / name, format)
        writers = {"html": builder.write_html, "md": builder.write_markdown}
        return [writers.get(format, builder.write_pdf)([make_run()], tmp_path / name)]

    files = write("report")
    assert write("report") == files  # also the second time
    for theirs in (b"precious", b"<html>my page of simcompare</html>"):
        files[0].write_bytes(theirs)
        with pytest.raises(OutputError, match="is another file, and is left as it is; choose an"):
            write("report")
        assert files[0].read_bytes() == theirs


def test_an_old_report_in_the_folder_of_a_run_is_replaced(tmp_path):
    (tmp_path / "run.json").write_text("{}")
    (tmp_path / "report.pdf").write_bytes(b"%PDF of an older version")
    builder.write_pdf([make_run()], tmp_path / "report.pdf")
    assert b"/Creator (simcompare)" in (tmp_path / "report.pdf").read_bytes()


def test_a_command_asks_for_no_level_that_cannot_be_judged_alone():
    assert "--judge" not in reproduce.command(make_run(judge=["assisted", "fitted"]))
    assert "--judge tuned" in reproduce.command(make_run(judge=["tuned", "assisted"]))
