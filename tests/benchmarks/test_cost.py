"""Recording a drop through simcompare and through a careful loop written by hand.

``default``: the same plain steps, so the ratio is the cost of the tool alone (limit 1.1, and 1.0
for MuJoCo, whose steps go through its native rollout). ``mapped``: ours lands on every impact,
the bare loop does not, so the ratio is the price of a bounce that is right.
"""

import pytest

from simcompare import catalogue, engines
from simcompare.backend import Settings
from tests.benchmarks import bare

SCENARIO = catalogue.load("ball").resolve({})
COUNT = round(SCENARIO.world.duration_s / SCENARIO.world.step_s)


@pytest.mark.parametrize("who", ["bare", "ours"])
@pytest.mark.parametrize("contact", ["default", "mapped"])
@pytest.mark.parametrize("engine", sorted(bare.ENGINES))
def test_cost_of_a_drop(benchmark, engine, contact, who):
    benchmark.group = f"{engine}, {contact}"

    def opened():
        if who == "bare":
            return (bare.ENGINES[engine](1.0, 0.001, contact == "mapped"),), {}
        return (engines.get(engine).open(SCENARIO, Settings(contact)),), {}

    def whole(simulation):
        if who == "bare":
            return simulation.record(COUNT)
        found = simulation.run(engine, "")
        simulation.close()
        return found

    benchmark.pedantic(whole, setup=opened, rounds=15, warmup_rounds=2)
