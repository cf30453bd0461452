"""Levels of contact: what is the engine's own, what is ours, and what each of our helps does."""

import json

import numpy as np
import pytest

import simcompare
from simcompare.engine import assist, engines
from simcompare.engine.helps import HELPS
from simcompare.errors import InputError, UnknownName, Unsupported
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED, Settings
from simcompare.results import store
from simcompare.scenarios import catalogue

ENGINES = ("dart", "mujoco", "ode", "pybullet", "pymunk")
SCENES = (
    "ball",
    "robot_cylinder",
    "robot_planar",
    "accelerometer",
    "motor_step",
    "pendulum_torque",
)
NONE = Settings(ASSISTED, helps=frozenset())


def scene(name, **values):
    """A scenario that is cut short where it is long."""
    whole = catalogue.load(name).resolve(values)
    duration_s = min(whole.world.duration_s, 0.7)
    world = whole.world.model_copy(update={"duration_s": round(duration_s, 3)})
    return whole.model_copy(update={"world": world})


def simulate(engine, made, settings):
    return engines.get(engine).simulate(made, settings)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("engine", ENGINES)
def test_assisted_without_helps_is_tuned_bit_for_bit(engine, name):
    made = scene(name)
    try:
        tuned = simulate(engine, made, Settings(TUNED))
    except Unsupported:
        assert (engine, name) == ("pymunk", "robot_cylinder"), "it is planar, and has no cylinders"
        return
    none = simulate(engine, made, NONE)
    assert none.helps == tuned.helps == ()
    assert set(none.signals) == set(tuned.signals)
    for signal, values in tuned.signals.items():
        np.testing.assert_array_equal(none.signals[signal], values, err_msg=signal)


@pytest.mark.parametrize(
    ("engine", "name", "acting"),
    [
        ("pybullet", "ball", {"landing", "half_step_start"}),
        ("mujoco", "accelerometer", {"half_step_start", "centred_efforts"}),
        ("pybullet", "robot_cylinder", {"rims"}),
        ("pybullet", "robot_accelerometer", {"reactions"}),
        ("pymunk", "accelerometer_force", {"half_step_start", "reactions"}),
    ],
)
def test_helps_that_act_are_named_and_each_changes_the_motion(engine, name, acting):
    made = scene(name)
    whole = simulate(engine, made, Settings(ASSISTED))
    assert acting <= set(whole.helps)
    for left_out in acting:
        less = simulate(engine, made, Settings(ASSISTED, helps=frozenset(HELPS) - {left_out}))
        assert left_out not in less.helps
        same = set(less.signals) == set(whole.signals) and all(
            np.array_equal(less.signals[signal], values) for signal, values in whole.signals.items()
        )
        assert not same, left_out


BOX = {
    "mass_kg": 0.1, "inertia_kg_m2": [4e-5] * 3, "position_m": [0, 0, 0.325],
    "shapes": [{"type": "box", "size_m": [0.05, 0.05, 0.05]}],
}  # fmt: skip


@pytest.mark.parametrize("name", ["box", "robot_cylinder", "motor_step"])
@pytest.mark.parametrize("engine", ENGINES)
def test_a_help_that_is_not_named_changes_nothing(engine, name):
    """What acts without being named would be mixed into the engine's own result."""
    made = bouncing({"box": BOX}) if name == "box" else scene(name)
    if (engine, name) == ("pymunk", "robot_cylinder"):
        return
    whole = simulate(engine, made, Settings(ASSISTED))
    for left_out in set(HELPS) - set(whole.helps):
        less = simulate(engine, made, Settings(ASSISTED, helps=frozenset(HELPS) - {left_out}))
        for signal, values in whole.signals.items():
            np.testing.assert_array_equal(less.signals[signal], values, err_msg=left_out)


@pytest.mark.parametrize("engine", ENGINES)
def test_no_engine_has_our_helps_in_its_own_levels(engine):
    for level in (DEFAULT, COEFFICIENTS, TUNED):
        assert simulate(engine, scene("ball"), Settings(level)).helps == ()


