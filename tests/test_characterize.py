"""The verb characterize: its page, its JSON, its table, what it keeps and what it refuses."""

import json
import math
import re
from dataclasses import replace

import pytest

import simcompare
from simcompare.characterization.behaviour import (
    BounceBehaviour,
    ForceBehaviour,
    FrictionBehaviour,
    JointBehaviour,
    Spread,
)
from simcompare.characterization.force import CASES
from simcompare.engine.calibration import cache
from simcompare.model.plain import of_plain, plain
from simcompare.model.settings import CONTACT_LEVELS
from simcompare.notation import capital
from simcompare.reports import builder
from simcompare.reports.characterization import bounce_figures, findings, words
from simcompare.reports.characterization import page as characterized
from simcompare.reports.characterization import tables as characterized_tables
from simcompare.reports.render import numbers, text_tables
from simcompare.reports.render.figures import MAX_PANELS
from simcompare.results.records.characterization import Characterization, Trial
from simcompare.results.records.run import Software
from simcompare.verbs import characterize
from tests.present import need

#: an engine that is not on this machine
ABSENT = """
from simcompare.errors import EngineMissing
class Absent:
    name = "absent"
    features, known_limits, mapping = frozenset(), (), ""
    def version(self):
        raise EngineMissing("absent", "absentlib", "pip install absentlib")
    def open(self, scenario, settings):
        raise NotImplementedError
    simulate = open
BACKEND = Absent()
"""


@pytest.fixture(scope="module")
def pymunk(tmp_path_factory):
    """What all experiments found of one engine at two levels."""
    need("pymunk")
    out = tmp_path_factory.mktemp("out")
    return simcompare.characterize(engine="pymunk", contact="default,tuned", out=out)


# --- what comes out ---------------------------------------------------------------------------


def test_every_experiment_is_answered_at_every_level(pymunk):
    asked = {(trial.experiment, trial.contact) for trial in pymunk.answers}
    assert asked == {(e, c) for e in characterize.EXPERIMENTS for c in ("default", "tuned")}
    assert {trial.status for trial in pymunk.answers} == {"ok"}
    assert pymunk.exit_code == 0


def test_what_is_stored_is_plain_json(pymunk):
    stored = json.loads((pymunk.folder / "characterization.json").read_text(encoding="utf-8"))
    assert stored == json.loads(json.dumps(plain(pymunk), allow_nan=False))
    assert stored["step_s"] == 1e-3


def test_the_page_leads_with_what_there_is_to_see_and_loads_nothing(pymunk):
    page = builder.html_of([characterized.block_of(pymunk)])
    assert "does not bounce in pymunk" in page
    assert page.index("does not bounce in pymunk") < page.index('class="plot"')
    for name in ("speed", "off_speed", "phase", "step", "friction_tuned", "joint_tuned"):
        assert f"-figure-{name}" in page
    assert "<script src" not in page
    assert '<link rel="stylesheet' not in page
    assert "simcompare characterize bounce,friction,joint,force" in page


def test_pictures_are_written_for_a_paper(pymunk, tmp_path):
    bounces = replace(pymunk, experiments=("bounce",))
    written = builder.write_figures_of([characterized.block_of(bounces)], tmp_path, "png")
    assert {path.name for path in written} == {
        f"characterization-{name}.png" for name in ("speed", "off_speed", "phase", "step")
    }
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)


@pytest.mark.parametrize("name", characterize.EXPERIMENTS)
def test_tables_fit_a_terminal(pymunk, name):
    table = characterized_tables.of(pymunk, name)
    assert [len(group.rows) for group in table.groups] == [1, 1]
    assert max(map(len, text_tables.lines(table, 80))) <= 80


def test_nothing_is_asked_twice(pymunk, monkeypatch):
    def never(*_):
        raise AssertionError("found anew")

    asked = []
    monkeypatch.setattr(cache, "plain", never)  # what is new goes through it
    again = simcompare.characterize(
        engine="pymunk", contact="default,tuned", progress=lambda *a: asked.append(a)
    )
    assert [plain(trial) for trial in again.answers] == [plain(trial) for trial in pymunk.answers]
    assert len(asked) == 8


# --- sentences --------------------------------------------------------------------------------


