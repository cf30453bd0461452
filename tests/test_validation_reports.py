"""Reports of simulations held against a recording."""

import re
import shutil
import subprocess
from dataclasses import replace

import pytest

from simcompare.inference.simulated import MOTION
from simcompare.reports import builder
from simcompare.reports.render import numbers
from simcompare.reports.render.tables import Column, Group, Table, printable, scale_of
from simcompare.reports.render.text_tables import lines
from simcompare.reports.run.replay import replay_of
from simcompare.reports.validation import parameter_tables, source, tables
from simcompare.results.run import Run
from tests import validated
from tests.validated import ENGINES, EVIL, cells, changed, hostile, plain, streams


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return validated.make(tmp_path_factory.mktemp("logs"))


@pytest.fixture(scope="module")
def fitted(made):
    return validated.run_of(made, "fitted")


@pytest.fixture(scope="module")
def judged(made):
    return validated.run_of(made, "known")


def html_of(run, tmp_path):
    return builder.write_html([run], tmp_path / "r.html").read_text(encoding="utf-8")


def without_scripts(html):
    return re.sub(r"<script.*?</script>", "", html, flags=re.DOTALL).replace("\u00a0", " ")


def figures(run):
    (block,) = builder.blocks_of([run])
    return {figure.name: figure for figure in block.figures}


# structure


def test_engines_are_seen_moving_on_the_fitted_recording(fitted, judged):
    for run in (fitted, judged):
        replay = replay_of(run)
        assert [actor.label for actor in replay.actors] == ENGINES.split(",")
        assert replay.time_s[-1] == pytest.approx(6.0, abs=0.02)
    # a few pictures a second, whatever the step: they cost little, and are no samples
    played = [one for one in fitted.trajectories if one.parameters == MOTION]
    assert all(len(one.trajectory.time_s) <= 1500 for one in played)
    assert MOTION not in set(fitted.samples()["parameters"])


def test_a_report_has_its_sections_and_no_address_to_fetch(fitted, tmp_path):
    html = html_of(fitted, tmp_path)
    for title in ("What is left", "Single values"):
        assert f"<h2>{title}</h2>" in html
    for title in ("What the gap is made of", "Parameters", "The recording", "How it was made"):
        assert f"{title}</" in html
    assert "<h1>Pendulum with friction against swing.csv – validation</h1>" in html
    own = without_scripts(html)
    assert not re.findall(r"(?:src|href)\s*=\s*[\"'](?!#|data:)", own)
    assert "@import" not in own
    assert "url(" not in own


@pytest.mark.parametrize("name", ["fitted", "judged"])
def test_every_figure_has_a_caption_and_axes_with_units(name, request):
    found = figures(request.getfixturevalue(name))
    assert {"overlay-angle_rad-1", "gap", "residual-angle_rad", "e-n"} <= set(found)
    for figure in found.values():
        assert figure.title
        assert figure.caption.endswith(".")
        for panel in figure.panels:
            if "E_n" in panel.x_label or "÷ u" in panel.x_label:
                continue  # numbers without a unit
            assert re.search(r"\((rad|s)\)", panel.x_label)
            assert panel.y_ticks is not None or "(°)" in panel.y_label


def test_sections_have_names_of_their_own(fitted):
    names = [part.name for part in builder.blocks_of([fitted])[0].parts]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("format", ["pdf", "md"])
def test_other_formats_are_written(fitted, tmp_path, format):
    write = {"pdf": builder.write_pdf, "md": builder.write_markdown}[format]
    content = write([fitted], tmp_path / f"r.{format}").read_bytes()
    assert content.startswith(b"%PDF" if format == "pdf" else b"# Pendulum")


def test_figures_are_written_for_a_paper(fitted, tmp_path):
    written = builder.write_figures([fitted], tmp_path, "svg")
    assert {path.stem.removeprefix("pendulum-") for path in written} == set(figures(fitted))


