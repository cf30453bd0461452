"""A bounce is characterized as bare loops of the engines show it, and edges are where they are."""

import functools
import math

import numpy as np
import pytest

from simcompare.characterization import bounce, grids
from simcompare.characterization.behaviour import StepLimits
from simcompare.characterization.bounce import BounceQuestion
from simcompare.engine import engines
from simcompare.engine.backend import EngineBackend
from simcompare.engine.calibration import cache
from simcompare.engine.calibration.drops import Bounces, even_phases, read_drops, start_above
from simcompare.engine.calibration.engine_drops import EngineDrops
from simcompare.engine.features import Feature
from simcompare.errors import SimulationDiverged, Unsupported
from simcompare.model.settings import ASSISTED, COEFFICIENTS, DEFAULT, TUNED
from tests.bare_drops import COEFFICIENT_ENGINES, G, MujocoDrops, PybulletDrops
from tests.present import INSTALLED, need

STEP_S = 1e-3
#: height from which a drop begins at least, where its speed allows [m]
CLEAR_M = 0.04
BARE = {"mujoco": MujocoDrops, **COEFFICIENT_ENGINES}


@functools.cache
def tuned(name):
    """What an engine answers at "tuned"."""
    need(name)
    return BounceQuestion(TUNED, STEP_S)(engines.get(name))


def row(rows, key, value):
    return next(one for one in rows if getattr(one, key) == pytest.approx(value))


@pytest.mark.parametrize("name", BARE)
@pytest.mark.parametrize(("speed_m_s", "step_s"), [(0.3, 1e-3), (2.0, 1e-3), (2.0, 4e-3)])
def test_a_bare_loop_of_the_engine_shows_the_same(name, speed_m_s, step_s):
    found = tuned(name)
    if step_s == STEP_S:
        got = row(found.over_speed, "speed_m_s", speed_m_s)
    else:
        got = row(found.over_step, "step_s", step_s)
    bare = BARE[name](step_s)
    bare.open(*found.numbers)
    squared = speed_m_s**2 - 2 * G * CLEAR_M
    fall_s = (speed_m_s - math.sqrt(max(squared, 0.0))) / G
    starts = [
        start_above(speed_m_s, phase, step_s, G, max(6, math.floor(fall_s / step_s)))
        for phase in even_phases(bounce.PHASES)
    ]
    e = read_drops([bare.record(*start) for start in starts], step_s, G).restitution
    # the same engine, numbers and starts; the bare records end earlier, so that a step that is
    # nearly free counts more where the flight is read (4e-5 in 2 of 25 phases of pymunk)
    assert got.mean == pytest.approx(e.mean(), rel=1e-5)
    assert got.scatter == pytest.approx(e.std(), rel=1e-3)
    assert got.bounced == 1


@pytest.mark.parametrize("name", ["dart", "pybullet"])
def test_gravity_acts_for_a_step_before_these_engines_bounce(name):
    found = tuned(name)
    (p,) = found.numbers
    for one in found.over_speed:
        early = G * STEP_S / one.speed_m_s
        if one.mean > 0.5 and early < 0.05:
            # the step in which the contact is noticed begins up to a step later, and deeper: a
            # part of the same size, between 0.7 and 1.1 of it where it was measured
            assert one.mean / p - 1 == pytest.approx(early, rel=0.3)


@pytest.mark.engines("pybullet")
def test_where_it_hops_for_ever_an_impact_loses_nothing():
    found = tuned("pybullet")
    hops_m_s = found.hops_at_m_s
    (p,) = found.numbers
    # by the law of first order; of second order is a tenth
    assert hops_m_s == pytest.approx(p * G * STEP_S / (1 - p), rel=0.15)
    plan = BounceQuestion(TUNED, STEP_S).plan(STEP_S)
    backend = engines.get("pybullet")
    drops = EngineDrops(backend, backend.load(), plan)
    slower, faster = (drops((p,), k * hops_m_s, even_phases(25)).mean for k in (0.95, 1.05))
    assert slower > 1 > faster


@pytest.mark.engines("pybullet")
def test_a_ball_that_is_let_go_in_a_bare_loop_ends_in_those_hops():
    found = tuned("pybullet")
    bare = PybulletDrops(STEP_S)
    bare.open(*found.numbers)
    bare.place(0.01, 0.0)
    heights = np.array([bare.step() for _ in range(6000)])[3000:]  # at rest after 0.4 s else
    tops = heights[1:-1][(heights[1:-1] > heights[:-2]) & (heights[1:-1] >= heights[2:])]
    assert len(tops) > 300
    # hops of some 8 steps never repeat: speeds scatter by g·dt, a quarter of them, about this
    assert math.sqrt(2 * G * tops.mean()) == pytest.approx(found.hops_at_m_s, rel=0.2)


@pytest.mark.parametrize("name", INSTALLED)
def test_with_our_helps_the_bounce_is_right_at_every_speed_until_it_dies(name):
    backend = engines.get(name)
    found = BounceQuestion(ASSISTED, STEP_S)(backend)
    dies_m_s = found.dies_below_m_s or 0.0
    alive = [one for one in found.over_speed if one.speed_m_s > dies_m_s]
    assert len(alive) > 8
    for one in alive:
        # what landing is accepted with: 2e-3 in restitution
        assert one.mean == pytest.approx(0.8, abs=2e-3)
        assert one.bounced == 1