#: there is no step at which it is off
NEVER = {"below_s": None, "above_s": None}


def bounce_of(engine, level, **more):
    """A stored answer in which everything is right but what is given."""
    speeds = (0.1, 0.5, 2.0, 5.0)
    row = {"mean": 0.8, "scatter": 0.0, "least": 0.8, "most": 0.8, "bounced": 1.0}
    found = {
        "over_speed": [{"speed_m_s": v, **row} for v in speeds],
        "retuned": [],
        "dies_below_m_s": None,
        "hops_at_m_s": None,
        "too_large": NEVER,
        "too_small": NEVER,
        "slowest_m_s": 0.049,
        "phases": [0.5],
        "over_phase": [0.8],
        "over_step": [{"step_s": 1e-3, **row}],
        "gains_above_s": None,
        **more,
    }
    return {"engine": engine, "experiment": "bounce", "contact": level, "status": "ok",
            "found": found}  # fmt: skip


KINDS = {
    "bounce": BounceBehaviour,
    "friction": FrictionBehaviour,
    "joint": JointBehaviour,
    "force": ForceBehaviour,
}


def trial_of(answer):
    found = answer["found"]
    return Trial(
        answer["engine"], "1", answer["experiment"], answer["contact"], answer["status"],
        found=None if found is None else of_plain(KINDS[answer["experiment"]], found),
    )  # fmt: skip


def said(*answers):
    return "\n".join(one.text for one in findings.sentences(list(map(trial_of, answers)), 1e-3))


def with_row(speed_m_s, **row):
    rows = bounce_of("x", "tuned")["found"]["over_speed"]
    return {
        "over_speed": [{**one, **row} if one["speed_m_s"] == speed_m_s else one for one in rows]
    }


def test_a_sentence_names_the_engines_that_differ_with_their_numbers():
    text = said(
        bounce_of("a", "tuned"),
        bounce_of("b", "tuned", **with_row(2.0, scatter=0.016)),
        bounce_of("c", "tuned", **with_row(0.5, mean=0.82)),
        bounce_of("d", "tuned", dies_below_m_s=0.123, hops_at_m_s=0.0412),
        bounce_of("e", "tuned", too_large=beyond(2.9e-3), gains_above_s=4.1e-3),
        bounce_of("f", "tuned", too_small={"below_s": 5e-4, "above_s": 3.5e-3}),
    )
    assert "at 1 ms: the mean restitution is right in all 6 engines, within 0.5 %" in text
    assert "by ± 2 % in b, ± 0.01 % at most in the others" in text
    assert (
        "Tuned, slower impacts: at 0.5 m/s the mean that the same number gives is off by +2.5 % in"
        " c; the bounce dies below 0.12 m/s in d; the ball never comes to rest, but hops on at"
        " about 0.04 m/s in d."
    ) in text
    assert (
        "With the number of 1 ms held at other steps, the mean restitution is more than 1 % too"
        " large beyond 2.9 ms in e, and more than 1 % too small below 0.5 ms in f, and more than"
        " 1 % too small beyond 3.5 ms in f;"
    ) in text
    assert "some impacts gain energy beyond 4.1 ms in e" in text


def beyond(step_s):
    return {"below_s": None, "above_s": step_s}


@pytest.mark.parametrize("level", ["coefficients", "tuned", "assisted"])
def test_where_a_bounce_dies_is_told_with_its_level(level):
    text = said(bounce_of("a", level), bounce_of("b", level, dies_below_m_s=0.12))
    head = capital(words.HEADS[level])
    assert f"{head}, slower impacts: the bounce dies below 0.12 m/s in b." in text


def test_what_little_comes_back_by_default_is_told_with_its_scatter():
    little = bounce_of("a", "default", **with_row(2.0, mean=0.0777, scatter=0.0582))
    dead = bounce_of("b", "default", **with_row(2.0, mean=0.0))
    told = "comes back with 0.078 ± 0.058 in a, not at all in b."
    assert told in said(little, dead)