@pytest.mark.skipif(shutil.which("pdftotext") is None, reason="pdftotext is not installed")
def test_the_pdf_holds_the_numbers(fitted, tmp_path):
    path = builder.write_pdf([fitted], tmp_path / "r.pdf")
    text = subprocess.run(["pdftotext", "-layout", str(path), "-"], capture_output=True, check=True,
                          text=True).stdout  # fmt: skip
    row = plain(fitted)["parameters"][0]
    assert numbers.with_u(row["fitted"], row["u_fitted"]) in text
    assert plain(fitted)["provenance"]["sha256"] in text


def test_without_an_engine_the_recording_is_still_told(fitted, tmp_path):
    found = changed(fitted, waveforms=[], values=[], gaps=[], agreement=[],
                    sentences=["No engine ran, so nothing can be said."])  # fmt: skip
    rest = tuple(s for s in fitted.trajectories if s.source not in ENGINES.split(","))
    empty = replace(found, trajectories=rest)
    html = html_of(empty, tmp_path)
    assert "No engine ran" in html
    assert "What the gap is made of" not in without_scripts(html)
    assert "The recording</" in html
    builder.write_pdf([empty], tmp_path / "r.pdf")


# numbers


def as_number(text):
    return float(text.replace("−", "-"))


def test_waveforms_are_those_of_the_record(fitted):
    rows = cells(tables.waveforms(fitted))
    record = plain(fitted)["waveforms"]
    assert len(rows) == len({row["source"] for row in record})
    for engine, after, before, bias, largest, share, *_ in rows:
        own = {row["parameters"]: row for row in record if row["source"] == engine}
        last = own["fitted"]
        assert as_number(after) == pytest.approx(last["rmse"], rel=0.01)
        assert as_number(before) == pytest.approx(own["known before"]["rmse"], rel=0.01)
        assert as_number(bias) == pytest.approx(last["bias"], abs=1e-5)
        assert as_number(largest) == pytest.approx(last["max_abs"], rel=0.01)
        assert as_number(share) == pytest.approx(100 * last["nrmse"], abs=0.005)


def test_values_are_those_of_the_record(judged):
    table = tables.values(judged)
    record = plain(judged)["values"]
    assert len(cells(table)) == len(record)
    period = next(group for group in table.groups if group.title.startswith("mean period"))
    own = [row for row in record if row["measure"] == "mean_period"]
    assert numbers.with_u(own[0]["measured"], own[0]["u_data"]) in period.title
    power = re.search(r"in 10(\S+) s", period.title)
    factor = 1e-3 if power and power[1] == "⁻³" else 1.0
    for row, cell in zip(own, period.rows, strict=True):
        assert cell[1] == numbers.with_u(row["simulated"], row["u_simulated"])
        assert as_number(cell[2]) * factor == pytest.approx(row["error"], rel=0.01)
        assert as_number(cell[5]) == pytest.approx(row["e_n"], abs=0.005)
        assert cell[-1] == row["words"]


def test_digits_stand_below_each_other(fitted):
    for table in (tables.waveforms(fitted), *tables.gaps(fitted)):
        for group in table.groups:
            for i, column in enumerate(table.columns):
                texts = [row[i] for row in group.rows if re.fullmatch(r"−?[\d.]+", row[i])]
                places = {len(text.partition(".")[2]) for text in texts}
                assert column.text or len(places) <= 1


def test_shares_of_the_gap_add_up(fitted):
    sizes, shares = tables.gaps(fitted)
    record = plain(fitted)["gaps"]
    keys = ("parameter", "cross", "model_form", "numerical", "noise", "excess")
    for row, one in zip(cells(shares), record, strict=True):
        assert sum(map(as_number, row[1:-1])) == pytest.approx(100, abs=0.05)
        assert row[-1] == "100.00"
        own = [100 * one["shares"][key] for key in keys]
        assert list(map(as_number, row[1:-1])) == pytest.approx(own, abs=0.005)
    for row, one in zip(cells(sizes), record, strict=True):
        assert as_number(row[1]) == pytest.approx(one["total"], rel=0.01)


