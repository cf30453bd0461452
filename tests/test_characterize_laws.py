"""Friction, a hinge and forces: engines made up of closed forms, and closed forms of real steps."""

import math

import numpy as np
import pytest

from simcompare.characterization import force, friction, joint
from simcompare.characterization.force import ForceQuestion
from simcompare.characterization.friction import FrictionQuestion
from simcompare.characterization.joint import JointQuestion
from simcompare.engine import engines
from simcompare.engine.calibration import cache
from simcompare.model.settings import ASSISTED, TUNED
from simcompare.model.trajectory import Trajectory

STEP_S = 1e-3


@pytest.fixture(autouse=True)
def _nothing_kept(monkeypatch):
    monkeypatch.setattr(cache, "kept", lambda backend, question, kind, find: find())


class Coulomb:
    """An engine that solves a block on a plane exactly, with a friction and a creep of its own."""

    name = "coulomb"

    def __init__(self, factor=1.0, creep_m_s=0.0):
        self.factor, self.creep_m_s = factor, creep_m_s

    def simulate(self, scenario, settings):
        world = scenario.world
        time_s = np.arange(round(world.duration_s / world.step_s) + 1) * world.step_s
        pull, _, down = world.gravity_m_s2
        grip = -down * scenario.contacts[0].friction * self.factor
        speed = scenario.bodies["block"].velocity_m_s[0]
        if speed == 0 and pull <= grip:
            along = self.creep_m_s * time_s
        else:
            change = pull - grip
            ends = speed / -change if change < 0 else math.inf
            t = np.minimum(time_s, ends)
            along = speed * t + change * t**2 / 2
        place = np.column_stack((along, np.zeros((len(along), 1)), np.full(len(along), 0.015)))
        return Trajectory("coulomb", time_s, {"block.position_m": place})


@pytest.mark.parametrize("factor", [0.5, 1.0, 1.2])
@pytest.mark.parametrize("step_s", [0.25e-3, 1e-3, 8e-3])
def test_friction_of_an_exact_block_is_found(factor, step_s):
    found = FrictionQuestion(TUNED, step_s)(Coulomb(factor))
    # halving 4 µN twelve times leaves a thousandth, rounded samples of the start half as much
    assert found.lets_go_at == pytest.approx(factor, abs=2e-3)
    for one in found.braking:
        if math.isfinite(one.braking):  # where it does not stop before it can be read
            assert one.braking == pytest.approx(factor, rel=1e-6)
            assert one.braking_scatter == pytest.approx(0, abs=1e-9)
        assert not one.stops_at_once
    assert math.isfinite(found.braking[-1].braking)
    assert [one.lets_go_at for one in found.over_step] == pytest.approx([factor] * 6, abs=2e-3)


def test_creep_is_no_sliding():
    found = FrictionQuestion(TUNED, STEP_S)(Coulomb(creep_m_s=0.002))
    assert found.lets_go_at == pytest.approx(1, abs=2e-3)
    assert [one.creep_m_s for one in found.creep] == pytest.approx([0.002] * 3)


def test_a_block_that_nothing_moves_or_that_stops_at_once_is_told():
    found = FrictionQuestion(TUNED, STEP_S)(Coulomb(1e6))
    assert found.lets_go_at is None
    assert all(one.stops_at_once for one in found.braking)


@pytest.mark.engines("pymunk")
def test_friction_of_a_real_engine_is_coulombs():
    found = FrictionQuestion(TUNED, STEP_S)(engines.get("pymunk"))
    assert found.lets_go_at == pytest.approx(1, abs=2e-3)
    for one in found.braking:
        assert one.braking == pytest.approx(1, rel=1e-3)


@pytest.mark.parametrize("step_s", [0.25e-3, 1e-3, 8e-3])
@pytest.mark.parametrize("zeta", [0.02, 0.1, 0.3])
def test_a_swing_is_read_from_its_poles(step_s, zeta):
    omega = joint.OMEGA
    time_s = np.arange(round(0.6 / step_s)) * step_s
    ringing = omega * math.sqrt(1 - zeta**2)
    angle = np.exp(-zeta * omega * time_s) * np.sin(ringing * time_s)
    assert joint.swing_of(angle, step_s) == pytest.approx((omega, zeta), rel=1e-6)


