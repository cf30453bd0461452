"""Landing on impacts: bounds, parts and staggered velocity, with an engine made for the test."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare.engine.features import Feature
from simcompare.engine.helps.landing import Approach, approaches
from simcompare.engine.scene import Traits, make_scene
from simcompare.engine.simulation import Simulation
from simcompare.model.scenario import Scenario
from simcompare.model.settings import Settings
from simcompare.scenarios import catalogue

G = 9.80665


class Point(Simulation):
    """Semi-implicit Euler with Newton's restitution, e taken after gravity: a DART in ten lines."""

    def __init__(self, scenario, step_s):
        settings = Settings(helps=None if step_s else frozenset())
        traits = Traits(contact_step_s=step_s or 1.0)
        super().__init__(make_scene("point", traits, frozenset(Feature), scenario, settings))
        body = scenario.bodies["ball"]
        self.z, self.v = body.position_m[2], body.velocity_m_s[2]
        self.h, self.e = scenario.world.step_s, scenario.contacts[0].restitution
        self.r, self.taken = body.shapes[0].radius_m, []

    def take_steps(self, count):
        for _ in range(count):
            self.v -= G * self.h
            if self.z - self.r <= 0 and self.v < 0:
                self.v *= -self.e
            self.z += self.v * self.h
            self.taken.append(self.h)

    def set_engine_step(self, step_s):
        self.h = step_s

    def stored_motion(self, body):
        return (0.0, 0.0, self.z), (0.0, 0.0, self.v)

    def add_velocity(self, body, change_m_s):
        self.v += change_m_s[2]

    def snapshot(self):
        return self.z, self.v

    def take_back(self, snapshot):
        self.z, self.v = snapshot

    def place(self, body, state):
        self.z, self.v = state.position_m[2], state.velocity_m_s[2]

    def row(self):
        return (self.z, self.v)

    def motions(self, rows):
        zero = np.zeros(len(rows))
        return {
            "ball.position_m": np.column_stack((zero, zero, rows[:, 0])),
            "ball.orientation_wxyz": np.tile([1.0, 0, 0, 0], (len(rows), 1)),
            "ball.velocity_m_s": np.column_stack((zero, zero, rows[:, 1])),
            "ball.rate_rad_s": np.zeros((len(rows), 3)),
        }


def scene(**values):
    return catalogue.load("ball").resolve(values)


def test_flight_stays_on_the_exact_parabola_whatever_the_steps():
    scenario = scene(drop_height_m=1.0)
    found = Point(scenario, 2e-6).run("point", "")
    flying = found.time_s < 0.45
    exact = scenario.parameters["radius_m"] + 1.0 - G * found.time_s[flying] ** 2 / 2
    # leapfrog positions are exact; without the staggered start they would be g·dt·t/2 = 2 mm low
    np.testing.assert_allclose(found.signals["ball.position_m"][flying, 2], exact, atol=1e-12)


@pytest.mark.parametrize("e", [0.5, 0.8, 0.95])
def test_bias_of_gravity_in_the_impact_vanishes(e):
    scenario = scene(restitution=e, drop_height_m=0.3)
    landed = Point(scenario, 2e-6).run("point", "")
    plain = Point(scenario, None).run("point", "")
    from simcompare.measures import Request, bounces

    probe = scenario.probes["height_m"]
    errors = [
        abs(bounces.measure(found, Request(probe)).series["restitution"][0] / e - 1)
        for found in (landed, plain)
    ]
    assert errors[0] < 1e-4
    assert errors[1] > 1e-3


def test_partial_steps_are_whole_parts_and_fill_the_recorded_step():
    scenario = scene()
    simulation = Point(scenario, 3e-6)
    parts = math.ceil(0.001 / 3e-6)
    for _ in range(500):  # past the first impact
        simulation.taken.clear()
        simulation.step()
        assert sum(simulation.taken) == pytest.approx(0.001, rel=1e-9)
        for taken in simulation.taken:
            ratio = taken / (0.001 / parts)
            assert ratio == pytest.approx(round(ratio), abs=1e-6)


@given(
    gap=st.floats(1e-6, 2.0),
    speed=st.floats(-5.0, 5.0),
    drag=st.floats(0.0, 0.5),
)
def test_free_time_is_a_lower_bound_of_the_time_to_contact(gap, speed, drag):
    approach = Approach("ball", (0.0, 0.0, 1.0), 0.0, G, drag)
    bound = approach.free_time_s(gap, (0.0, 0.0, speed))
    # march the true motion up to the bound: it must not have touched
    height, velocity, steps = gap, speed, 400
    h = bound / steps
    for _ in range(steps):
        middle = velocity + 0.5 * h * (-G - drag * abs(velocity) * velocity)
        height += h * middle
        velocity += h * (-G - drag * abs(middle) * middle)
    assert height >= -1e-5 * (gap + 1e-3)
    if drag == 0:  # without drag the bound is the very time
        assert height == pytest.approx(0, abs=1e-9 * (1 + gap))


def test_moving_away_without_gravity_is_free_for_ever():
    approach = Approach("ball", (0.0, 0.0, 1.0), 0.0, 0.0, 0.0)
    assert approach.free_time_s(0.1, (0.0, 0.0, 1.0)) == math.inf


def test_pairs_that_cannot_be_landed_on_are_told():
    scenario = scene()
    box = {"type": "box", "size_m": (0.1, 0.1, 0.1)}
    plain = scenario.model_dump()
    plain["bodies"]["ball"]["shapes"] = [box]
    changed = type(scenario).model_validate(plain)
    pairs, notes = approaches(changed)
    assert not pairs
    assert "not landed on" in notes[0]


def test_landing_is_given_up_where_two_moving_bodies_could_meet():
    """The step would change while they touch, which has made one engine gain energy."""
    plain = scene().model_dump()
    plain["bodies"]["other"] = {**plain["bodies"]["ball"], "position_m": (0.0, 0.0, 2.0)}
    pairs, notes = approaches(Scenario.model_validate(plain))
    assert not pairs
    assert "not landed on" in notes[0]


def test_inelastic_pairs_need_no_landing():
    pairs, notes = approaches(scene(restitution=0.0))
    assert not pairs
    assert not notes