@pytest.mark.parametrize("write", [builder.write_html, builder.write_markdown])
def test_the_shares_of_the_gap_are_folded_and_in_every_format(fitted, tmp_path, write):
    _, shares = tables.gaps(fitted)
    assert shares.folded
    text = write([fitted], tmp_path / "r").read_text(encoding="utf-8")
    assert "How the parts add up (%)" in text
    assert "Too much noise" in text


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ((0.00601, 0.01099), ["0.00601", "0.01099"]),
        ((2.0, 31.4), ["2.00", "31.40"]),
        ((-4.2e-5, 3.1e-4), ["−42.0", "310.0"]),
        ((0.0, 1.0), ["0.00", "1.00"]),
        ((None, 2.5), ["–", "2.50"]),
    ],
)
def test_a_scale_gives_every_number_the_same_places(values, texts):
    scale = scale_of(values)
    assert [scale.text(value) for value in values] == texts


def test_what_rounds_to_nothing_has_no_sign():
    assert scale_of([1.0]).text(-1e-6) == "0.00"


def test_a_power_of_ten_stands_with_the_unit():
    scale = scale_of([2e-5])
    assert scale.unit("rad") == " (10⁻⁶ rad)"
    assert scale.unit("1") == " (10⁻⁶)"
    assert scale_of([2.0]).unit("1") == ""


def test_a_signal_of_nothing_but_noise_has_no_shares_of_its_range(fitted):
    heads = [column.head for column in tables.waveforms(fitted).columns]
    assert {"RMS ÷ range (%)", "Magnitude (%)", "Phase (%)"} <= set(heads)
    cases = plain(fitted)["cases"]
    cases[0]["probes"]["angle_rad"]["u"] = 1.0
    table = tables.waveforms(changed(fitted, cases=cases))
    assert not any("%" in column.head for column in table.columns)
    assert "nothing but" not in table.note
    assert "no more than its noise" in table.note
    assert all(len(row) == len(table.columns) for row in cells(table))


def test_names_and_units_stay_on_one_line(fitted, tmp_path):
    html = html_of(fitted, tmp_path)
    assert '<td class="words nowrap">N·m·s/rad</td>' in html
    assert "Known before\u00a0±\u00a0u" in html
    columns = (Column("a", text=True, nowrap=True), Column("b", text=True))
    row = ("torque constant of it", "words that may be broken")
    table = Table("", columns, (Group("", (row,)),))
    assert "torque constant of it" in "\n".join(lines(table, 40))


def test_engines_without_a_step_error_are_told_to_be_left_out(fitted):
    rows = plain(fitted)["agreement"]
    assert tables.agreement(fitted).note == ""
    rows[0]["left_out"] = ["dart"]
    note = tables.agreement(changed(fitted, agreement=rows)).note
    assert note == "Left out where no step error is known: dart."


# the recording


def test_a_stretch_that_was_cut_is_marked(fitted):
    cases = plain(fitted)["cases"]
    whole = source.segments(fitted)
    cases[0]["short"] = True
    cut = source.segments(changed(fitted, cases=cases))
    assert cells(cut)[0][2] == f"{cells(whole)[0][2]} (cut)"
    assert not whole.note
    assert cut.note.startswith("Cut: the log ends before")


def test_where_only_events_were_compared_no_table_is_empty(fitted):
    cases = plain(fitted)["cases"]
    cases[0]["probes"] = {}
    bare = changed(fitted, cases=cases, compare={})
    assert source.segments(bare) is None
    assert "compared" not in source.facts(bare)
    assert "compared" in source.facts(fitted)


def test_a_stretch_is_named_only_where_there_are_several(fitted):
    one, two = (tables.waveforms(streams(fitted, n)) for n in (1, 2))
    assert [group.title for group in one.groups] == ["Angle from hanging (rad)"]
    assert two.groups[0].title == "Angle from hanging, part 0 (rad)"


