"""The sliding block: its closed form against an integration, and where it stays."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare.scenarios import catalogue
from simcompare.scenarios.sliding_block import reference as block

FILE = catalogue.load("sliding_block")


def parameters(preset=None, **changes):
    return dict(FILE.resolve(changes, preset=preset).parameters)


def integrated(p, time_s):
    g, angle, mu = p["gravity_m_s2"], p["incline_rad"], p["friction"]
    state, now = np.array([p["start_position_m"], p["start_speed_m_s"]]), 0.0
    position, speed = np.zeros(len(time_s)), np.zeros(len(time_s))
    while now < time_s[-1]:
        way = math.copysign(1.0, state[1]) if state[1] else 1.0
        if state[1] == 0 and math.tan(angle) <= mu:
            here = time_s >= now
            position[here], speed[here] = state[0], 0.0
            break

        def motion(_t, y, way=way):
            return [y[1], g * (math.sin(angle) - mu * math.cos(angle) * way)]

        def stops(t, y, way=way, now=now):
            return 1.0 if t <= now + 1e-9 else y[1] * way

        stops.terminal, stops.direction = True, -1
        solved = solve_ivp(motion, (now, time_s[-1]), state, "DOP853", dense_output=True,
                           rtol=1e-13, atol=1e-13, events=stops)  # fmt: skip
        here = (time_s >= now) & (time_s <= solved.t[-1])
        position[here], speed[here] = solved.sol(time_s[here])
        now, state = solved.t[-1], solved.y[:, -1].copy()
        if solved.status == 1:
            state[1] = 0.0
    return position, speed


@pytest.mark.parametrize("preset", [None, "incline", "up_and_back", "held"])
def test_agrees_with_an_integration(preset):
    p = parameters(preset, start_position_m=0.2)
    time_s = np.linspace(0, 0.8, 401)
    found = block.reference(p, time_s)
    position, speed = integrated(p, time_s)
    np.testing.assert_allclose(found["block.position_m"][:, 0], position, atol=1e-9)
    np.testing.assert_allclose(found["block.velocity_m_s"][:, 0], speed, atol=1e-9)


def test_it_stops_where_the_energy_says():
    p = parameters()
    end = block.motion(p, np.array([10.0]))
    way = p["start_speed_m_s"] ** 2 / (2 * p["friction"] * p["gravity_m_s2"])
    assert end[0][0] == pytest.approx(way, rel=1e-12)
    assert way == pytest.approx(0.38239, abs=1e-5)
    assert end[1][0] == 0


def test_the_way_back_is_slower_than_the_way_up_by_the_friction():
    p = parameters("up_and_back")
    time_s = np.linspace(0, 0.8, 801)
    speed = block.motion(p, time_s)[1]
    rise = np.diff(speed) / np.diff(time_s)
    up, back = rise[10], rise[-10]
    half = (up - back) / 2
    assert half == pytest.approx(p["friction"] * 9.80665 * math.cos(p["incline_rad"]), rel=1e-9)
    assert (up + back) / 2 == pytest.approx(9.80665 * math.sin(p["incline_rad"]), rel=1e-9)


def test_without_friction_it_goes_on():
    moved, speed = block.motion(parameters(friction=0.0), np.array([2.0]))
    assert (moved[0], speed[0]) == (3.0, 1.5)


@pytest.mark.parametrize(
    ("changes", "tips"),
    [({"friction": 1.0, "height_m": 0.11}, False), ({"friction": 1.0, "height_m": 0.13}, True),
     # held by an incline that asks for less than friction could give
     ({"friction": 1.0, "height_m": 0.13, "incline_rad": 0.5, "start_speed_m_s": 0.0}, False),
     ({"friction": 1.0, "height_m": 0.25, "incline_rad": 0.5, "start_speed_m_s": 0.0}, True)],
)  # fmt: skip
def test_a_block_tips_where_friction_acts_too_far_below_its_centre(changes, tips):
    scene = catalogue.load("sliding_block").resolve(changes)
    assert any("tips over" in sentence for sentence in scene.beyond) == tips
