"""The pendulum's motion against elliptic functions, exact decay, energy, and an integration."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import simpson, solve_ivp
from scipy.special import ellipj, ellipk

from simcompare.engine.simulation import sample_times
from simcompare.scenarios import catalogue
from simcompare.scenarios.pendulum import reference as pendulum

FREE = {"damping_N_m_s_rad": 0.0, "friction_N_m": 0.0}
CHANGES = [
    {"damping_N_m_s_rad": 0.0003, "friction_N_m": 0.0},
    {"damping_N_m_s_rad": 0.0, "friction_N_m": 0.0006},
    {"damping_N_m_s_rad": 0.0002, "friction_N_m": 0.001, "start_angle_rad": -2.9},
    {"damping_N_m_s_rad": 0.0, "friction_N_m": 0.03, "start_angle_rad": 2.0},
    {"start_angle_rad": 0.0, "start_rate_rad_s": -24.0},
    {"start_angle_rad": 0.4, "start_rate_rad_s": 3.0, "center_part": 0.96, "length_m": 1.2},
]


def parameters(**changes):
    return dict(catalogue.load("pendulum").resolve(changes).parameters)


def by_integration(p, time_s):
    """DOP853 from turning point to turning point, each a stop of its own."""
    inertia = p["mass_kg"] * p["center_part"] * p["length_m"] ** 2
    pull, damping, friction = (
        p["gravity_m_s2"] / p["length_m"],
        p["damping_N_m_s_rad"] / inertia,
        p["friction_N_m"] / inertia,
    )
    state = np.array([p["start_angle_rad"], p["start_rate_rad_s"]])
    start, found = 0.0, np.zeros((2, len(time_s)))
    while start < time_s[-1]:
        push = -pull * math.sin(state[0])
        if state[1] == 0 and abs(push) <= friction:
            found[0, time_s >= start] = state[0]
            found[1, time_s >= start] = 0
            return found
        sign = math.copysign(1, state[1] or push)

        def turns(t, y, sign=sign, start=start):
            return y[1] * sign if t > start + 1e-6 else 1.0

        turns.terminal, turns.direction = friction > 0, -1
        solved = solve_ivp(
            lambda t, y, sign=sign: (
                y[1],
                -pull * math.sin(y[0]) - damping * y[1] - friction * sign,
            ),
            (start, time_s[-1] + 1e-9), state, "DOP853", events=turns,
            rtol=1e-13, atol=1e-13, max_step=0.01, dense_output=True,
        )  # fmt: skip
        inside = (time_s >= start) & (time_s <= solved.t[-1])
        found[:, inside] = solved.sol(time_s[inside])
        state, start = np.array([solved.y[0, -1], 0.0]), solved.t[-1]
    return found


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_agrees_with_an_independent_integration(changes):
    p = parameters(**changes)
    t = np.linspace(0, 4, 1601)
    angle, rate = pendulum.motion(p, t)
    expected = by_integration(p, t)
    np.testing.assert_allclose(angle, expected[0], atol=1e-9)
    np.testing.assert_allclose(rate, expected[1], atol=1e-8)


@pytest.mark.parametrize(
    ("degrees", "longer"), [(10, 1.0019072), (90, 1.1803406), (170, 2.4393627)]
)
def test_large_swings_take_the_exact_period(degrees, longer):
    p = parameters(start_angle_rad=math.radians(degrees), **FREE)
    modulus = math.sin(math.radians(degrees) / 2) ** 2
    period = 4 * math.sqrt(p["length_m"] / p["gravity_m_s2"]) * ellipk(modulus)
    small = 2 * math.pi * math.sqrt(p["length_m"] / p["gravity_m_s2"])
    assert period / small == pytest.approx(longer, abs=5e-8)
    # after a period it is back, halfway it is on the other side, at a quarter it hangs
    angle, rate = pendulum.motion(p, period * np.array([0.25, 0.5, 1, 2]))
    expected = math.radians(degrees) * np.array([0, -1, 1, 1])
    np.testing.assert_allclose(angle, expected, atol=1e-11)
    assert abs(rate[1:]).max() < 1e-9


def test_a_free_swing_is_jacobis_elliptic_sine():
    p = parameters(start_angle_rad=2.4, **FREE)
    t = np.linspace(0, 10, 3001)
    omega, k = math.sqrt(p["gravity_m_s2"] / p["length_m"]), math.sin(1.2)
    sn, cn, _, _ = ellipj(ellipk(k * k) - omega * t, k * k)
    angle, rate = pendulum.motion(p, t)
    np.testing.assert_allclose(angle, 2 * np.arcsin(k * sn), atol=1e-9)
    np.testing.assert_allclose(rate, -2 * k * omega * cn, atol=1e-8)


def test_dry_friction_takes_the_same_angle_off_every_small_swing():
    # of a spring of constant k = m·g·d a cycle takes 4·F/k
    p = parameters(start_angle_rad=0.01, damping_N_m_s_rad=0.0, friction_N_m=1e-4)
    stiff = p["mass_kg"] * p["gravity_m_s2"] * p["center_part"] * p["length_m"]
    period = 2 * math.pi * math.sqrt(p["length_m"] / p["gravity_m_s2"])
    angle, _ = pendulum.motion(p, period * np.arange(5))
    losses = -np.diff(angle)
    np.testing.assert_allclose(losses, 4 * 1e-4 / stiff, rtol=1e-3)


def test_viscous_friction_takes_the_same_part_off_every_small_swing():
    p = parameters(start_angle_rad=1e-4, damping_N_m_s_rad=0.001, friction_N_m=0.0)
    inertia = pendulum.inertia_kg_m2(p)
    zeta = 0.001 / inertia / 2 / math.sqrt(p["gravity_m_s2"] / p["length_m"])
    omega = math.sqrt(p["gravity_m_s2"] / p["length_m"] * (1 - zeta**2))
    angle, _ = pendulum.motion(p, 2 * math.pi / omega * np.arange(6))
    decrement = 2 * math.pi * zeta / math.sqrt(1 - zeta**2)
    np.testing.assert_allclose(-np.diff(np.log(angle)), decrement, rtol=1e-7)


def test_what_is_missing_of_the_energy_went_into_the_hinge():
    p = parameters(start_angle_rad=2.5, damping_N_m_s_rad=0.0004, friction_N_m=0.001)
    t = np.linspace(0, 3, 30001)
    angle, rate = pendulum.motion(p, t)
    inertia, weight = pendulum.inertia_kg_m2(p), p["mass_kg"] * p["gravity_m_s2"]
    energy = inertia * rate**2 / 2 - weight * p["center_part"] * p["length_m"] * np.cos(angle)
    lost = simpson(p["damping_N_m_s_rad"] * rate**2 + p["friction_N_m"] * np.abs(rate), x=t)
    assert energy[0] - energy[-1] == pytest.approx(lost, rel=1e-7)
    assert np.diff(energy).max() < 1e-15


@given(st.floats(-3.1, 3.1), st.floats(-30, 30))
def test_without_friction_the_energy_stays(angle, rate):
    p = parameters(start_angle_rad=angle, start_rate_rad_s=rate, **FREE)
    angles, rates = pendulum.motion(p, np.linspace(0, 3, 301))
    pull = p["gravity_m_s2"] / p["length_m"]
    energy = rates**2 / 2 - pull * np.cos(angles)
    assert np.ptp(energy) < 1e-12 * (pull + rate**2)


def test_it_stays_where_it_turns_if_friction_holds_it():
    p = parameters(start_angle_rad=1.5, damping_N_m_s_rad=0.0, friction_N_m=0.02)
    angle, rate = pendulum.motion(p, np.linspace(0, 10, 1001))
    pull = p["mass_kg"] * p["gravity_m_s2"] * p["center_part"] * p["length_m"]
    assert np.ptp(angle[-100:]) == 0
    assert not rate[-100:].any()
    assert 0 < pull * abs(math.sin(angle[-1])) <= 0.02


@pytest.mark.parametrize("friction", [0.0, 0.001])
def test_it_hangs_still_if_it_starts_so(friction):
    p = parameters(start_angle_rad=0.0, damping_N_m_s_rad=0.0, friction_N_m=friction)
    angle, rate = pendulum.motion(p, np.linspace(0, 1, 11))
    assert not angle.any()
    assert not rate.any()


def test_mass_matters_only_with_friction():
    t = np.linspace(0, 2, 21)
    light, heavy = (parameters(mass_kg=m, **FREE) for m in (0.1, 10))
    np.testing.assert_array_equal(pendulum.motion(light, t)[0], pendulum.motion(heavy, t)[0])
    light, heavy = (parameters(mass_kg=m) for m in (0.1, 10))
    assert np.abs(pendulum.motion(light, t)[0] - pendulum.motion(heavy, t)[0]).max() > 0.1


def test_the_scene_has_the_equivalent_length_that_its_parameter_says():
    scenario = catalogue.load("pendulum").resolve({"center_part": 0.6, "start_angle_rad": 1.1})
    bob = scenario.bodies["bob"]
    distance = math.hypot(bob.position_m[0], bob.position_m[2])
    about_hinge = bob.inertia_kg_m2[1] + bob.mass_kg * distance**2
    length = scenario.parameters["length_m"]
    assert about_hinge / (bob.mass_kg * distance) == pytest.approx(length, rel=1e-12)
    assert about_hinge == pytest.approx(pendulum.inertia_kg_m2(scenario.parameters), rel=1e-12)
    assert bob.position_m[0] > 0, "a positive angle leans towards +x"


def test_observes_what_the_probes_see_from_the_start_on():
    scenario = catalogue.load("pendulum").resolve({"start_angle_rad": 0.7, "start_rate_rad_s": 2})
    found = pendulum.reference(scenario.parameters, sample_times(scenario))
    assert {probe.observe for probe in scenario.probes.values()} <= set(found)
    assert found["hinge.angle_rad"][0] == 0
    assert found["hinge.rate_rad_s"][0] == 2
