"""Turns are counted where an engine knows angles within one turn only; speeds are foreseen."""

import math

import pytest

from simcompare.engine.speeds import fastest_turn_rad_s
from simcompare.engine.turns import Turns
from simcompare.scenarios import catalogue


def within(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


@pytest.mark.parametrize("rate", [400.0, -37.0, 0.01])
@pytest.mark.parametrize("every_s", [0.001, 0.1])
def test_turns_are_counted_however_seldom_one_looks(rate, every_s):
    turns = Turns()
    turns.put("wheel", 2.5, rate)
    for k in range(1, 50):
        turns.passed(every_s)
        angle = 2.5 + rate * k * every_s
        assert turns.angle("wheel", within(angle), rate) == pytest.approx(angle, rel=1e-12)


def test_a_wheel_that_speeds_up_between_two_looks_is_followed():
    # 40 rad in the second: far more than a turn, told by the mean of both rates
    turns = Turns()
    turns.put("wheel", 0.0, 0.0)
    turns.passed(1.0)
    assert turns.angle("wheel", within(40.0), 80.0) == pytest.approx(40.0)


def test_an_angle_that_is_put_keeps_its_turns():
    turns = Turns()
    turns.put("wheel", 1000.0, 0.0)
    turns.passed(5.0)
    assert turns.angle("wheel", within(1000.01), 0.0) == pytest.approx(1000.01)
    turns.put("wheel", -3.0, 0.0)
    assert turns.angle("wheel", within(-3.0), 0.0) == -3.0


def test_an_angle_that_is_no_number_any_more_is_told_as_such():
    turns = Turns()
    turns.put("wheel", 0.0, 1.0)
    turns.passed(1.0)
    assert math.isnan(turns.angle("wheel", math.nan, math.inf))
    assert math.isnan(turns.angle("wheel", 0.0, 1.0))  # and stays so


def test_bodies_are_counted_apart():
    turns = Turns()
    turns.put("one", 0.0, 50.0)
    turns.put("other", 0.0, 0.0)
    turns.passed(1.0)
    assert turns.angle("one", within(50.0), 50.0) == pytest.approx(50.0)
    assert turns.angle("other", 0.1, 0.0) == pytest.approx(0.1)


def test_the_speed_of_a_motor_without_load_is_foreseen():
    scenario = catalogue.load("motor_step").resolve({})
    # k·V/R less dry friction, over back-EMF and viscous friction
    wanted = (0.03 * 12 / 2 - 0.004) / (0.03**2 / 2 + 1e-5)
    assert fastest_turn_rad_s(scenario) == pytest.approx(wanted)
    assert fastest_turn_rad_s(catalogue.load("ball").resolve({})) == 0.0


def test_rates_at_the_start_add_up_along_a_chain():
    rates = {"upper_rate_rad_s": 8, "lower_rate_rad_s": -12}
    scenario = catalogue.load("pendulum_double").resolve(rates)
    assert fastest_turn_rad_s(scenario) == pytest.approx(8 + 20)