@pytest.mark.parametrize("level", ["default", "coefficients", "tuned", "assisted"])
def test_a_ball_that_runs_away_is_neither_right_nor_dead(level):
    lost = bounce_of("b", level, **with_row(2.0, mean=None, scatter=None))
    text = said(bounce_of("a", level), lost)
    assert "runs away in b" in text
    assert "all" not in text.split()
    assert "± 0 % at most in the others" not in text
    assert characterized_tables.of(record_of([lost]), "bounce").groups


def test_what_runs_away_has_no_cell_and_no_deviation():
    gone = {"ratio": None, "jitter": None, "u": None}
    right = {case: {"ratio": 1.0, "jitter": 0.0, "u": 0.0} for case in CASES}
    found = {"cases": {**right, "weld_rest": gone}}
    answer = {"engine": "a", "experiment": "force", "contact": "tuned", "status": "ok",
              "found": {**found, "lacks": {}, "over_step": []}}  # fmt: skip
    assert "the force on a weld at rest runs away in a" in said(answer)
    assert characterized_tables.of(record_of([answer]), "force").groups
    assert characterized_tables._small(math.nan, 1e-6) == "–"


def test_a_variant_without_helps_is_not_shown_with_them(call):
    need("mujoco")
    words = ("bounce", "--engine", "mujoco:rk4", "--contact", "assisted", "--json")
    code, out, _ = call("characterize", *words)
    assert code == 2
    (answer,) = json.loads(out)["answers"]
    assert answer["status"] == "unsupported"
    assert "takes none of our helps" in answer["reason"]


def test_the_table_tells_both_ways_of_being_off():
    answers = [
        bounce_of("a", "tuned", too_large=beyond(2.9e-3)),
        bounce_of("b", "tuned", too_small=beyond(3.5e-3)),
        bounce_of("c", "tuned", too_small={"below_s": 5e-4, "above_s": 3.5e-3}),
        bounce_of("d", "tuned", too_small={"below_s": 1e-3, "above_s": 1e-3}),  # at the step itself
    ]
    table = characterized_tables.of(record_of(answers), "bounce")
    heads = [column.head for column in table.columns]
    large, small = (heads.index(f"1 % too {too} at (ms)") for too in ("large", "small"))
    cells = [(row[large], row[small]) for row in table.groups[0].rows]
    assert cells == [("> 2.9", "–"), ("–", "> 3.5"), ("–", "< 0.5, > 3.5"), ("–", "1")]
    assert max(map(len, text_tables.lines(table, 80))) <= 80


def record_of(answers):
    levels = [level for level in CONTACT_LEVELS if level in {a["contact"] for a in answers}]
    return Characterization(
        created="2026-01-01T00:00:00+00:00", step_s=1e-3, experiments=(), contact=tuple(levels),
        engines_asked="all", sentences=(), answers=tuple(map(trial_of, answers)),
        software=Software("1", "3", "2"),
    )  # fmt: skip


def bouncing_with(level, mean):
    rows = bounce_of("x", level)["found"]["over_speed"]
    return bounce_of("x", level, over_speed=[{**row, "mean": mean} for row in rows])


def test_the_first_picture_shows_the_default_where_something_happens():
    others = [bounce_of("x", level) for level in ("coefficients", "tuned", "assisted")]

    def pictures(mean):
        drawn = bounce_figures.of_bounce(record_of([bouncing_with("default", mean), *others]))
        return {figure.name: [panel.title for panel in figure.panels] for figure in drawn}

    known = ["Coefficients typed in", "Tuned", "With our helps"]
    little = pictures(0.09)
    # no more panels side by side than can be read
    assert little["speed"] + little["speed2"] == ["By default", *known]
    assert max(map(len, little.values())) <= MAX_PANELS
    assert little["off_speed"] == known  # 89 % off leaves every panel of deviations
    assert pictures(0.0)["speed"] == known


def test_what_is_right_is_not_told_as_wrong():
    text = said(bounce_of("a", "tuned"), bounce_of("b", "tuned"))
    for word in ("off by", "dies", "hops", "gain", "No number"):
        assert word not in text


def test_a_step_without_a_number_is_told():
    again = [{"step_s": 2e-3, "reason": ""}, {"step_s": 4e-3, "reason": "none"}]
    assert "No number gives this ball of 40 mm a steady bounce at 4 ms or more in a." in said(
        bounce_of("a", "tuned", retuned=again)
    )


