"""Fits for plain loops: numbers that a user types in, and what they do where nothing helps."""

import copy
import functools
import json
import math
import random

import numpy as np
import pytest

import simcompare
from simcompare.engine.calibration.drops import even_phases
from simcompare.errors import InputError, SimcompareError
from simcompare.reports.fit import summary_tables
from simcompare.results import fit_file
from simcompare.results.contact_values import contact_values
from simcompare.scenarios import catalogue
from tests.bare_drops import COEFFICIENT_ENGINES, MujocoDrops
from tests.present import INSTALLED, need
from tests.test_fitting import E, stopwatch

ENGINES = {**COEFFICIENT_ENGINES, "mujoco": MujocoDrops}
STEP_S = 1e-3


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    place = tmp_path_factory.mktemp("tuned")
    drop = stopwatch(place / "drop.csv")
    held = stopwatch(place / "held.csv", seed=7, height_m=0.7)
    return simcompare.fit("ball", recordings=[drop], hold_out=[held], step=STEP_S, out=place)


def sources(run):
    rows = {source.name: source for source in run.record.fit.sources}
    return {name: rows[name] for name in INSTALLED}


def test_a_fit_is_for_a_plain_loop_unless_help_is_asked_for(found):
    record = found.record.fit
    assert (record.contact, record.assist) == ("tuned", "none")
    assert found.exit_code == 0
    for source in sources(found).values():
        assert source.status == "ok"
        assert source.contact == "tuned"
        assert source.step_s == STEP_S
    table = summary_tables.given(found)
    assert table.columns[1].head == "Type in (step 1 ms)"
    assert {row[0] for row in table.groups[0].rows} == set(sources(found))


@pytest.mark.parametrize("engine", ENGINES)
def test_the_numbers_transfer_to_a_bare_loop(found, engine):
    need(engine)
    numbers = tuple(row.value for row in sources(found)[engine].numbers)
    speed = found.record.fit.tuned_to.speed_m_s
    bare = ENGINES[engine](STEP_S)
    # phases that neither the calibration nor the fit has seen
    assert bare(numbers, speed, even_phases(23, 0.3)).mean == pytest.approx(E, rel=0.005)
    three = [bare(numbers, speed * E**k, even_phases(23, 0.3)).mean for k in range(3)]
    assert np.mean(three) == pytest.approx(E, rel=0.01)


def test_a_number_carries_the_uncertainty_of_the_restitution(found):
    goal = found.record.fit.tuned_to
    for source in sources(found).values():
        *chosen, last = source.numbers
        assert all(row.u == 0 for row in chosen)
        scatter = source.tuning[0].at[0].scatter
        # and by how far the search for the number ended off its aim
        whole = math.hypot(goal.u, scatter / 5, source.impacts[0].restitution - goal.restitution)
        if not chosen:  # a coefficient is nearly the restitution
            assert last.u == pytest.approx(whole, rel=0.05)
        else:  # ln e is about proportional to the damping
            assert last.u / abs(last.value) == pytest.approx(whole / E / -math.log(E), rel=0.2)


def test_the_time_of_the_contact_is_told_and_not_made_up_for(found):
    spring = sources(found)["mujoco"]
    first = spring.impacts[0]
    assert first.restitution == pytest.approx(E, rel=0.005)
    assert first.late_s > 2e-3
    assert spring.contact_of_first_impact.contact_s > 5e-3
    assert spring.contact_of_first_impact.penetration_m > 5e-3
    late = [row.late_s for row in spring.impacts]
    assert np.all(np.diff(late) > 0)
    # no engine's physical parameters were moved to fit its own delays
    given = {source.parameters["restitution"].value for source in sources(found).values()}
    assert len(given) == 1


def test_every_recorded_impact_is_set_beside_the_closed_form(found):
    for source in sources(found).values():
        assert [row.number for row in source.impacts] == list(range(1, 8))
        assert source.impacts[0].deviation == pytest.approx(0, abs=0.005)
        mean = np.mean([row.restitution for row in source.impacts])
        assert source.effective["restitution"].value == pytest.approx(mean, rel=1e-9)
        assert source.impacts[0].scatter > 0