@pytest.mark.engines("pybullet")
def test_rims_are_ours_and_a_cylinder_is_the_engines():
    """Bullet touches a plane with one point of a cylinder, so the robot is far too slow."""
    run = simcompare.run("robot_cylinder", engine="pybullet", contact="tuned,assisted")
    found = {
        s.contact: s for s in run.record.scores if s.measure == "acceleration" and s.index is None
    }
    assert found[ASSISTED].verdict == "pass"
    assert found[TUNED].value < 0.9 * found[TUNED].truth
    assert found[TUNED].verdict == "fail"
    rims = [item for item in run.record.without if item.help == "rims"]
    (shown,) = [m for item in rims for m in item.measures if m.measure == "acceleration"]
    assert shown.with_ == pytest.approx(found[ASSISTED].value)
    assert abs(shown.without - shown.truth) > 0.1 * shown.truth


def test_numbers_are_the_same_in_every_repeat_and_stand_in_the_record():
    run = simcompare.run("ball", engine="mujoco,pymunk", contact="tuned", seeds=3)
    for source in run.record.sources:
        (record,) = source.tuning
        assert record.pairs in ((("ball", "floor"),), (("floor", "ball"),))
        assert record.step_s == 0.001
        assert len(record.numbers) == (2 if source.name == "mujoco" else 1)
        assert record.at[0].restitution == pytest.approx(0.8, rel=5e-3)
        held = {
            row.read_value for row in source.audit
            if row.quantity in ("ball-floor restitution", "floor-ball restitution")
        }  # fmt: skip
        assert set(record.numbers) <= held, "what was sought is what the engine holds"
    numbers = {
        tuple(stored.trajectory.tuning[0].numbers)
        for stored in run.trajectories
        if stored.source == "mujoco"
    }
    assert len(numbers) == 1


def test_what_tuned_misses_fails_a_run_only_where_it_is_to_be_judged():
    asked = {"engine": "dart", "seeds": 1, "contact": "tuned"}
    shown = simcompare.run("ball", **asked)
    assert any(score.verdict == "fail" for score in shown.record.scores)
    assert shown.exit_code == 0
    assert simcompare.run("ball", **asked, judge="tuned").exit_code == 1
    with pytest.raises(UnknownName, match="level that is judged"):
        simcompare.run("ball", **asked, judge="default")


def test_a_step_at_which_an_engine_cannot_is_a_row_with_what_is_possible():
    run = simcompare.run("ball", engine="mujoco", contact="tuned", step="4ms", seeds=1)
    (source,) = run.record.sources
    assert source.status == "unsupported"
    assert "longest step below it that has one is" in source.reason
    assert source.reason.startswith("mujoco")
    assert 0.001 < source.longest_step_s < 0.004
    assert run.exit_code == 2
    longest = simcompare.run(
        "ball", engine="mujoco", contact="tuned", step=source.longest_step_s, seeds=1
    )
    assert longest.record.sources[0].status == "ok"


def test_the_old_name_of_assisted_is_accepted_and_old_runs_are_read(tmp_path):
    run = simcompare.run("ball", engine="pymunk", contact="mapped", seeds=1, out=tmp_path)
    assert {source.contact for source in run.record.sources} == {"assisted"}
    assert Settings("mapped") == Settings("assisted")
    path = run.folder / store.RECORD
    record = json.loads(path.read_text())
    for row in (*record["sources"], *record["scores"]):
        row["contact"] = "mapped"
    path.write_text(json.dumps(record | {"format": 1}))
    old = store.load(run.folder)
    assert {source.contact for source in old.record.sources} == {"assisted"}
    assert {score.contact for score in old.record.scores} == {"assisted"}


def test_helps_are_chosen_by_name():
    assert assist.chosen("all") == frozenset(HELPS)
    assert assist.chosen("none") == frozenset()
    assert assist.chosen("landing, rims") == {"landing", "rims"}
    with pytest.raises(UnknownName, match="did you mean landing"):
        assist.chosen("landin")
    with pytest.raises(InputError, match="stands alone"):
        assist.chosen("all,landing")
    with pytest.raises(InputError, match="names no help"):
        assist.chosen(",")


def test_a_help_that_an_engine_cannot_take_is_refused_with_those_that_it_takes(call):
    code, _, err = call("run", "robot", "--engine", "mujoco", "--assist", "rims", "--no-report")
    assert code == 2
    assert "mujoco takes no rims; it takes landing,half_step_start,centred_efforts" in err
    code, _, err = call("run", "robot", "--engine", "mujoco", "--assist", "rim", "--no-report")
    assert code == 2
    assert "did you mean rims?" in err


BALL = {
    "mass_kg": 0.05, "inertia_kg_m2": [1.25e-5] * 3,
    "shapes": [{"type": "sphere", "radius_m": 0.025}],
}  # fmt: skip


