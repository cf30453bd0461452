"""Several steps in one run: each is a source of its own, with all that depends on the step."""

import json
from dataclasses import replace

import numpy as np
import pytest

import simcompare
from simcompare.comparison.repeats import read_steps, step_words
from simcompare.errors import InputError
from simcompare.reports.run import reproduce, runs
from simcompare.reports.run.source_styles import look, looks
from simcompare.reports.sections.scores import scores
from simcompare.results import store
from simcompare.results.records.run import Wall
from tests.present import need
from tests.test_fitting import stopwatch

STEPS = ("0.5ms", "1ms", "2ms")
NAMES = [f"pymunk@{step}" for step in STEPS]


def ball(step, contact="tuned", **more):
    return simcompare.run("ball", engine="pymunk", contact=contact, step=step, seeds=3, **more)


@pytest.fixture(scope="module")
def several():
    return ball(",".join(STEPS), "tuned,assisted")


@pytest.fixture(scope="module")
def each():
    return {step: ball(step, "tuned,assisted") for step in STEPS}


def told(run, source, contact):
    """Everything that was measured of a source, without its name."""
    return [
        replace(s, source="")
        for s in run.record.scores
        if (s.source, s.contact) == (source, contact)
    ]


def without_times(record):
    """A record without what no two runs share: when and how fast they were made."""
    sources = tuple(replace(source, wall_s=Wall()) for source in record.sources)
    return replace(record, created="", sources=sources)


# --- sources -----------------------------------------------------------------------------------


def test_every_step_is_a_row_of_its_own_level_by_level(several):
    rows = [(source.contact, source.name) for source in several.record.sources]
    assert rows == [(level, name) for level in ("tuned", "assisted") for name in NAMES]
    found = {source.name: source for source in several.record.sources}
    assert [found[name].engine for name in NAMES] == ["pymunk"] * 3
    assert [found[name].engine_step_s for name in NAMES] == [5e-4, 1e-3, 2e-3]


@pytest.mark.parametrize("contact", ["tuned", "assisted"])
@pytest.mark.parametrize("step", STEPS)
def test_a_step_gives_what_it_gives_alone_to_the_last_bit(several, each, step, contact):
    """So its repeats, truths, tolerances and tuned numbers are those of its own step."""
    alone = each[step]
    assert told(several, f"pymunk@{step}", contact) == told(alone, "pymunk", contact)
    assert told(alone, "pymunk", contact)
    one, other = (
        [t.trajectory for t in run.trajectories if (t.source, t.contact) == (name, contact)]
        for run, name in ((several, f"pymunk@{step}"), (alone, "pymunk"))
    )
    assert len(one) == len(other) == 3
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a.time_s, b.time_s)
        for name, values in a.signals.items():
            np.testing.assert_array_equal(values, b.signals[name], err_msg=name)


def test_numbers_of_tuned_are_sought_at_each_step(several):
    tuning = [s.tuning[0] for s in several.record.sources if s.contact == "tuned"]
    assert [row.step_s for row in tuning] == [5e-4, 1e-3, 2e-3]
    assert len({row.numbers for row in tuning}) == 3


def test_repeats_are_spread_over_the_way_of_each_step(several):
    spans = [step.dither.span for step in several.record.steps]
    assert spans[1:] == pytest.approx([2 * spans[0], 4 * spans[0]]), "it grows as the step does"


def test_the_timing_of_bounces_gets_better_with_the_step(several):
    """An impact in a fixed step is late by a part of the step, so errors halve with it."""
    errors = [runs.score_of(several, n, "tuned", "impact_time_error").value for n in NAMES]
    assert errors[2] > 1.5 * errors[1] > 1.5**2 * errors[0] > 0


def test_helps_are_left_out_at_each_step(several, each):
    left_out = several.record.without
    assert {row.source for row in left_out} == {*NAMES}
    for step in STEPS:
        own = [replace(row, source="") for row in left_out if row.source == f"pymunk@{step}"]
        assert own == [replace(row, source="") for row in each[step].record.without]


