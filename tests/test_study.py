"""The study of the learnt policies: a small version of its table, by the same command."""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

pytest.importorskip("gymnasium")

from simcompare.errors import InputError
from simcompare.learning import policy, study
from simcompare.learning.trials import HELD_OUT, Trials, run_trials, wilson
from simcompare.scenarios.robot_avoid import task

FOLDER = Path(__file__).parent.parent / "examples" / "robot_avoid"


def script(name):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def row(successes, seed, sensors=0.0, learnt=("toy", 0.0)):
    return study.Row(learnt, seed, "toy", sensors, Trials(50, successes, 50 - successes, 0.5))


def test_shares_are_means_over_seeds_with_student_s_interval():
    found = study.over_seeds([row(40, 1), row(45, 2), row(35, 3), row(10, 1, 2.0)], "successes")
    three = found[("toy", 0.0), "toy", 0.0]
    half = stats.t.ppf(0.975, 2) * np.std([0.8, 0.9, 0.7], ddof=1) / math.sqrt(3)
    assert three.seeds == 3
    assert (three.mean, three.low) == pytest.approx((0.8, 0.8 - half))
    assert three.high == 1.0
    one = found[("toy", 0.0), "toy", 2.0]
    assert (one.mean, one.low, one.high, one.seeds) == (0.2, *wilson(10, 50), 1)


@pytest.mark.engines("mujoco", "rapier")
def test_the_command_makes_the_table_again(capsys):
    command = script("study")
    assert command.POLICIES
    command.POLICIES = command.POLICIES[:1]
    command.main(["mujoco", "rapier"], [0.0, 4.0], 3)
    head, line, *rows = capsys.readouterr().out.splitlines()
    assert head.startswith("| learnt on | errors there | tried on |")
    assert line == "|---|---|---|---|---|---|---|"
    assert [cells.split(" | ")[2:4] for cells in rows] == [
        ["mujoco", "0"], ["mujoco", "4"], ["rapier", "0"], ["rapier", "4"],
    ]  # fmt: skip


POLICIES = sorted(FOLDER.glob("policies/*.npz"))


@pytest.mark.parametrize("path", POLICIES, ids=lambda path: path.stem)
def test_a_policy_that_ships_fits_and_says_how_it_was_learnt(path):
    recipe = policy.load(path, task.OBSERVATIONS, task.ACTIONS).recipe
    said = {"scenario", "steps", "step_s", "algorithm", "n_epochs", "imitated", "rounds", "layers"}
    assert said <= recipe.keys()
    assert path.stem == f"{recipe['engine']}_{recipe['sensors']:g}_seed{recipe['seed']}"


def test_five_seeds_of_two_engines_ship_with_ideal_and_with_real_sensors():
    seeds = {}
    for path in POLICIES:
        kind, _, seed = path.stem.rpartition("_seed")
        seeds.setdefault(kind, []).append(int(seed))
    assert seeds.keys() == {"mujoco_0", "mujoco_1", "pybullet_0", "pybullet_1"}
    assert all(sorted(found) == [1, 2, 3, 4, 5] for found in seeds.values())


@pytest.mark.engines("mujoco")
@pytest.mark.parametrize(
    "path", [path for path in POLICIES if path.stem.endswith("seed1")], ids=lambda path: path.stem
)
def test_a_policy_that_ships_beats_driving_straight_on(path):
    act = policy.load(path, task.OBSERVATIONS, task.ACTIONS)
    environment = study.Environment(
        study.Asked(
            "robot_avoid", "mujoco", sensors=act.recipe["sensors"], step_s=script("study").STEP_S
        )
    )
    seeds = range(HELD_OUT, HELD_OUT + 20)
    straight, learnt = (run_trials(environment, one, seeds) for one in (task.straight_on, act))
    environment.close()
    assert learnt.collisions < straight.collisions


@pytest.mark.engines("mujoco")
def test_a_policy_of_another_task_is_refused_before_it_drives(tmp_path):
    layers = [(np.zeros((3, 7)), np.zeros(3))]
    policy.Policy(np.zeros(7), np.ones(7), layers).save(tmp_path / "other.npz")
    with pytest.raises(InputError) as caught:
        list(study.try_all("robot_avoid", [tmp_path / "other.npz"], ["mujoco"], [0.0], 1))
    assert len(caught.value.faults) == 3
    assert "the observation of the environment has 159" in str(caught.value)
