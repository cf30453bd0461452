"""A task as an environment of Gymnasium: seeds, engines, speed's own rules, and bad input."""

import functools
import itertools
import math

import numpy as np
import pytest

import simcompare
from simcompare.engine import engines
from simcompare.engine.features import needs
from simcompare.errors import InputError, UnknownName, Unsupported
from simcompare.scenarios import catalogue
from simcompare.scenarios.robot_avoid import task

gymnasium = pytest.importorskip("gymnasium")

SPATIAL = [
    name
    for name in engines.names()
    if not needs(catalogue.load("robot_avoid").resolve()).required - engines.get(name).features
]
AHEAD = np.array((1.0, 1.0), dtype=np.float32)


@pytest.mark.engines("mujoco")
def test_the_checker_of_gymnasium_finds_nothing():
    from gymnasium.utils.env_checker import check_env

    check_env(simcompare.gym("robot_avoid", engine="mujoco"), skip_render_check=True)


@pytest.mark.parametrize("engine", SPATIAL)
def test_a_seed_is_one_episode_on_every_engine(engine):
    environment = simcompare.gym("robot_avoid", engine=engine, sensors=1, control_Hz=10)
    runs = []
    for _ in range(2):
        seen, told = environment.reset(seed=5)
        ends = [environment.step(AHEAD) for _ in range(3)]
        runs.append((seen, told, ends))
    environment.close()
    (seen, told, ends), (again, told_again, ends_again) = runs
    np.testing.assert_array_equal(seen, again)
    assert told == told_again
    assert told["parameters"] == task.draw(np.random.Generator(np.random.PCG64(5)))
    for one, other in zip(ends, ends_again, strict=True):
        np.testing.assert_array_equal(one[0], other[0])
        assert one[1:] == other[1:]
    # 0.3 s at 3 V: v∞·(t - T·(1 - exp(-t/T))) = 59 mm, less what drawn friction and resistance do
    assert ends[-1][4]["way_m"] == pytest.approx(0.059, abs=0.004)


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_nearing_the_goal_is_rewarded_and_touching_something_ends_it(engine):
    environment = simcompare.gym("robot_avoid", engine=engine, sensors=0)
    free = {
        "goal_x_m": 1.2,
        "goal_y_m": 0.0,
        "arena_x_m": 0.7,
        "arena_y_m": 0.0,
        "arena_turn_rad": 0,
    }
    away = {f"{n}_x_m": 0.2 * i for i, n in enumerate(("box_1", "box_2", "box_3", "post_1"))}
    free |= away | {f"{name.removesuffix('x_m')}y_m": 0.8 for name in away}
    free |= {"post_2_x_m": 0.8, "post_2_y_m": 0.8, "post_3_x_m": 1.0, "post_3_y_m": 0.8}
    environment.reset(seed=1, options={"set": free})
    is_over, rewards = False, []
    while not is_over:
        _, reward, is_over, is_cut, told = environment.step(AHEAD)
        rewards.append(reward)
    assert told["is_success"]
    assert not told["collided"]
    assert not is_cut
    # 2 for a metre nearer, 0.02 for a step, 10 at the end, 0.002 for the first change of action
    nearer = 1.22 - told["away_m"]
    expected = 10 + 2 * nearer - 0.02 * len(rewards) - 0.002
    assert sum(rewards) == pytest.approx(expected, abs=1e-9)
    environment.reset(seed=1, options={"set": free | {"post_2_x_m": 0.5, "post_2_y_m": 0.0}})
    is_over = False
    while not is_over:
        _, reward, is_over, _, told = environment.step(AHEAD)
    environment.close()
    assert told["collided"]
    assert not told["is_success"]
    assert reward < -9
    # it ends as soon as the disc meets the post, so not deeper than it drives in a control step
    assert -0.03 < told["clearance_m"] <= 0


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_frames_come_15_times_a_second_at_most(engine):
    environment = simcompare.gym("robot_avoid", engine=engine, control_Hz=50, sensors=1)
    frames = [environment.reset(seed=2)[0][:64]]
    frames += [environment.step(AHEAD)[0][:64] for _ in range(8)]
    environment.close()
    same = [np.array_equal(a, b) for a, b in itertools.pairwise(frames)]
    assert same == [True, True, True, False, True, True, True, False]


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_it_is_cut_off_after_its_longest_time(engine):
    environment = simcompare.gym("robot_avoid", engine=engine, step="10ms")
    environment.reset(seed=1)
    ends = [environment.step(np.zeros(2, dtype=np.float32))[2:4] for _ in range(150)]
    environment.close()
    assert ends == [(False, False)] * 149 + [(False, True)]


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_two_processes_see_what_one_does(engine):
    make = functools.partial(simcompare.gym, "robot_avoid", engine=engine)
    both = gymnasium.vector.AsyncVectorEnv([make, make])
    seen, _ = both.reset(seed=[3, 4])
    then, *_ = both.step(np.array([AHEAD, AHEAD]))
    both.close()
    for k, seed in enumerate((3, 4)):
        alone = make()
        np.testing.assert_array_equal(seen[k], alone.reset(seed=seed)[0])
        np.testing.assert_array_equal(then[k], alone.step(AHEAD)[0])
        alone.close()


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_numbers_that_make_no_sense_are_told_at_once(engine):
    with pytest.raises(InputError) as caught:
        simcompare.gym("robot_avoid", engine=engine, sensors=-1, control_Hz=30)
    assert "sensors = -1; expected 0 (ideal)" in str(caught.value)
    assert "control_Hz = 30: a control step is no whole number" in str(caught.value)
    for sensors in (math.nan, math.inf):
        with pytest.raises(InputError, match="sensors"):
            simcompare.gym("robot_avoid", engine=engine, sensors=sensors)
    with pytest.raises(InputError, match="no episode has begun; call reset"):
        simcompare.gym("robot_avoid", engine=engine).step(AHEAD)
    for asked, words in (
        ({"control_Hz": 0}, "control_Hz = 0; expected at least 2, such as 5"),
        ({"control_Hz": 0.01}, "control_Hz = 0.01; expected at least 2"),
        ({"control_Hz": math.nan}, "control_Hz = nan"),
        ({"control_Hz": math.inf}, "no whole number of engine steps"),
        ({"step": 0}, "step = 0 s; expected more than 0"),
        ({"step": -0.001}, "step = -0.001 s; expected more than 0"),
        ({"step": 10}, "expected such as control_Hz = 5 with step = 0.2"),
        ({"step": 1e-9}, "step = 1e-09 s; expected at least 2e-05 s"),
        ({"sensors": 1e300}, "sensors = 1e\\+300; expected .* at most 1000"),
        ({"step": -1, "control_Hz": math.nan, "sensors": -1}, "3 faults"),
    ):
        with pytest.raises(InputError, match=words):
            simcompare.gym("robot_avoid", engine=engine, **asked)


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_what_is_no_action_changes_nothing(engine):
    """It is refused before anything is noted or moved, so the step after it is as ever."""
    environment = simcompare.gym("robot_avoid", engine=engine)
    environment.reset(seed=1)
    wanted = environment.step(AHEAD)
    environment.reset(seed=1)
    none = ([math.nan, 0], [math.inf, 0], [1], [1, 2, 3], [[1, 2]], 0.5, None, "ab", [1j, 0])
    for action in none:
        with pytest.raises(InputError, match="; expected 2 finite numbers within -1 and 1"):
            environment.step(action)
    found = environment.step(AHEAD)
    np.testing.assert_array_equal(found[0], wanted[0])
    assert found[1:] == wanted[1:]
    environment.close()


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_an_episode_takes_parameters_with_units_and_nothing_else(engine):
    environment = simcompare.gym("robot_avoid", engine=engine)
    _, told = environment.reset(seed=1, options={"set": {"track": "12.5cm", "tyre_friction": 0.5}})
    assert told["parameters"]["track_m"] == pytest.approx(0.125, rel=1e-12)
    assert told["parameters"]["tyre_friction"] == 0.5
    for options, words in (
        ({"sets": {}}, "expected such as"), ([1], "expected such as"), ({"set": 3}, "names with"),
        ({"set": {"track_m": "12kg"}}, "options, set: track_m: the unit 'kg' does not fit"),
        ({"set": {"nope": 1}}, "no parameter is called 'nope'"),
        ({"set": {"track_m": None, 1: 1, "voltage_V": True}}, "reset: 3 faults"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            environment.reset(options=options)
    for seed in (-1, 1.5, "1", True):
        with pytest.raises(InputError, match=r"seed=.*; expected a whole number from 0 on"):
            environment.reset(seed=seed)
    assert environment.step(AHEAD)  # what was refused has ended nothing
    environment.close()


@pytest.mark.parametrize("engine", SPATIAL[:1])
def test_only_scenarios_with_a_task_are_environments(engine):
    with pytest.raises(UnknownName, match=r"scenario with a task.*ball.*robot_avoid"):
        simcompare.gym("ball", engine=engine)
    with pytest.raises(InputError, match="goal_x_m = 9 m is outside"):
        simcompare.gym("robot_avoid", engine=engine, set={"goal_x": "9m"})


@pytest.mark.engines("pymunk")
def test_an_engine_in_the_plane_is_refused():
    with pytest.raises(Unsupported, match="pymunk has no"):
        simcompare.gym("robot_avoid", engine="pymunk")
