"""Closed forms of bounces against the ball's reference and independent integrations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare.errors import UnknownName
from simcompare.fitting.bounces import bounce_models, hunt_crossley
from simcompare.fitting.bounces.bounce_models import MODELS, bounces
from simcompare.fitting.bounces.hunt_crossley import REFERENCE_SPEED
from simcompare.scenarios.ball import reference

BALL = {
    "drop_height_m": 1.0, "restitution": 0.85, "radius_m": 0.02, "mass_kg": 0.0027,
    "drag_coefficient": 0.0, "air_density_kg_m3": 1.2, "gravity_m_s2": 9.80665,
}  # fmt: skip


def of_scenario(parameters, count):
    """Impact times, apex times and heights of the scenario's own closed form."""
    found = reference.flights(parameters, 30.0)[: count + 1]
    ends = [flight.end_s for flight in found]
    return ends[:count], [f.apex_s for f in found], [f.apex_m for f in found]


@pytest.mark.parametrize("drag", [0.0, 0.47, 2.0])
@pytest.mark.parametrize("height", [0.05, 1.0, 10.0])
def test_the_constant_law_is_the_closed_form_of_the_scenario(drag, height):
    parameters = {**BALL, "drag_coefficient": drag, "drop_height_m": height}
    values = {
        "restitution": 0.85, "drop_height_m": height,
        "terminal_speed_m_s": reference.terminal_speed(parameters),
    }  # fmt: skip
    found = bounces(MODELS["constant+drag"], values, 8)
    times, apex_s, apex_m = of_scenario(parameters, 8)
    assert found.impact_s == pytest.approx(times, abs=1e-10)
    assert found.apex_s == pytest.approx(apex_s, abs=1e-10)
    assert found.apex_m == pytest.approx(apex_m, rel=1e-12)


def integrated(values, law, count):
    """Impact times by DOP853 with located impacts and any law e(v)."""
    gravity, k = 9.80665, values["drag_k"]

    def motion(_, y):
        return [y[1], -gravity - gravity * k * abs(y[1]) * y[1]]

    def floor(_, y):
        return y[0]

    floor.terminal, floor.direction = True, -1
    t, state, times = 0.0, [values["drop_height_m"], 0.0], []
    while len(times) < count:
        found = solve_ivp(motion, (t, t + 5), state, "DOP853", events=floor, rtol=1e-13, atol=1e-15,
                          max_step=0.05)  # fmt: skip
        t = float(found.t_events[0][0])
        times.append(t)
        speed = -float(found.y_events[0][0][1])
        state = [1e-16, law(speed) * speed]
    return times


def test_a_power_law_with_drag_is_what_an_integration_gives():
    values = {"restitution": 0.82, "exponent": 0.1, "drag_k": 1 / 8.6**2, "drop_height_m": 1.3}
    found = bounces(MODELS["power+drag"], values, 6)
    times = integrated(values, lambda v: 0.82 * (v / REFERENCE_SPEED) ** -0.1, 6)
    assert found.impact_s == pytest.approx(times, abs=1e-9)


def test_hunt_and_crossley_with_drag_is_what_an_integration_gives():
    values = {"restitution": 0.8, "drag_k": 1 / 30**2, "drop_height_m": 0.8}
    found = bounces(MODELS["hunt_crossley+drag"], values, 5)
    chi = float(hunt_crossley.dissipation(np.array(0.8)))
    law = lambda v: float(hunt_crossley.restitution(np.array(chi * v)))  # noqa: E731
    assert found.impact_s == pytest.approx(integrated(values, law, 5), abs=1e-9)


@pytest.mark.parametrize("power", [1.0, 1.5])
@pytest.mark.parametrize("y", [0.05, 0.37, 1.43, 6.0])
def test_the_effective_restitution_is_that_of_the_contact_force(power, y):
    """m·x'' = -K·xⁿ·(1 + χ·x') with m = K = χ = 1 and speed y, integrated through the contact."""

    def motion(_, s):
        return [s[1], -(max(s[0], 0.0) ** power) * (1 + s[1])]

    def leaves(_, s):
        return s[0]

    leaves.terminal, leaves.direction = True, -1
    found = solve_ivp(motion, (0, 1e4), [1e-14, y], "DOP853", events=leaves, rtol=1e-12, atol=1e-14)
    e = -float(found.y_events[0][0][1]) / y
    assert float(hunt_crossley.restitution(np.array(y))) == pytest.approx(e, abs=1e-8)