def test_the_truth_that_is_drawn_is_that_of_the_finest_step(several):
    truth = runs.truth(several)
    assert truth.time_s[1] == 5e-4
    others = {t.source for t in several.trajectories if t.source.startswith("closed form")}
    assert others == {"closed form", "closed form@1ms", "closed form@2ms"}
    coarse = ball("2ms,0.5ms")
    assert runs.truth(coarse).time_s[1] == 5e-4, "in whichever order they are asked for"
    assert coarse.record.step_s == 5e-4


# --- one step ----------------------------------------------------------------------------------


def test_with_one_step_nothing_is_another(each):
    """Neither names nor what is said of steps; also where one step is asked for twice."""
    again = ball(["1ms", 0.001], "tuned,assisted")
    one = each["1ms"]
    assert [s.name for s in again.record.sources] == ["pymunk"] * 2
    assert not again.record.steps
    assert {(s.engine, s.engine_step_s) for s in again.record.sources} == {(None, None)}
    same = replace(again.record, command=one.record.command)
    assert without_times(same) == without_times(one.record)


# --- what is asked -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("asked", "found"),
    [
        (None, []), ("1ms", ["1ms"]), (0.001, [0.001]), ("1ms,2ms", ["1ms", "2ms"]),
        (["1ms", 0.002], ["1ms", 0.002]), ((0.001,), [0.001]),
    ],
)  # fmt: skip
def test_steps_are_one_or_a_list_or_a_text_with_commas(asked, found):
    assert read_steps(asked) == found


@pytest.mark.parametrize("asked", ["", ",", "1ms,", "1ms,,2ms", []])
def test_a_list_that_lacks_a_step_is_refused(asked):
    with pytest.raises(InputError, match=r"--step: .* lacks a step; expected such as 1ms"):
        read_steps(asked)


@pytest.mark.parametrize(
    ("step_s", "words"), [(1e-3, "1ms"), (5e-4, "0.5ms"), (2e-6, "0.002ms"), (0.3e-3, "0.3ms")]
)
def test_a_step_is_named_as_it_is_typed(step_s, words):
    assert step_words(step_s) == words


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--step", "1ms,1s"), "--step: 1s is too long for 4.105 s; use 420 ns to 41 ms"),
        (("--step", "1ms,nonsense"), "nonsense"),
        (("--step", "1ms,-1ms"), "--step: -1ms is not a time above 0"),
        (("--step", "1ms,"), "lacks a step"),
    ],
)
def test_a_wrong_step_among_right_ones_is_one_sentence(call, words, expected):
    code, _, err = call("run", "ball", "--engine", "pymunk", *words)
    assert code == 2
    assert expected in err
    assert "Traceback" not in err


def test_a_step_that_an_engine_cannot_do_is_a_row_with_its_reason():
    run = simcompare.run("ball", engine="mujoco", contact="tuned", step="1ms,4ms", seeds=1)
    good, bad = run.record.sources
    assert (good.name, good.status) == ("mujoco@1ms", "ok")
    assert (bad.name, bad.status) == ("mujoco@4ms", "unsupported")
    assert "a step of 4 ms" in bad.reason


# --- against, fits, files and reports ----------------------------------------------------------


def test_every_step_is_held_against_a_measurement():
    run = ball("1ms,2ms", against="ittf_table_tennis_rebound")
    assert [m.source for m in run.record.against.matches] == ["pymunk@1ms", "pymunk@2ms"]


def test_a_fit_is_tuned_anew_at_the_steps_that_it_is_not_of(tmp_path):
    drop = stopwatch(tmp_path / "drop.csv")
    fit = simcompare.fit("ball", recordings=[drop], engine="pymunk", step="1ms", out=tmp_path)
    run = ball("1ms,2ms", str(fit.folder))
    own, other = run.record.sources
    assert not own.tuning, "the numbers of the fit are for this step"
    assert other.tuning[0].step_s == 2e-3
    (caution,) = run.record.cautions
    assert "The step is 2 ms" in caution


