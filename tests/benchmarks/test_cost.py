"""Recording a drop through simcompare and through a careful loop written by hand.

``default``: the same plain steps, so the ratio is the cost of the tool alone (limit 1.1, and 1.0
for MuJoCo, whose steps go through its native rollout). ``mapped``: ours lands on every impact,
the bare loop does not, so the ratio is the price of a bounce that is right.

Every round times the bare loop and then ours, so that both see the machine in the same mood.
"""

import statistics
import time

import pytest

from simcompare import catalogue, engines
from simcompare.backend import Settings
from tests.benchmarks import bare

SCENARIO = catalogue.load("ball").resolve({})
COUNT = round(SCENARIO.world.duration_s / SCENARIO.world.step_s)
ROUNDS = 25


@pytest.mark.parametrize("contact", ["default", "mapped"])
@pytest.mark.parametrize("engine", sorted(bare.ENGINES))
def test_cost_of_a_drop(benchmark, engine, contact):
    benchmark.group = f"{engine}, {contact}"
    bare_s, ours_s = [], []

    def time_the_bare_loop_and_open():
        simulation = bare.ENGINES[engine](1.0, SCENARIO.world.step_s, contact == "mapped")
        started = time.perf_counter()
        simulation.record(COUNT)
        bare_s.append(time.perf_counter() - started)
        return (engines.get(engine).open(SCENARIO, Settings(contact)),), {}

    def record(simulation):
        started = time.perf_counter()
        found = simulation.run(engine, "")
        ours_s.append(time.perf_counter() - started)
        simulation.close()
        return found

    found = benchmark.pedantic(record, setup=time_the_bare_loop_and_open, rounds=ROUNDS)
    assert len(found.time_s) == COUNT + 1
    ratios = sorted(ours / theirs for ours, theirs in zip(ours_s, bare_s, strict=True))
    benchmark.extra_info["ratio"] = statistics.median(ratios)
    benchmark.extra_info["low"], benchmark.extra_info["high"] = ratios[2], ratios[-3]
    benchmark.extra_info["bare_ms"] = 1e3 * statistics.median(bare_s)