def test_a_spin_is_read_from_its_decay_and_a_held_one_is_told():
    time_s = np.arange(200) * STEP_S
    assert joint.decay_rate(3 * np.exp(-7 * time_s), STEP_S) == pytest.approx(7)
    assert joint.decay_rate(np.where(time_s > 0, 0.0, 8.0), STEP_S) == math.inf


#: how a step takes the damper: with the rate after it, or with the one before
IMPLICIT = {"mujoco": True, "dart": True, "pymunk": False, "ode": False}


@pytest.mark.parametrize("name", [pytest.param(n, marks=pytest.mark.engines(n)) for n in IMPLICIT])
def test_a_damper_decays_as_the_engines_step_does(name):
    found = JointQuestion(TUNED, STEP_S)(engines.get(name))
    for one in found.over_step:
        x = joint.DECAY * one.step_s
        wanted = math.log1p(x) / x if IMPLICIT[name] else -math.log1p(-x) / x
        # rounding of a fit through logarithms
        assert one.damping == pytest.approx(wanted, rel=1e-6)
        assert one.damping_with_armature == pytest.approx(wanted, rel=1e-6)
        assert one.inertia == pytest.approx(1, rel=1e-6)


@pytest.mark.engines("pymunk")
def test_a_spring_that_acts_at_the_old_place_loses_damping():
    found = JointQuestion(TUNED, STEP_S)(engines.get("pymunk"))
    for one in found.over_step[:4]:
        # positions first: the spring lags by a step, which takes ω·dt/2 from the damping ratio
        lost = joint.OMEGA * one.step_s / 2
        assert one.damping_ratio == pytest.approx(1 - lost / joint.ZETA, abs=0.01)


@pytest.mark.engines("mujoco")
def test_with_our_helps_a_hinge_follows_its_closed_form():
    found = JointQuestion(ASSISTED, STEP_S)(engines.get("mujoco"))
    for name in ("damping", "inertia", "frequency", "damping_ratio"):
        # second order in ω·dt = 0.04
        assert getattr(found, name) == pytest.approx(1, abs=2e-3)


def test_jitter_is_what_is_no_level_and_no_sine():
    rng = np.random.default_rng(1)
    time_s = 0.2 + np.arange(4000) * 5e-5
    noise = 0.03 * rng.standard_normal(4000)
    level = force.of_level(2 + noise, 2.0)
    # a mean over 4000 samples scatters by 2 % of its jitter
    assert level.ratio == pytest.approx(1, abs=1e-3)
    assert level.jitter == pytest.approx(0.015, rel=0.05)
    sine = force.of_sine(time_s, 1.5 * np.sin(2 * math.pi * 10 * time_s + 0.4) + noise, 1.5)
    assert sine.ratio == pytest.approx(1, abs=2e-3)
    assert sine.jitter == pytest.approx(0.02, rel=0.05)


@pytest.mark.engines("mujoco")
def test_forces_of_a_real_engine_are_newtons():
    found = ForceQuestion(TUNED, STEP_S)(engines.get("mujoco"))
    assert set(found.cases) == set(force.CASES)
    for case in ("contact_rest", "weld_rest", "weld_pushed", "weld_shaken"):
        # what the solver of contacts iterates to
        assert found.cases[case].ratio == pytest.approx(1, abs=1e-6)
        assert found.cases[case].jitter < 1e-6


@pytest.mark.engines("box2d")
def test_a_force_that_is_not_told_has_its_reason():
    found = ForceQuestion(TUNED, STEP_S)(engines.get("box2d"))
    assert "no contact forces" in found.lacks["contact_rest"]
    assert found.cases["weld_rest"].ratio == pytest.approx(1, abs=1e-3)


def test_a_block_does_not_tip_before_the_largest_load():
    made = FrictionQuestion(TUNED, STEP_S).scene(STEP_S, 0.1, friction.MAX_LOAD)
    pull, _, down = made.world.gravity_m_s2
    length, _, height = made.bodies["block"].shapes[0].size_m
    assert pull / -down < length / height
