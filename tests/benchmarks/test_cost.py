"""Recording through simcompare and through a careful loop written by hand.

``ball, default``, ``ball, tuned`` and ``robot, assisted``: the same plain steps, so the ratio is
the cost of the tool alone (limit 1.05 for ``tuned``, and 0.95 for MuJoCo, whose steps go through
its native rollout). ``ball, assisted``: ours lands on every impact, the bare loop does not, so the
ratio is the price of a bounce that is right. The robot is recorded without its force sensors,
which the bare loop does not read either.

Every round times the bare loop and then ours, so that both see the machine in the same mood.
"""

import statistics
import time

import pytest

from simcompare.engine import engines
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue
from tests.benchmarks import bare, bare_robot

BALL = catalogue.load("ball").resolve({})
ROBOT = catalogue.load("robot").resolve({}).model_copy(update={"sensors": {}})
ROUNDS = 25


@pytest.mark.parametrize("contact", ["default", "tuned", "assisted"])
@pytest.mark.parametrize("engine", sorted(bare.ENGINES))
def test_cost_of_a_drop(benchmark, engine, contact):
    step_s = BALL.world.step_s
    by_hand = lambda: bare.ENGINES[engine](1.0, step_s, contact)  # noqa: E731
    compare(benchmark, f"{engine}, ball, {contact}", by_hand, engine, BALL, contact)


@pytest.mark.parametrize("engine", sorted(bare_robot.ENGINES))
def test_cost_of_a_drive(benchmark, engine):
    by_hand = lambda: bare_robot.ENGINES[engine](ROBOT.world.step_s)  # noqa: E731
    compare(benchmark, f"{engine}, robot, assisted", by_hand, engine, ROBOT, "assisted")


def compare(benchmark, group, by_hand, engine, scenario, contact):
    benchmark.group = group
    count = round(scenario.world.duration_s / scenario.world.step_s)
    bare_s, ours_s = [], []

    def time_the_bare_loop_and_open():
        simulation = by_hand()
        started = time.perf_counter()
        simulation.record(count)
        bare_s.append(time.perf_counter() - started)
        return (engines.get(engine).open(scenario, Settings(contact)),), {}

    def record(simulation):
        started = time.perf_counter()
        found = simulation.run(engine, "")
        ours_s.append(time.perf_counter() - started)
        simulation.close()
        return found

    found = benchmark.pedantic(record, setup=time_the_bare_loop_and_open, rounds=ROUNDS)
    assert len(found.time_s) == count + 1
    ratios = sorted(ours / theirs for ours, theirs in zip(ours_s, bare_s, strict=True))
    benchmark.extra_info["ratio"] = statistics.median(ratios)
    benchmark.extra_info["low"], benchmark.extra_info["high"] = ratios[2], ratios[-3]
    benchmark.extra_info["bare_ms"] = 1e3 * statistics.median(bare_s)