@pytest.mark.engines("pybullet")
def test_an_engines_own_damping_is_no_contact():
    # 0.04/s by default: at 5 m/s that is 2 % of gravity in every step of a flight
    found = BounceQuestion(COEFFICIENTS, STEP_S)(engines.get("pybullet"))
    assert row(found.over_speed, "speed_m_s", 5.0).bounced == 1


class MadeBackend(EngineBackend):
    """Stands for an engine whose bounces are made up."""

    name = "made"
    features = frozenset(Feature)
    known_limits = ()
    mapping = ""
    helps = frozenset({"landing"})

    def version(self):
        return "1"

    def load(self):
        return None

    def make(self, engine, scene):
        raise AssertionError


@pytest.fixture
def answer(monkeypatch):
    """What comes of a made-up law e(speed, step): ``answer(law, level="coefficients")``."""

    def ask(law, level=COEFFICIENTS, step_s=STEP_S):
        class MadeDrops(EngineDrops):
            def __call__(self, numbers, speed_m_s, phases):
                e = np.array([law(speed_m_s, self._plan.step_s) for _ in phases])
                return Bounces(e, e, e, e)

        monkeypatch.setattr(bounce, "EngineDrops", MadeDrops)
        monkeypatch.setattr(cache, "kept", lambda backend, question, kind, find: find())
        return BounceQuestion(level, step_s)(MadeBackend())

    return ask


def test_edges_are_found_between_the_speeds_that_are_tried(answer):
    found = answer(lambda v, dt: 0.8 if v > 0.13 else math.nan)
    assert found.dies_below_m_s == pytest.approx(0.13, rel=0.01)
    assert found.hops_at_m_s is None
    found = answer(lambda v, dt: 0.8 * (1 + G * dt / v))
    assert found.dies_below_m_s is None
    # e·g·dt/(1 - e), slower than the slowest that is drawn; six halvings leave half a per cent
    assert found.hops_at_m_s == pytest.approx(4 * G * STEP_S, rel=0.01)


def test_what_gains_at_every_speed_ends_in_no_steady_hops(answer):
    assert answer(lambda v, dt: 1.1).hops_at_m_s is None


def test_edges_are_found_between_the_steps_that_are_tried(answer):
    found = answer(lambda v, dt: 0.8 + 2 * dt)
    assert found.too_large == StepLimits(None, pytest.approx(4e-3, rel=0.01))
    assert found.too_small == StepLimits(None, None)
    assert found.gains_above_s is None
    found = answer(lambda v, dt: 0.8 - 2 * dt)
    assert found.too_small == StepLimits(None, pytest.approx(4e-3, rel=0.01))
    assert found.too_large == StepLimits(None, None)
    found = answer(lambda v, dt: 0.8 + 40 * dt)
    assert found.gains_above_s == pytest.approx(5e-3, rel=0.01)


def test_a_number_of_a_long_step_is_off_at_shorter_ones(answer):
    found = answer(lambda v, dt: 0.8 + 4 * (dt - 4e-3), step_s=4e-3)
    assert found.too_small == StepLimits(pytest.approx(2e-3, rel=0.01), None)
    assert found.too_large == StepLimits(None, pytest.approx(6e-3, rel=0.01))


@pytest.mark.parametrize(
    ("name", "too"),
    [pytest.param(n, t, marks=pytest.mark.engines(n)) for n, t in
     (("dart", "large"), ("pybullet", "large"), ("box2d", "small"), ("rapier", "small"))],
)  # fmt: skip
def test_both_ways_of_being_off_are_found_in_engines(name, too):
    other = {"large": "small", "small": "large"}[too]
    # g·dt/2v more is lost, or gained, in the mean than at 1 ms: 1 % at 5 ms; from 3 ms it is 0.5 %
    assert 3e-3 < getattr(tuned(name), f"too_{too}").above_s < 4e-3
    assert getattr(tuned(name), f"too_{other}") == StepLimits(None, None)


def test_what_runs_away_has_gained_energy(answer):
    def law(v, dt):
        if dt > 3e-3:
            raise SimulationDiverged("it ran away")
        return 0.8

    assert answer(law).gains_above_s == pytest.approx(3e-3, rel=0.01)


def test_what_never_bounces_dies_at_the_fastest_impact(answer):
    found = answer(lambda v, dt: math.nan, DEFAULT)
    assert found.dies_below_m_s == found.over_speed[-1].speed_m_s == 5.0
    assert {one.mean for one in found.over_speed} == {0.0}


def test_slower_impacts_than_can_be_read_are_not_asked(answer):
    found = answer(lambda v, dt: 0.8, step_s=8e-3)
    assert found.over_speed[0].speed_m_s >= 5 * G * 8e-3


def test_another_protocol_than_the_kit_is_refused_with_a_sentence():
    class Plain:
        name = "plain"

        def version(self):
            return "1"

    with pytest.raises(Unsupported, match="plain is not built on simcompare's kit"):
        BounceQuestion(TUNED, STEP_S)(Plain())


def test_an_edge_is_bracketed():
    assert grids.first_edge(lambda x: x < 3, (1, 2, 4, 8)) == pytest.approx(3, rel=0.011)
    assert grids.first_edge(lambda x: x < 9, (1, 2, 4, 8)) is None
    assert grids.first_edge(lambda x: x > 1, (1, 2, 4)) == 1
