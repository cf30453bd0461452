"""The face of a report: what is seen first, and what is folded."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from simcompare.model.audit import AuditRow
from simcompare.reports import builder
from simcompare.reports.render import plotly_
from simcompare.reports.render.parts import Block, KeyNumber, Part
from simcompare.reports.render.tables import Column, Table
from simcompare.reports.run.settings import settings
from tests.records import changed, with_sources
from tests.test_reports import RUNS, make_run

ENGINES = ("box2d", "dart", "mujoco", "ode", "pybullet", "pymunk", "rapier")
LEVELS = ("default", "tuned", "assisted")
#: what is no content of a report
HIDDEN = ("script", "style", "title", "noscript", "svg", "button", "footer")


class Reader(HTMLParser):
    """The words of a page: all of them, those that are not folded, and those above a figure."""

    def __init__(self):
        super().__init__()
        self.all, self.unfolded, self.first = [], [], None
        self._hidden, self._folds, self._summary = 0, 0, 0

    def handle_starttag(self, tag, attrs):
        self._hidden += tag in HIDDEN
        self._folds += tag == "details"
        self._summary += tag == "summary"
        if tag == "figure" and self.first is None:
            self.first = len(self.unfolded)

    def handle_endtag(self, tag):
        self._hidden -= tag in HIDDEN
        self._folds -= tag == "details"
        self._summary -= tag == "summary"

    def handle_data(self, data):
        words = [] if self._hidden else data.split()
        self.all += words
        if self._folds <= self._summary:
            self.unfolded += words


def page(*blocks):
    return builder.html_of(blocks).replace(plotly_.script(), "")


def read(*runs):
    reader = Reader()
    reader.feed(page(*builder.blocks_of(runs)))
    return reader


def ball():
    """A run as large as that of a bouncing ball in every engine."""
    values = {"default": 0.0, "tuned": 0.79, "assisted": 0.801}
    return make_run([(name, level, values[level]) for name in ENGINES for level in LEVELS])


def block(*parts):
    return Block("b1", "toy", "A toy – run", "Does it?", "", "1", (Part(short=("Yes.",)), *parts))


# one screen of answer


def test_few_words_stand_before_the_first_figure_and_few_are_not_folded():
    reader = read(ball())
    assert reader.first <= 100
    assert len(reader.unfolded) <= 800
    assert len(reader.all) > 2 * len(reader.unfolded)


@pytest.mark.parametrize("name", RUNS)
def test_all_but_the_answer_and_a_measurement_is_folded(name):
    answer, *others = builder.blocks_of([RUNS[name]])[0].parts
    assert answer.short
    assert not answer.folded
    open_ = {part.name for part in others if not part.folded}
    assert open_ <= {"measurement"}
    assert all(part.finding for part in others if part.folded)


def test_a_short_answer_and_a_figure_come_before_the_table_and_the_sentences():
    answer = builder.blocks_of([ball()])[0].parts[0]
    kinds = [kind for kind, _ in answer.items]
    order = ["short", "numbers", "figure", "table", "answer", "remark"]
    assert [kinds.index(kind) for kind in order] == sorted(map(kinds.index, order))


def test_an_answer_without_a_short_one_stays_above_its_figure():
    table = Table("", (Column("a"),), ())
    part = Part(answer=("So it is.",), tables=(table,), remarks=("And so on.",))
    assert [kind for kind, _ in part.items] == ["answer", "remark", "table"]


def test_the_verdict_of_a_number_is_a_sign_and_not_a_colour_alone():
    numbers = (KeyNumber("tuned", "0.79", "0 of 7", "fail"), KeyNumber("truth", "0.8"))
    html = page(block(Part("Inner", "inner", key_numbers=numbers)))
    assert re.search(r'0\.79 <span class="fail">✗</span>', html)
    assert html.count("✗") == 1


def test_markdown_begins_with_the_same_and_leaves_out_what_few_want(tmp_path):
    text = builder.write_markdown([make_run()], tmp_path / "r.md").read_text(encoding="utf-8")
    answer = builder.blocks_of([make_run()])[0].parts[0]
    places = [
        text.index(word) for word in ("# A toy", answer.short[0], "- assisted: **", "| engine")
    ]
    assert places == sorted(places)
    assert "## What each engine was given" not in text


# how it was made


def test_the_title_says_what_kind_it_is_and_the_line_below_what_was_asked():
    (one,) = builder.blocks_of([make_run()])
    assert one.title == "A toy <scene> – run"
    assert one.settings == ("Drop height 1 m, gravity 9.81 m/s², north, step 10 ms, 2026-01-01")
    assert "Engines: north 1.2." in one.made_with


def test_the_settings_count_the_engines_that_ran_and_tell_the_steps_they_took():
    rows = [(name, "tuned", 0.8) for name in ("a", "b", "c", "d")]
    run = make_run([*rows, ("e", "tuned", None)])
    taken = [(AuditRow("engine step_s", 0.001, "dt", step_s, step_s, "s"),)
             for step_s in (5e-5, 1e-4, 1e-3, 1e-3)]  # fmt: skip
    run = with_sources(run, audit=[*taken, ()])
    assert ", 4 engines, steps 0.05 to 1 ms, " in settings(run)
    assert ", no engine ran, step 10 ms, " in settings(make_run([("a", "tuned", None)]))


def test_parameters_that_are_the_scenarios_own_are_not_named():
    import hashlib

    from simcompare.scenarios import catalogue

    file = catalogue.load(catalogue.names()[0])
    digest = hashlib.sha256(file.path.read_bytes()).hexdigest()
    known = {"scenario_asked": catalogue.names()[0], "scenario_sha256": digest}
    parameters = dict(file.resolve().parameters)
    (one,) = builder.blocks_of([make_run(parameters=parameters, **known)])
    assert one.settings.startswith("Default parameters, ")


# what is folded


def test_what_is_folded_says_what_is_found_in_it():
    html = page(block(Part("Energy", "energy", folded=True, finding="none is lost")))
    assert '<details id="b1-energy" class="section"><summary><h2>Energy</h2>' in html
    assert '<span class="finding">none is lost</span></summary>' in html


def test_the_helps_name_what_they_change_most():
    findings = {p.name: p.finding for p in builder.blocks_of([ball()])[0].parts}
    assert findings["scores"] == (
        "tuned 0 of 14 within the tolerance, assisted 7 of 14 within the tolerance"
    )
    assert findings["given"] == "21 values, 7 of them the engine's own"


# what drives a scene


def driven(**signals):
    """A run in which actuators did this."""
    run = make_run([("north", "tuned", 0.8)])
    trajectory = replace(run.trajectories[0].trajectory, signals=signals)
    return replace(run, trajectories=tuple(replace(one, trajectory=trajectory)
                                           for one in run.trajectories))  # fmt: skip


def test_what_drives_a_scene_is_drawn_once_for_what_does_the_same():
    rising, still = np.linspace(0.0, 1.0, 101), np.full(101, 6.0)
    run = driven(
        **{"left.torque_N_m": rising, "right.torque_N_m": rising, "motor.voltage_V": still,
           "motor.torque_N_m": rising, "cell.force_N": np.zeros((101, 3))}
    )  # fmt: skip
    part = builder.blocks_of([run])[0].part("drive")
    torque, voltage = part.figures[0].panels
    assert [series.label for series in torque.series] == ["Left and right"]
    assert [series.label for series in voltage.series] == ["Motor"]
    assert part.finding == "torque of the left and right; voltage of the motor: 6 V, constant"
    assert not part.folded


def test_a_constant_drive_is_told_and_folded():
    part = builder.blocks_of([driven(**{"push.force_N": np.full(101, 0.5)})])[0].part("drive")
    assert part.folded
    assert part.finding == "force of the push: 0.5 N, constant"


def test_nothing_drives_what_falls():
    assert "drive" not in {part.name for part in builder.blocks_of([make_run()])[0].parts}


def test_a_value_of_an_event_has_no_digits_of_rounding():
    run = make_run()
    times = {"unit": "s", "value": 0.4516165045072, "truth": 0.4516}
    scatters = {"default": 0.00031, "assisted": 4e-12}
    scores = [
        replace(one, measure="impact_time", scatter=scatters[one.contact], **times)
        for one in run.record.scores
        if one.index == 1
    ]
    part = next(p for p in builder.blocks_of([changed(run, scores=tuple(scores))])[0].parts
                if p.name == "events")  # fmt: skip
    (table,) = part.parts[-1].tables
    assert table.groups[0].rows == (("1", "0.45162 ± 0.00031", "0.451617"),)


def test_no_name_steers_or_turns_what_a_page_shows():
    """A page with NUL or with half of a pair of surrogates could not be read or written."""
    evil = "a\x00\x1b[31m\x9b\u202eb\u200b\udc80"
    found = page(*builder.blocks_of([changed(make_run(), title=evil, question=evil)]))
    found.encode()
    assert "a\ufffd\ufffd[31m\ufffd\ufffdb\ufffd\ufffd" in found
    assert not set(evil) - set("a[31mb") & set(found)