def test_what_was_written_is_read_back(several, tmp_path):
    again = store.load(store.save(several, tmp_path).folder)
    assert [(t.source, t.contact, t.repeat) for t in again.trajectories] == [
        (t.source, t.contact, t.repeat) for t in several.trajectories
    ]
    assert again.record.scores == several.record.scores


def test_the_command_that_makes_it_again_names_all_steps(several):
    assert "--step 0.5ms,1ms,2ms" in reproduce.command(several)
    first, second, third = reproduce.scripts(several)
    assert "--engine pymunk --contact tuned --step 0.002s" in third
    assert len({line.split(" -o ")[1] for line in (first, second, third)}) == 3


def test_a_report_judges_each_step_by_its_own_tolerance(several):
    group = scores(several).tables[0].groups[0]
    assert "tolerance ± 0.0016 or 0.008" in group.note, "above 1 ms the scenario asks for less"
    score = runs.score_of(several, "pymunk@2ms", "tuned", "restitution")
    assert runs.tolerances(several, score.source)["restitution"].absolute == 0.008
    assert score.tolerance == 0.008


def test_steps_of_an_engine_share_its_colour_and_nothing_else(several):
    looks = [look(several, name) for name in NAMES]
    assert len({style.colour for style in looks}) == 1
    assert len({style.dash for style in looks}) == 3
    assert len({style.marker for style in looks}) == 3


def test_the_table_has_a_row_for_each_step(call):
    words = ("--engine", "pymunk", "--contact", "tuned", "--step", "1ms,2ms", "--seeds", "1")
    _, out, _ = call("run", "ball", *words)
    lines = [line.split()[0] for line in out.splitlines() if line.startswith("pymunk@")]
    assert lines == ["pymunk@1ms", "pymunk@2ms"]
    _, out, _ = call("run", "ball", *words, "--json")
    assert [s["name"] for s in json.loads(out)["sources"]] == ["pymunk@1ms", "pymunk@2ms"]


def test_variants_and_steps_make_sources_together():
    need("mujoco")
    run = simcompare.run(
        "ball", engine="mujoco,mujoco:rk4", contact="tuned", step="1ms,2ms", seeds=2
    )
    names = ["mujoco@1ms", "mujoco@2ms", "mujoco:rk4@1ms", "mujoco:rk4@2ms"]
    assert [source.name for source in run.record.sources] == names
    values = [s.value for s in run.record.scores if s.measure == "restitution" and s.index is None]
    assert len(set(values)) == 4
    numbers = {s.tuning[0].numbers for s in run.record.sources}
    assert len(numbers) == 4, "each is tuned by itself"
    styles = looks(tuple(names))
    colours = [styles[name].colour for name in names]
    assert colours[0] == colours[1]
    assert colours[2] == colours[3] != colours[0], "a variant has a shade of its own"
    assert len({(style.dash, style.marker) for style in styles.values()}) == 4


@pytest.mark.engines("pymunk")
def test_each_step_stands_beside_its_own_truth(call):
    words = ("--engine", "pymunk", "--contact", "tuned", "--step", "1ms,2ms", "--details")
    _, out, _ = call("run", "ball", *words, "--no-report")
    counts = out[out.index("resolved bounces") :].splitlines()
    rows = dict(line.rsplit(maxsplit=1) for line in counts[3:7])
    # from longer steps fewer bounces can be resolved, also of the closed form
    assert rows["pymunk@1ms"] == rows["closed form@1ms"]
    assert rows["pymunk@2ms"] == rows["closed form@2ms"]
    assert rows["closed form@2ms"] != rows["closed form@1ms"]