def friction_of(engine, **more):
    """A stored answer in which friction is Coulomb's but for what is given."""
    lies = {"load": 0.8, "creep_m_s": 0.0, "sinks_m": 0.0}
    found = {
        "lets_go_at": 1.0,
        "creep": [{**lies, **{k: v for k, v in more.items() if k in lies}}],
        "braking": [{"speed_m_s": 1.0, "braking": more.get("braking", 1.0)}],
        "over_step": [],
    }
    found |= {k: v for k, v in more.items() if k == "lets_go_at"}
    return {"engine": engine, "experiment": "friction", "contact": "default", "status": "ok",
            "found": found}  # fmt: skip


def test_friction_is_told_in_words():
    text = said(
        friction_of("a"),
        friction_of("b", lets_go_at=0.5),
        friction_of("c", lets_go_at=None, braking=None),
        friction_of("d", creep_m_s=0.0021),
        friction_of("e", braking=0.97),
        friction_of("f", sinks_m=0.07, lets_go_at=0.1, creep_m_s=0.05),
        friction_of("g", lets_go_at=0.0, creep_m_s=1.1, braking=0.0),
    )
    assert text == (
        "By default, at 1 ms: a block falls through the floor in f; of the load that friction"
        " should hold, a block lets go at 0.00 in g, 0.50 in b; it holds whatever pulls in c; while"
        " it should stick it creeps by 2.1 mm/s in d; sliding, its deceleration is off by"
        " up to −3 % in e."
    )
    right = "friction holds a block up to the load that it should in a, within 1 %."
    assert said(friction_of("a")) == f"By default, at 1 ms: {right}"


def test_nothing_reads_like_micronewton_or_microgram(pymunk):
    page = builder.html_of([characterized.block_of(pymunk)])
    body = page[page.index('class="answer"') :]
    assert not re.findall("µ[Ng]", body)
    assert "µ·N, the coefficient of friction times the normal force" in body


@pytest.mark.parametrize("text", ["0.078 ± 0.058", "by ± 1.8 %", "2.9 ms", "0.04 m/s", "5 mm/s"])
def test_a_number_stays_on_the_line_of_its_scatter_and_unit(text):
    assert numbers.tied(text).split(" ")[-1] == text.removeprefix("by ").replace(" ", "\u00a0")


def test_long_sentences_are_wrapped(call):
    _, out, _ = call("characterize", "--engine", "pymunk", "--contact", "default,tuned")
    answer = out[: out.index("Stored in")]
    assert "Tuned for 0.8 at 2 m/s" in answer
    lines = answer.splitlines()
    assert max(map(len, lines)) <= 80
    assert not any(re.match(" *(%|ms|m/s|mm/s)", line) for line in lines)  # a number has its unit
    assert "\u00a0" not in answer


def test_a_hinge_is_told_in_words():
    def hinge(engine, **more):
        right = dict.fromkeys(("damping", "inertia", "frequency", "damping_ratio"), 1.0)
        return {"engine": engine, "experiment": "joint", "contact": "tuned", "status": "ok",
                "found": {**right, "lacks": {}, "over_step": [], **more}}  # fmt: skip

    text = said(hinge("a"), hinge("b", damping=None), hinge("c", damping_ratio=0.8))
    assert text == (
        "Tuned, at 1 ms: a hinge that is set turning does not turn on in b; the damping ratio of a"
        " sprung hinge is off by −20 % in c."
    )
    assert "are right within 1 %" in said(hinge("a", frequency=1.009))


def test_forces_are_told_in_words():
    def forces(engine, lacks=(), **more):
        right = {case: {"ratio": 1.0, "jitter": 0.0, "u": 0.0} for case in CASES}
        cases = {case: one for case, one in {**right, **more}.items() if case not in lacks}
        return {"engine": engine, "experiment": "force", "contact": "tuned", "status": "ok",
                "found": {"cases": cases, "lacks": dict.fromkeys(lacks, "why"),
                          "over_step": []}}  # fmt: skip

    text = said(
        forces("a", contact_slides={"ratio": 0.94, "jitter": 3.7, "u": 0.01}),
        forces("b", lacks=("weld_rest",)),
    )
    assert text == (
        "Tuned, at 1 ms: the force on a block that slides is off by −6 % in a and jitters by"
        " ± 370 % in a; not all forces are told in b."
    )
    assert "right within 1 %, and steady." in said(forces("a"))
    # what a mean jitters by itself is no deviation
    unsure = said(forces("a", contact_slides={"ratio": 0.94, "jitter": 3.7, "u": 0.04}))
    assert "is off by" not in unsure
    assert "jitters by ± 370 %" in unsure


