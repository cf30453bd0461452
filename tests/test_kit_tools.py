"""Small tools of the kit: tokens that free what they stand for, stale forces, failed scenes."""

import gc

import numpy as np
import pytest

from simcompare.engine.helps.reactions import acting_force
from simcompare.errors import ReadBackMismatch, Unsupported
from simcompare.kit import Keeper, minus, plus, turned_back, xyzw
from simcompare.model.audit import Audit
from simcompare.model.rotations import conjugate, rotate
from simcompare.model.scenario import Scenario
from simcompare.model.settings import TUNED, Settings
from simcompare.scenarios import catalogue
from tests.toy_engine import ToyBackend, ToySimulation


def test_what_nobody_holds_is_freed_once_and_not_after_the_engine_is_gone():
    freed = []
    keeper = Keeper(freed.append)
    one, two, three = keeper.hold(1), keeper.hold(2), keeper.hold(3)
    del two
    gc.collect()
    assert freed == [2]
    assert one.number == 1
    del one
    gc.collect()
    keeper.close()
    del three
    gc.collect()
    assert freed == [2, 1]


def test_forces_of_points_too_far_apart_are_left_out():
    points = [(1.0, -1e-6), (2.0, 1e-5), (4.0, 2e-5)]
    assert acting_force(points, 1e-5) == 3.0
    assert acting_force(points, float("inf")) == 7.0
    assert acting_force([], 0.0) == 0.0


def test_a_scene_that_cannot_be_set_up_is_closed():
    closed = []

    class Failing(ToySimulation):
        def set_up(self):
            raise Unsupported("toy cannot")

        def close(self):
            closed.append(True)

    fall = catalogue.load("ball").resolve({"restitution": 0.0}).model_dump()
    fall["bodies"]["ball"]["drag"] = None
    with pytest.raises(Unsupported, match="toy cannot"):
        ToyBackend(Failing).open(Scenario.model_validate(fall), Settings(TUNED))
    assert closed == [True]


def test_a_scene_that_starts_otherwise_than_it_was_told_is_closed():
    closed = []

    class Still(ToySimulation):
        def place_all(self):
            super().place_all()
            self.v = {name: [0.0] * len(rates) for name, rates in self.v.items()}

        def close(self):
            closed.append(True)

    thrown = catalogue.load("ball").resolve({"restitution": 0.0}).model_dump()
    thrown["bodies"]["ball"] |= {"drag": None, "velocity_m_s": (1.0, 0.0, 0.0)}
    with pytest.raises(ReadBackMismatch, match=r"ball\.velocity_m_s\.x"):
        ToyBackend(Still).open(Scenario.model_validate(thrown), Settings(TUNED))
    assert closed == [True]


def test_parameters_without_a_getter_say_what_was_left_on():
    audit = Audit("toy")
    audit.add_without_getter("contact", {"slop": (0.0, 1e-5)}, is_given=True)
    audit.add_without_getter("contact", {"slop": (0.0, 1e-5)}, is_given=False)
    audit.add_without_getter("motor", {"force": (0.0, None)}, is_given=False, stated=0.0)
    given, left, motor = audit.finish()
    assert (given.set_value, given.read_value, given.note) == (0.0, None, "it has no getter")
    assert left.set_value is None
    assert left.note == "it has no getter; the engine's own, 1e-05, was left on"
    assert (motor.scenario_value, motor.note) == (
        0.0, "it has no getter; the engine's own was left on",
    )  # fmt: skip


def test_one_vector_is_turned_as_whole_recordings_are():
    turn = np.array([0.8, 0.2, -0.4, 0.4]) / np.linalg.norm([0.8, 0.2, -0.4, 0.4])
    vector = (0.3, -1.2, 2.5)
    wanted = rotate(conjugate(turn[None]), np.array([vector]))[0]
    assert turned_back(tuple(turn), vector) == pytest.approx(wanted, rel=1e-14)
    assert xyzw((1.0, 2.0, 3.0, 4.0)) == (2.0, 3.0, 4.0, 1.0)
    assert minus(plus((1.0, 2.0, 3.0), (0.5, 0.5, 0.5)), (1.0, 1.0, 1.0)) == (0.5, 1.5, 2.5)