@pytest.mark.parametrize(("e", "y"), [(0.9, 0.166482), (0.8, 0.373146), (0.5, 1.432751)])
def test_tabulated_values_of_hunt_and_crossley_come_out(e, y):
    assert float(hunt_crossley.restitution(np.array(y))) == pytest.approx(e, abs=1e-6)
    assert float(hunt_crossley.dissipation(np.array(e))) * REFERENCE_SPEED == pytest.approx(
        y, rel=1e-5
    )


def test_hunt_and_crossley_holds_its_relation_from_crawling_to_sticking():
    y = 10.0 ** np.linspace(-6, 1, 400)
    e = hunt_crossley.restitution(y)
    assert np.all(np.diff(e) < 0)
    small = y < 0.01
    assert e[small] == pytest.approx(1 - 2 * y[small] / 3 + 4 * y[small] ** 2 / 9, abs=2e-6)
    # ln((1 + y)/(1 - y·e)) = y·(1 + e), in the form that does not lose digits where y·e nears 1
    rest = (1 + y) * np.exp(-y * (1 + e)) - (1 - y * e)
    assert np.abs(rest[~small]).max() < 1e-12
    assert float(hunt_crossley.restitution(np.array(200.0))) == pytest.approx(1 / 200)
    assert float(hunt_crossley.restitution(np.array(0.0))) == 1.0


def test_height_follows_the_reference_along_every_flight():
    parameters = {**BALL, "drag_coefficient": 0.47}
    times = np.linspace(0, 2.5, 500)
    truth = reference.reference(parameters, times)["ball.position_m"][:, 2] - BALL["radius_m"]
    values = {
        "restitution": 0.85, "drop_height_m": 1.0, "floor_m": 0.1, "release_time_s": 2.0,
        "terminal_speed_m_s": reference.terminal_speed(parameters),
    }  # fmt: skip
    found = bounces(MODELS["constant"], values, 6)
    flight = np.searchsorted(found.impact_s, times + 2.0)
    height = bounce_models.height_at(found, values, times + 2.0, flight)
    assert height == pytest.approx(truth + 0.1, abs=1e-12)


def test_vacuum_is_reached_smoothly_from_both_sides():
    k = np.array([-1e-6, -1e-9, 0.0, 1e-9, 1e-6])
    found = bounces(MODELS["constant+drag"], {"drag_k": k, "restitution": 0.85}, 5).impact_s
    slope = np.diff(found, axis=0) / np.diff(k)[:, None]
    assert np.all(np.ptp(slope, axis=0) < 1e-4 * np.abs(slope).max(axis=0))


def test_many_parameter_sets_are_those_taken_one_by_one():
    e, h = np.array([0.7, 0.8, 0.9]), np.array([0.5, 1.0, 1.5])
    for name in MODELS:
        values = {"restitution": e, "drop_height_m": h, "exponent": 0.05, "drag_k": 0.01}
        whole = bounces(MODELS[name], values, 5)
        for k in range(3):
            one = bounces(MODELS[name], {**values, "restitution": e[k], "drop_height_m": h[k]}, 5)
            assert whole.impact_s[k] == pytest.approx(one.impact_s, abs=1e-14)
            assert whole.apex_m[k] == pytest.approx(one.apex_m, abs=1e-14)


def test_a_clock_shifts_and_stretches_impact_times_alone():
    plain = bounces(MODELS["constant"], {}, 4)
    moved = bounces(MODELS["constant"], {"release_time_s": 3.0, "clock_skew": 1e-4}, 4)
    assert moved.impact_s == pytest.approx(3 + 1.0001 * plain.impact_s, abs=1e-14)
    assert moved.apex_s == pytest.approx(plain.apex_s)


def test_restitution_at_a_speed_is_that_of_the_impacts():
    for name, model in MODELS.items():
        values = {"restitution": 0.8, "exponent": 0.08, "drag_k": 0.013}
        found = bounces(model, values, 4)
        law = bounce_models.restitution_at(model, values, found.speed_m_s)
        assert law == pytest.approx(found.restitution, abs=1e-13), name
        at_reference = bounce_models.restitution_at(model, values, np.array([REFERENCE_SPEED]))
        assert at_reference == pytest.approx([0.8], abs=1e-12)


def test_no_law_lets_a_slow_ball_gain_energy():
    found = bounces(MODELS["power"], {"restitution": 0.95, "exponent": 0.3}, 40)
    assert found.restitution.max() <= 1.0


def test_an_unknown_model_names_those_that_exist():
    with pytest.raises(UnknownName, match=r"did you mean.*power"):
        bounce_models.model_of("powr")