def test_levels_that_are_alike_are_told_in_one_sentence():
    both = (friction_of("a"), {**friction_of("a"), "contact": "tuned"})
    assert said(*both).startswith("By default and tuned, at 1 ms: friction holds")


def test_a_run_in_which_nothing_is_known_is_told_nothing_of():
    assert said({**bounce_of("a", "tuned"), "status": "unsupported", "found": None}) == ""


# --- what is refused, and what is a row -------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("bounces",), "no experiment is called 'bounces'; did you mean bounce"),
        (("",), "is empty; give a value, or leave it out"),
        (("--contact", "best"), "no contact level is called 'best'"),
        (("--engine", "mujocco"), "no engine is called 'mujocco'; did you mean mujoco?"),
        (("--step", "0"), "--step: 0 is not a time above 0"),
        (("--step=-1ms",), "--step: -1ms is not a time above 0"),
        (("--step", "1s"), "use 100 us to 10 ms"),
        (("--step", "1kg"), "--step"),
        (("--figures", "bmp"), "no figure format is called 'bmp'"),
        (("--time-limit", "0"), "--time-limit: 0 s is not a time above 0"),
    ],
)
def test_bad_input_is_one_sentence_and_leaves_nothing(call, tmp_path, words, sentence):
    code, out, err = call("characterize", *words)
    assert code == 2
    assert err.startswith("simcompare: ")
    assert sentence in err
    assert "Traceback" not in out + err
    assert not (tmp_path / "runs").exists()


def test_a_place_that_cannot_be_written_to_is_told_before_anything_is_asked(call, write):
    code, _, err = call("characterize", "--out", write("file", "no folder"))
    assert code == 2
    assert "cannot be written to" in err


def test_without_any_engine_it_says_how_to_get_one(call, add_engine, tmp_path):
    add_engine("absent", code=ABSENT)
    code, _, err = call("characterize", "--engine", "absent")
    assert code == 3
    assert "absent is not installed" in err
    assert list((tmp_path / "runs").iterdir()) == []
    assert "pip install absentlib" in err


def test_an_engine_that_cannot_is_a_row_with_its_reason(call, add_engine):
    add_engine("toy")  # a backend over the plain protocol that only lets things fall
    add_engine("absent", code=ABSENT)
    code, out, err = call(
        "characterize", "bounce,joint", "--engine", "toy,absent", "--contact", "tuned", "--json"
    )
    assert code == 3, err  # one that was named is missing
    found = json.loads(out)
    status = {(a["engine"], a["experiment"]): a["status"] for a in found["answers"]}
    assert status["toy", "bounce"] == "unsupported"
    assert status["absent", "bounce"] == "missing"
    reasons = [a["reason"] for a in found["answers"] if a["engine"] == "toy"]
    assert "toy is not built on simcompare's kit" in reasons[0]


def test_the_command_says_what_could_not_be_asked_and_where_the_answers_lie(call, add_engine):
    add_engine("toy")
    words = ("characterize", "bounce", "--engine", "toy", "--no-report")
    code, out, _ = call(*words)
    assert code == 2  # nothing that was asked for can be had
    assert "toy is not built on simcompare's kit" in " ".join(out.split())
    assert "unsupported" not in out
    assert call(*words, "--details")[1].count("unsupported") == len(CONTACT_LEVELS)
    assert "Stored in runs" in out
    assert "Report:" not in out


def test_numbers_that_are_not_finite_are_none():
    found = plain(Spread(mean=math.inf, scatter=math.nan, bounced=1.0))
    assert (found["mean"], found["scatter"], found["bounced"]) == (None, None, 1.0)
    assert math.isnan(of_plain(Spread, found).mean)