def test_a_held_out_drop_is_judged_by_restitution_and_heights(found):
    (drop,) = found.record.fit.holdout.drops
    assert abs(drop.e_n) <= 1
    assert [row.number for row in drop.heights] == [1, 2, 3, 4, 5, 6]
    assert all(abs(row.e_n) <= 1.2 for row in drop.heights)
    spring = drop.engines["mujoco"]
    assert abs(spring.e_n) <= 1
    assert spring.heights[0].predicted == pytest.approx(0.7 * E**2, rel=0.02)
    # lateness stands beside, without a score
    assert spring.late_s[0] > 2e-3
    assert "Rebound heights predicted within the uncertainty" in found.record.fit.holdout.text


def test_a_ball_of_another_kind_is_told_apart(found, tmp_path):
    other = stopwatch(tmp_path / "other.csv", seed=3, e=0.8)
    drop = stopwatch(tmp_path / "drop.csv")
    run = simcompare.fit("ball", recordings=[drop], hold_out=[other], engine="pymunk")
    (held,) = run.record.fit.holdout.drops
    assert abs(held.engines["pymunk"].e_n) > 3
    assert abs(held.engines["pymunk"].heights[0].e_n) > 1


def test_a_table_of_rebounds_is_held_out(tmp_path):
    rows = "".join(f"{k},{0.5 * E ** (2 * k):.5f},0.001\n" for k in range(1, 6))
    held = tmp_path / "rebounds.csv"
    held.write_text(f"# title: made up\nbounce,rebound_height_m,u_rebound_height_m\n{rows}")
    drop = stopwatch(tmp_path / "drop.csv")
    run = simcompare.fit("ball", recordings=[drop], hold_out=[held], engine="pymunk")
    (row,) = run.record.fit.holdout.drops
    assert [abs(height.e_n) <= 1 for height in row.heights] == [True] * 5
    assert [abs(h.e_n) <= 1 for h in row.engines["pymunk"].heights] == [True] * 5


def test_a_run_takes_the_numbers_of_the_fit_and_tunes_anew_at_another_step(found):
    place = str(found.folder)
    run = simcompare.run("ball", engine="pymunk,mujoco", contact=place, seeds=3)
    assert run.record.cautions == ()
    for source in run.record.sources:
        known = {row.value for row in sources(found)[source.name].numbers}
        held = {row.set_value for row in source.audit}
        assert known <= held
        assert not source.tuning
    other = simcompare.run("ball", engine="pymunk", contact=place, seeds=1, step="2ms")
    (caution,) = other.record.cautions
    assert "tuned anew" in caution
    assert other.record.sources[0].tuning[0].step_s == 2e-3
    changed = simcompare.run("ball", engine="pymunk", contact=place, seeds=1,
                             set={"restitution": 0.7})  # fmt: skip
    assert any("tuned anew" in text for text in changed.record.cautions)


def test_a_run_has_the_step_of_the_fit_where_none_is_asked_for(tmp_path):
    drop = stopwatch(tmp_path / "drop.csv")
    fit = simcompare.fit("ball", recordings=[drop], engine="pymunk", step="2ms", out=tmp_path)
    run = simcompare.run("ball", engine="pymunk", contact=str(fit.folder), seeds=1)
    assert run.record.step_s == 2e-3
    assert run.record.cautions == ()
    assert not run.record.sources[0].tuning


def test_settings_of_a_fit_hold_for_its_step(found):
    from simcompare.scenarios import catalogue

    fit = fit_file.read(found.folder / "fit.json")
    file = catalogue.load("ball")
    scene = file.resolve(fit.base(file), step_s=STEP_S)
    settings = fit.settings("mujoco", scene)
    assert settings.contact == "tuned"
    assert [len(numbers.values) for numbers in settings.numbers] == [2]
    assert fit.settings("mujoco", file.resolve(fit.base(file), step_s=5e-4)).numbers == ()
    assert fit.of_engine("mujoco", file) == {}
    assert fit.of_engine("unknown", file) is None