def test_repairs_are_told_with_their_rows(fitted):
    rows = [
        {"rule": "time_gaps", "severity": "warning", "text": "3 samples are missing",
         "stream": "log", "channel": "a", "rows": [[3, 5], [9, 9]], "count": 4,
         "before": {"max": 9.0}, "after": {"max": 1.0}},
        *({"rule": "paired", "severity": "info", "text": "as it should be", "stream": name,
           "channel": "t", "rows": [], "count": 0, "before": {}, "after": {}} for name in "abcdef"),
    ]  # fmt: skip
    provenance = {**plain(fitted)["provenance"], "repairs": rows}
    serious, harmless = source.repairs(changed(fitted, provenance=provenance))
    (row,) = cells(serious)
    assert row[0] == "left and marked"
    assert row[3] == "column a, rows 3–5, 9"
    assert row[4:] == ("4", "max 9 → 1")
    assert harmless.folded
    (row,) = cells(harmless)
    assert row[3] == "a, b, c, d and 2 more, column t"


def test_provenance_is_told(fitted, tmp_path):
    html = html_of(fitted, tmp_path)
    about = plain(fitted)["provenance"]
    for text in (about["sha256"], about["file"], str(about["size_bytes"]), about["importer"]):
        assert text in html


# names that mean harm


def test_hostile_names_are_harmless_in_html(fitted, tmp_path):
    html = html_of(hostile(fitted), tmp_path)
    assert "<script>alert" not in html
    assert "&lt;script&gt;alert(1)" in html
    builder.write_html([hostile(streams(fitted, 1))], tmp_path / "one.html")


def test_hostile_names_do_not_end_a_cell_of_markdown(fitted, tmp_path):
    text = builder.write_markdown([hostile(fitted)], tmp_path / "r.md").read_text(encoding="utf-8")
    assert "<script>" not in text.replace("\\<", "")
    heads = None
    for line in text.splitlines():
        if not line.startswith("|"):
            heads = None
            continue
        bars = len(re.findall(r"(?<!\\)\|", line))
        heads = heads or bars
        assert bars == heads


@pytest.mark.parametrize("format", ["pdf", "png", "svg"])
def test_hostile_names_are_drawn(fitted, tmp_path, format):
    bad = hostile(streams(fitted, 1))
    assert builder.write_figures([bad], tmp_path, format)
    assert builder.write_pdf([bad], tmp_path / "r.pdf").stat().st_size > 0


def test_hostile_names_do_not_steer_the_terminal(fitted):
    table = Table("", (Column("a", text=True), Column("b")), (Group(EVIL, ((EVIL, "1"),)),))
    text = "\n".join(lines(table, 80))
    assert "\x1b" not in text
    assert printable("a\nb\x1b[0m") == "a b [0m"


# the terminal


@pytest.mark.parametrize("width", [72, 80, 120])
def test_tables_fit_into_a_terminal(fitted, width):
    for table in (parameter_tables.parameters(fitted), tables.values(fitted)):
        for line in lines(table, width):
            assert len(line) <= width


def test_no_column_is_spared_in_a_narrow_terminal(fitted):
    table = parameter_tables.parameters(fitted)
    for width in (140, 60):
        shown = "\n".join(lines(table, width))
        assert re.search("made.*up so", shown)
        assert "0.2" in shown


def test_the_command_prints_tables_with_engines_as_rows(made, call, tmp_path):
    words = [
        "validate", "pendulum", "-r", made / "swing.csv", "--map", made / "known.yaml",
        "--engine", "pymunk", "-o", tmp_path, "--no-report",
    ]  # fmt: skip
    code, out, err = call(*words)
    assert code == 0, err
    assert re.search(r"^  pymunk +\d+\.\d°", out, re.MULTILINE)
    assert len(out.splitlines()) <= 30
    assert "made up so" not in out
    code, out, err = call(*words, "-v")
    assert re.search(r"^Angle from hanging \(rad\)$", out, re.MULTILINE)
    assert "made up so" in out


def test_a_run_that_was_stored_makes_the_same_report(fitted, tmp_path):
    from simcompare.results import store

    saved = store.save(fitted, tmp_path)
    again = store.load(saved.folder)
    assert isinstance(again, Run)
    first, second = figures(saved), figures(again)
    assert list(first) == list(second)
    for name, figure in first.items():
        assert figure.caption == second[name].caption