def bouncing(bodies, friction=0.0):
    from simcompare.model.scenario import Scenario

    return Scenario.model_validate({
        "name": "toy", "title": "Toy", "question": "?",
        "world": {"duration_s": 0.6, "step_s": 0.001},
        "bodies": {"floor": {"fixed": True, "shapes": [{"type": "plane"}]}, **bodies},
        "contacts": [
            {"pair": [name, "floor"], "restitution": 0.8, "friction": friction} for name in bodies
        ],
    })  # fmt: skip


def test_a_ball_with_spin_is_refused_where_its_impact_would_be_wrong():
    """With friction and an impact in 60 ns steps MuJoCo gave 1.67 m/s and -17 rad/s."""
    spinning = {**BALL, "position_m": [0, 0, 0.525], "velocity_m_s": [2, 0, 0],
                "rate_rad_s": [0, -50, 0]}  # fmt: skip
    made = bouncing({"ball": spinning}, friction=0.3)
    with pytest.raises(Unsupported, match="wrong speed and spin"):
        simulate("mujoco", made, Settings(ASSISTED))
    for engine in ("dart", "pybullet", "pymunk"):
        found = simulate(engine, made, Settings(ASSISTED))
        # Newton and Coulomb: the slip of 3.25 m/s ends within the impact, 2/7 of it stays
        assert found.signals["ball.velocity_m_s"][-1, 0] == pytest.approx(1.0714, abs=0.002)
        assert found.signals["ball.rate_rad_s"][-1, 1] == pytest.approx(42.857, abs=0.1)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_second_ball_changes_nothing_for_the_first_and_assisted_refuses(engine):
    first = {**BALL, "position_m": [0, 0, 0.525]}
    second = {**BALL, "position_m": [1, 0, 0.275]}
    with pytest.raises(Unsupported, match=f"{engine}.*single free body"):
        simulate(engine, bouncing({"ball": first, "other": second}), Settings(ASSISTED))
    alone = simulate(engine, bouncing({"ball": first}), Settings(TUNED))
    both = simulate(engine, bouncing({"ball": first, "other": second}), Settings(TUNED))
    np.testing.assert_allclose(
        both.signals["ball.position_m"], alone.signals["ball.position_m"], atol=1e-6
    )


@pytest.mark.parametrize("engine", ENGINES)
def test_velocities_are_labelled_where_they_are_not_the_samples_own(engine):
    made = scene("ball")
    assert simulate(engine, made, Settings(TUNED)).velocity_offset_s == 0
    offset_s = simulate(engine, made, Settings(ASSISTED)).velocity_offset_s
    assert abs(offset_s) == 0.0005
    fall = simulate(engine, made, Settings(ASSISTED))
    early = fall.time_s < 0.4
    np.testing.assert_allclose(
        fall.signals["ball.velocity_m_s"][early, 2][1:],
        -9.80665 * (fall.time_s[early][1:] + offset_s), atol=1e-9,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--judge", "tuned", "--contact", "default"], "tuned is not among the levels that run"),
        (["--assist", "landing", "--contact", "tuned"], "is for the level assisted"),
        (
            ["--contact", "a.json,b.json"],
            "a.json: there is no such file or folder; expected a fit",
        ),
    ],
)
def test_options_that_would_do_nothing_are_refused(call, words, told):
    code, _, err = call("run", "ball", "--engine", "pymunk", "--no-report", *words)
    assert code == 2
    assert told in err


def test_a_value_out_of_reach_is_the_users_to_change(call):
    code, out, _ = call(
        "run", "ball", "--engine", "mujoco", "--contact", "tuned", "--set", "restitution=0.01",
        "--seeds", "1", "--no-report",
    )  # fmt: skip
    assert code == 2
    assert "no spring and damper is calibrated for a restitution of 0.01" in " ".join(out.split())


def test_a_damaged_cache_is_found_again(monkeypatch, tmp_path):
    monkeypatch.setenv("SIMCOMPARE_CACHE", str(tmp_path))

    def number():
        found = simulate("pymunk", scene("ball"), Settings(TUNED))
        return found.tuning[0].numbers

    sought = number()
    (path,) = (tmp_path / "calibrations").glob("*.json")
    whole = path.read_text()
    path.write_text(whole.replace("0.8", "0.5"))
    assert number() == sought
    assert path.read_text() == whole
    path.write_text("")
    assert number() == sought