def test_contact_values_are_all_that_a_loop_needs(found, call):
    code, out, err = call("export", "ball", "--fit", found.folder / "fit.json", "--contact-values")
    assert code == 0, err
    assert "plain loop of one fixed step of 1 ms" in out.splitlines()[0]
    for line in (
        "mujoco: opt.timestep = 0.001 s", "mujoco: opt.cone = 1.0", "mujoco: solimp[0] = 0.9999",
        "mujoco: solref[1] = -", "pybullet: contactERP = 0.0", "pybullet: erp = 0.0",
        "pybullet: contactSlop = 0.0", "pybullet: restitutionVelocityThreshold = 0.0",
        "pybullet: contactProcessingThreshold = 0.0", "pybullet: linearDamping = 0.0",
        "pybullet: restitution of floor = 1.0", "dart: OdeCollisionDetector = 1.0",
        "dart: restitutionCoeff of ball = 0.8", "pymunk: Space.collision_slop = 1e-09 m",
        "pymunk: elasticity of floor = 1.0",
    ):  # fmt: skip
        assert line in out or line.partition(":")[0] not in INSTALLED


def test_an_engine_that_cannot_is_a_row_with_its_longest_step(tmp_path, call):
    drop = stopwatch(tmp_path / "drop.csv", e=0.6, height_m=0.5)
    code, out, err = call(
        "fit", "ball", "-r", drop, "--engine", "mujoco,pymunk", "--step", "4ms", "--json",
        "--no-report", "-o", tmp_path / "runs",
    )  # fmt: skip
    assert code == 0, err
    rows = {source["name"]: source for source in json.loads(out)["sources"]}
    assert rows["mujoco"]["status"] == "unsupported"
    assert "the longest step below it that has one is" in rows["mujoco"]["reason"]
    assert rows["pymunk"]["status"] == "ok"
    code, out, err = call(
        "fit", "ball", "-r", drop, "--engine", "mujoco", "--step", "4ms", "--no-report",
        "-o", tmp_path / "runs",
    )  # fmt: skip
    assert code == 2
    assert "the longest step below it that has one is" in " ".join(out.split())
    assert "Traceback" not in err


def test_a_law_of_speed_gives_the_first_impact_and_the_others_are_told(tmp_path):
    from tests.bounces import TRUTH, times_of

    values = {**TRUTH, "exponent": 0.05}
    rows = "".join(f"{k},{t:.7f},1e-4\n" for k, t in enumerate(times_of(values, 8), start=1))
    path = tmp_path / "falling.csv"
    path.write_text(f"# title: made up\nbounce,impact_time_s,u_impact_time_s\n{rows}")
    run = simcompare.fit(
        "ball", recordings=[path], engine="pymunk", model="power", step=STEP_S, out=tmp_path
    )
    record = run.record.fit
    goal = record.tuned_to
    assert goal.restitution == pytest.approx(0.85 * (goal.speed_m_s / 4) ** -0.05, rel=1e-3)
    impacts = record.sources[0].impacts
    assert impacts[0].deviation == pytest.approx(0, abs=0.002)
    assert impacts[3].closed_form > impacts[0].closed_form
    assert impacts[3].deviation < -0.01
    # how far the one number is from the recorded impacts: their root mean square, and the most
    gaps = [abs(row.closed_form - goal.restitution) for row in impacts]
    assert record.one_number.most >= max(gaps[:-1]) > record.one_number.misfit
    (words,) = [text for text in record.sentences if "one number for all speeds" in text]
    off = f"differs from the ball's {record.one_number.off}"
    assert off in words
    # what cannot follow the law says so in its uncertainty: it covers every recorded impact
    u = record.sources[0].parameters["restitution"].u
    assert record.sources[0].effective["restitution"].u > 0.9 * u
    assert all(abs(row.closed_form - goal.restitution) < 3 * u for row in impacts)
    assert record.sources[0].numbers[-1].u == pytest.approx(u, rel=0.1)
    assert off in contact_values(run.folder / "fit.json")


def test_several_drops_share_one_set_of_numbers(tmp_path):
    drops = [stopwatch(tmp_path / f"{h}.csv", seed=k, height_m=h) for k, h in enumerate((0.4, 0.9))]
    (source,) = simcompare.fit("ball", recordings=drops, engine="pymunk").record.fit.sources
    assert {row.drop for row in source.impacts} == {1, 2}
    assert source.tuning[0].speed_m_s == pytest.approx(math.sqrt(2 * 9.80665 * 0.9), rel=0.01)


