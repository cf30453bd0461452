"""The ball's closed form against an independent integration, published numbers and itself."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from simcompare.measures import Request, bounces
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.ball import reference as ball

DEFAULTS = {
    "drop_height_m": 1.0,
    "restitution": 0.8,
    "radius_m": 0.02,
    "mass_kg": 0.0027,
    "drag_coefficient": 0.0,
    "air_density_kg_m3": 1.2,
    "gravity_m_s2": 9.80665,
}
DRAG = {"drag_coefficient": 0.47}


def integrated(parameters, until_s):
    """Height and velocity by DOP853 with located impacts; knows nothing of the closed form."""
    gravity, e = parameters["gravity_m_s2"], parameters["restitution"]
    area = math.pi * parameters["radius_m"] ** 2
    drag = 0.5 * parameters["air_density_kg_m3"] * parameters["drag_coefficient"] * area
    per_mass = drag / parameters["mass_kg"]

    def motion(_, y):
        return [y[1], -gravity - per_mass * abs(y[1]) * y[1]]

    def floor(_, y):
        return y[0]

    floor.terminal, floor.direction = True, -1
    t, state, impacts, pieces = 0.0, [parameters["drop_height_m"], 0.0], [], []
    while t < until_s and len(impacts) < 8:
        found = solve_ivp(
            motion, (t, until_s), state, "DOP853", events=floor, rtol=1e-13, atol=1e-15,
            dense_output=True, max_step=0.02,
        )  # fmt: skip
        pieces.append((t, found.t[-1], found.sol))
        t = found.t[-1]
        if found.t_events[0].size:
            t = float(found.t_events[0][0])
            impacts.append(t)
            # started a hair above the floor so that the next impact is not this one
            state = [1e-16, -e * float(found.y_events[0][0][1])]
    return impacts, pieces


@pytest.mark.parametrize(
    "changes",
    [
        {},
        DRAG,
        {"restitution": 0.5, **DRAG},
        {"restitution": 0.95, "drop_height_m": 0.1},
        {"drop_height_m": 2.0, "drag_coefficient": 1.0, "restitution": 0.7},
        {"gravity_m_s2": 1.62, "drop_height_m": 0.5},
    ],
    ids=str,
)
def test_agrees_with_an_independent_integration(changes):
    parameters = {**DEFAULTS, **changes}
    impacts, pieces = integrated(parameters, until_s=3.0)
    flights = ball.flights(parameters, 3.0)
    ours = [flight.end_s for flight in flights][: len(impacts)]
    # 1e-9 is far below any measurement; DOP853 at 1e-13 leaves room for it
    np.testing.assert_allclose(ours, impacts, atol=1e-9)
    for start, end, solution in pieces:
        # inside the flight, a microsecond off its ends where velocity jumps
        t = np.linspace(start + 1e-6, end - 1e-6, 50)
        found = ball.reference(parameters, t)
        height = found["ball.position_m"][:, 2] - parameters["radius_m"]
        np.testing.assert_allclose(height, solution(t)[0], atol=1e-9)
        np.testing.assert_allclose(found["ball.velocity_m_s"][:, 2], solution(t)[1], atol=2e-9)


def test_published_numbers_in_vacuum():
    # e = 0.8 from 1 m: t0·(1 + 2e(1 - e^k)/(1 - e)), to a microsecond
    ends = [flight.end_s for flight in ball.flights(DEFAULTS, 2.9)][:6]
    expected = [0.451601, 1.174162, 1.752211, 2.214650, 2.584601, 2.880563]
    np.testing.assert_allclose(ends, expected, atol=6e-7)


def test_published_numbers_with_drag():
    # table-tennis ball: v_t = 8.644 m/s, first impact at 0.46154 s, rebound 0.5250 m
    parameters = {**DEFAULTS, **DRAG}
    first, second = ball.flights(parameters, 1.0)[:2]
    assert ball.terminal_speed(parameters) == pytest.approx(8.644, abs=5e-4)
    assert first.end_s == pytest.approx(0.46154, abs=5e-6)
    assert second.apex_m == pytest.approx(0.5250, abs=5e-5)


def test_comes_to_rest_when_the_geometric_series_ends():
    e, fall = 0.8, math.sqrt(2 / 9.80665)
    rest = fall * (1 + e) / (1 - e)
    assert ball.flights(DEFAULTS, 100.0)[-1].end_s == pytest.approx(rest, rel=1e-6)
    after = ball.reference(DEFAULTS, np.array([0.0, rest + 0.1]))
    assert after["ball.position_m"][1, 2] == DEFAULTS["radius_m"]


def test_does_not_bounce_without_restitution():
    assert len(ball.flights({**DEFAULTS, "restitution": 0.0}, 10.0)) == 1


@given(
    e=st.floats(0.3, 0.97),
    height=st.floats(0.05, 5.0),
    drag=st.sampled_from([0.0, 0.2, 0.47, 1.0]),
)
def test_energy_never_grows_and_height_is_continuous(e, height, drag):
    parameters = {
        **DEFAULTS, "restitution": e, "drop_height_m": height, "drag_coefficient": drag,
    }  # fmt: skip
    t = np.linspace(0, 2.0, 4001)
    found = ball.reference(parameters, t)
    z = found["ball.position_m"][:, 2] - parameters["radius_m"]
    v = found["ball.velocity_m_s"][:, 2]
    energy = parameters["gravity_m_s2"] * z + v**2 / 2
    assert np.all(np.diff(energy) <= 1e-9 * energy[0])
    assert z.min() >= -1e-12
    fastest = math.sqrt(2 * parameters["gravity_m_s2"] * height)
    assert np.abs(np.diff(z)).max() <= fastest * (t[1] - t[0]) * (1 + 1e-9)


@given(scale=st.floats(0.1, 10.0))
def test_vacuum_scales_as_dimensions_say(scale):
    # heights k times as large, times √k times as long
    small = ball.flights(DEFAULTS, 3.0)
    large = ball.flights({**DEFAULTS, "drop_height_m": scale}, 3.0 * math.sqrt(scale))
    for a, b in zip(small[:8], large[:8], strict=True):
        assert b.end_s == pytest.approx(a.end_s * math.sqrt(scale), rel=1e-12)
        assert b.apex_m == pytest.approx(a.apex_m * scale, rel=1e-12)


@pytest.mark.parametrize("step_s", [0.00025, 0.001, 0.004])
@pytest.mark.parametrize("e", [0.5, 0.8, 0.95])
def test_the_measure_finds_in_the_closed_form_what_was_put_in(e, step_s):
    scenario = catalogue.load("ball").resolve({"restitution": e}, step_s=step_s)
    t = np.arange(round(scenario.world.duration_s / step_s)) * step_s
    truth = Trajectory("closed form", t, ball.reference(scenario.parameters, t))
    found = bounces.measure(truth, Request(scenario.probes["height_m"]))
    expected = [flight.end_s for flight in ball.flights(scenario.parameters, t[-1])]
    count = len(found.series["impact_time"])
    assert count >= 4
    # positions on parabolas: the fit is exact up to rounding
    np.testing.assert_allclose(found.series["restitution"], e, rtol=1e-9)
    np.testing.assert_allclose(found.series["impact_time"], expected[:count], atol=1e-10)
    assert found.values["energy_gain"] == 0
    assert found.values["penetration"] == 0
