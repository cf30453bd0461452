"""The contract notices a lying engine: each lie alone, by the name of the check that is for it."""

import pytest

from simcompare.backends import conformance, conformance_physics
from simcompare.backends.conformance_physics import Status
from simcompare.engine import engines
from simcompare.model.settings import ASSISTED, TUNED
from tests.lies import FIVE, FURTHER, Liar
from tests.lies_of_laws import LAWS, SHAPES
from tests.present import need

#: one engine of the plane, whose forces through joints need our help, and one of space
ENGINES = {"pymunk": ASSISTED, "mujoco": TUNED}
LIES = {**FIVE, **FURTHER, **LAWS, **SHAPES}
#: these happen in an impact between two free bodies, on which nobody lands with our help
PLAIN = {"balls_share_their_momentum"}


def failed(backend, level):
    found = conformance_physics.look_at_all(backend, [level])
    return {finding.check for finding in found if finding.status is Status.FAILED}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", LIES)
def test_each_lie_is_caught_by_its_check(name, engine):
    need(engine)
    lie = LIES[name]
    if lie.spatial and engine == "pymunk":
        return  # it would not show in a plane
    level = TUNED if lie.caught_by in PLAIN else ENGINES[engine]
    assert lie.caught_by in failed(Liar(engines.get(engine), lie), level)


@pytest.mark.parametrize("engine", ENGINES)
def test_all_lies_together_are_caught(engine):
    need(engine)
    liar = Liar(engines.get(engine), *FIVE.values())
    with pytest.raises(AssertionError) as caught:
        conformance.check_physics(liar, [ENGINES[engine]])
    for lie in FIVE.values():
        assert lie.caught_by in str(caught.value)


@pytest.mark.parametrize("engine", ENGINES)
def test_an_honest_engine_passes(engine):
    need(engine)
    assert conformance.check_physics(Liar(engines.get(engine)))


@pytest.mark.engines("mujoco")
def test_what_is_wrong_is_said_in_a_sentence():
    liar = Liar(engines.get("mujoco"), FIVE["no friction"])
    with pytest.raises(AssertionError, match=r"friction does not brake.* slid 0\.\d+ m for 0\.2"):
        conformance.check_physics(liar, [TUNED])


def test_every_check_of_physics_has_a_lie():
    assert {lie.caught_by for lie in LIES.values()} == {c.name for c in conformance.PHYSICS}


@pytest.mark.engines("pymunk")
def test_an_engine_that_refuses_everything_has_passed_nothing():
    mute = Liar(engines.get("pymunk"))
    mute.features = frozenset()
    with pytest.raises(AssertionError, match="nothing could be asked"):
        conformance.check_physics(mute)