def test_an_old_fit_is_read_as_assisted(found, tmp_path):
    tree = json.loads((found.folder / "fit.json").read_text(encoding="utf-8"))
    for name in ("contact", "assist", "tuned_to"):
        del tree[name]
    tree["run_with"] = {"closed": tree["run_with"]["closed"],
                        "engines": {"pymunk": tree["run_with"]["closed"]}}  # fmt: skip
    for source in tree["sources"]:
        source["contact"] = "mapped"
    path = tmp_path / "fit.json"
    path.write_text(json.dumps(tree), encoding="utf-8")
    fit = fit_file.read(path)
    assert (fit.contact, fit.assist) == ("assisted", "all")
    run = simcompare.run("ball", engine="pymunk", contact=str(path), seeds=1)
    assert "landing" in run.record.sources[0].helps
    assert "not for a plain loop" in contact_values(path)


def test_a_damaged_contact_is_refused(found, tmp_path):
    tree = json.loads((found.folder / "fit.json").read_text(encoding="utf-8"))
    path = tmp_path / "fit.json"
    for name, value in (("contact", "glued"), ("assist", "magic"), ("by", "ear")):
        changed = {**tree, "contact": "assisted", name: value}
        path.write_text(json.dumps(changed), encoding="utf-8")
        with pytest.raises(InputError, match=value):
            fit_file.read(path)


def places(tree, at=()):
    """Every place in a tree of lists and mappings."""
    if at:
        yield at
    if isinstance(tree, dict | list):
        keys = tree if isinstance(tree, dict) else range(min(len(tree), 3))
        for key in keys:
            yield from places(tree[key], (*at, key))


def edited(tree, rng):
    """A copy with one place removed, or holding something else."""
    changed = copy.deepcopy(tree)
    *above, last = rng.choice(list(places(changed)))
    node = functools.reduce(lambda part, key: part[key], above, changed)
    if rng.random() < 0.2:
        del node[last]
    else:
        node[last] = rng.choice([None, "", "x", -1, 0, 1e308, math.nan, [], {}, True, [None], [{}]])
    return changed


def test_a_fit_with_one_edit_is_read_or_refused_in_one_sentence(found, tmp_path):
    tree = json.loads((found.folder / "fit.json").read_text(encoding="utf-8"))
    used = ("by", "scenario", "given", "contact", "assist", "closed_form", "sources", "run_with",
            "valid")  # fmt: skip
    tree = {name: tree[name] for name in used if name in tree}
    file, rng = catalogue.load("ball"), random.Random(0)
    path, refused = tmp_path / "fit.json", 0
    for _ in range(300):
        path.write_text(json.dumps(edited(tree, rng)), encoding="utf-8")
        try:
            fit = fit_file.read(path)
            scene = file.resolve(fit.base(file))
            fit.settings("pymunk", scene)
            fit.cautions(scene, file)
        except SimcompareError:
            refused += 1
    assert 0 < refused < 300


def test_some_helps_are_taken_and_written_down(tmp_path):
    drop = stopwatch(tmp_path / "drop.csv")
    run = simcompare.fit("ball", recordings=[drop], engine="pymunk", out=tmp_path / "runs",
                         assist="landing,half_step_start")  # fmt: skip
    assert run.record.fit.assist == "landing,half_step_start"
    fit = fit_file.read(run.folder / "fit.json")
    assert fit.contact == "assisted"
    assert "--assist" in run.record.command


@pytest.mark.parametrize(
    ("place", "value", "told"),
    [
        (("run_with", "numbers", "pymunk", 0, "values"), [-1], "expected one number in 0 … 1"),
        (("run_with", "numbers", "pymunk", 0, "values"), [], "expected one number in 0 … 1"),
        (("run_with", "numbers"), None, "is damaged"),
        (("valid",), None, "is damaged"),
        (("sources",), None, "is damaged"),
    ],
)
def test_a_fit_changed_by_hand_is_one_sentence(call, found, tmp_path, place, value, told):
    tree = json.loads((found.folder / "fit.json").read_text(encoding="utf-8"))
    part = tree
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = value
    path = tmp_path / "fit.json"
    path.write_text(json.dumps(tree), encoding="utf-8")
    code, _, err = call("export", "ball", "--contact-values", "--fit", path)
    assert code == 2
    assert "fit.json" in err
    assert told in err
