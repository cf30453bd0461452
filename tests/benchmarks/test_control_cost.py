"""A controller in the loop, and an environment, beside the engine's bare steps.

``control``: the robot of 1 s with a controller that reads one signal before each step, over the
careful loop by hand (limit 20). ``environment``: control steps of 50 Hz with the 8×8 sensor, over
the same number of bare engine steps with the same voltages; limit 1/0.3. ``two processes``: steps a
second of two over those of one (at least 1.8 on a machine with two free cores).

Every round times the bare loop and then ours, so that both see the machine in the same mood.
"""

import functools
import statistics
import time

import numpy as np
import pytest

import simcompare
from simcompare.engine import engines
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue
from tests.benchmarks import bare_robot

ROBOT = catalogue.load("robot").resolve({}).model_copy(update={"sensors": {}})
ROUNDS, STEPS = 15, 200


def reading_one(time_s, readings):
    torque = 0.02 + 0.0 * readings["chassis.velocity_m_s"][0]
    return {"left_drive": torque, "right_drive": torque}


def told(benchmark, ours_s, bare_s):
    ratios = sorted(ours / bare for ours, bare in zip(ours_s, bare_s, strict=True))
    benchmark.extra_info["bare_ms"] = 1e3 * statistics.median(bare_s)
    benchmark.extra_info["ratio"] = statistics.median(ratios)
    benchmark.extra_info["low"], benchmark.extra_info["high"] = ratios[2], ratios[-3]


@pytest.mark.parametrize("engine", sorted(bare_robot.ENGINES))
def test_cost_of_a_controller(benchmark, engine):
    benchmark.group = f"{engine}, robot with a controller"
    count = round(ROBOT.world.duration_s / ROBOT.world.step_s)
    bare_s, ours_s = [], []

    def prepare():
        by_hand = bare_robot.ENGINES[engine](ROBOT.world.step_s)
        started = time.perf_counter()
        by_hand.record(count)
        bare_s.append(time.perf_counter() - started)
        return (engines.get(engine).open(ROBOT, Settings()),), {}

    def control(simulation):
        started = time.perf_counter()
        simulation.run(engine, "", reading_one)
        ours_s.append(time.perf_counter() - started)
        simulation.close()

    benchmark.pedantic(control, setup=prepare, rounds=ROUNDS)
    told(benchmark, ours_s, bare_s)


@pytest.mark.engines("mujoco")
def test_share_of_the_bare_engine_in_an_environment(benchmark):
    import mujoco

    pytest.importorskip("gymnasium")
    benchmark.group = "mujoco, environment at 50 Hz with the 8×8 sensor"
    environment = simcompare.gym("robot_avoid", engine="mujoco", control_Hz=50)
    actions = np.random.default_rng(0).uniform(-0.3, 0.3, (STEPS, 2))
    bare_s, ours_s = [], []

    def prepare():
        environment.reset(seed=3)
        simulation = environment._simulation
        start, model, data = simulation.save(), simulation._model, simulation.data
        started = time.perf_counter()
        for action in actions:
            data.ctrl[:] = action
            mujoco.mj_step(model, data, simulation.substeps)
        bare_s.append(time.perf_counter() - started)
        simulation.restore(start)

    def act():
        started = time.perf_counter()
        for action in actions:
            environment.step(action)
        ours_s.append(time.perf_counter() - started)

    benchmark.pedantic(act, setup=prepare, rounds=ROUNDS)
    environment.close()
    told(benchmark, ours_s, bare_s)


@pytest.mark.engines("mujoco")
def test_gain_of_two_processes(benchmark):
    gymnasium = pytest.importorskip("gymnasium")
    benchmark.group = "mujoco, environments in two processes over one"
    make = functools.partial(simcompare.gym, "robot_avoid", engine="mujoco", control_Hz=50)
    sets = [gymnasium.vector.AsyncVectorEnv([make] * n) for n in (1, 2)]
    spent_s = [[], []]

    def steps_of(several, found):
        actions = np.full((several.num_envs, 2), 0.1, dtype=np.float32)
        several.reset(seed=3)
        started = time.perf_counter()
        for _ in range(STEPS):
            several.step(actions)
        found.append((time.perf_counter() - started) / several.num_envs)

    def both():
        for several, found in zip(sets, spent_s, strict=True):
            steps_of(several, found)

    benchmark.pedantic(both, rounds=ROUNDS)
    for several in sets:
        several.close()
    told(benchmark, *spent_s)
