"""The motor that is switched on: its closed form against an integration, also where it stops."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from simcompare.errors import InputError
from simcompare.model.signals import Constant, Ramp, Sine, Step, Table
from simcompare.scenarios import catalogue
from simcompare.scenarios.motor_step import reference as step

NOMINAL = dict(catalogue.load("motor_step").resolve().parameters)


def integrated(parameters, time_s, supply, bends):
    """DOP853 from corner to corner, stopped and judged anew wherever the rate is 0."""
    p = parameters
    k, r = p["torque_constant_N_m_A"], p["resistance_Ohm"]
    friction = p["friction_N_m"]

    def torque(t, rate, way):
        drive = k * (float(supply.at(np.array([t]))[0]) - k * rate) / r
        return drive - way * friction - p["damping_N_m_s_rad"] * rate

    angle, rate = np.zeros(len(time_s)), np.zeros(len(time_s))
    state, now = np.array([0.0, p["start_rate_rad_s"]]), 0.0
    edges = [*[b for b in bends if 0 < b < time_s[-1]], time_s[-1]]
    for edge in edges:
        inside = edge - 1e-12  # a jump at the edge belongs to what follows
        while now < inside:
            way = math.copysign(1.0, state[1]) if state[1] else 0.0
            if not way:
                pull = torque(now + 1e-12, 0.0, 0.0)
                if abs(pull) <= friction:
                    leaves = now
                    while leaves < inside and abs(torque(leaves + 1e-12, 0.0, 0.0)) <= friction:
                        leaves += 1e-5
                    here = (time_s >= now) & (time_s <= leaves)
                    angle[here], rate[here] = state[0], 0.0
                    now = min(leaves, inside)
                    state[1] = 0.0
                    continue
                way = math.copysign(1.0, pull)

            def motion(t, y, way=way, inside=inside):
                return [y[1], torque(min(t, inside), y[1], way) / p["inertia_kg_m2"]]

            def stops(t, y, way=way, now=now):
                return 1.0 if t <= now + 1e-9 else y[1] * way

            stops.terminal, stops.direction = True, -1
            solved = solve_ivp(motion, (now, inside), state, "DOP853", dense_output=True,
                               rtol=1e-13, atol=1e-13, max_step=0.01, events=stops)  # fmt: skip
            here = (time_s >= now) & (time_s <= solved.t[-1] + 1e-12)
            angle[here], rate[here] = solved.sol(time_s[here])
            now = solved.t[-1]
            state = solved.y[:, -1].copy()
            if solved.status == 1:
                state[1] = 0.0
        now = edge
    return angle, rate


CASES = {
    "step": ({}, Step(signal="step", before=12, after=6, time_s=1.2), [1.2]),
    "reversed": ({}, Step(signal="step", before=12, after=-5, time_s=0.7), [0.7]),
    "stops": ({}, Step(signal="step", before=12, after=0.1, time_s=0.5), [0.5]),
    "held": ({"friction_N_m": 0.2}, Constant(signal="constant", value=12), []),
    "spinning": ({"start_rate_rad_s": -50.0}, Constant(signal="constant", value=5), []),
    "table": (
        {},
        Table(signal="table", time_s=(0, 0.3, 0.4, 0.9, 1.5), value=(0, 10, 9, -3, 4)),
        [0.3, 0.4, 0.9, 1.5],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_agrees_with_an_integration(name):
    changes, supply, bends = CASES[name]
    parameters = {**NOMINAL, **changes}
    time_s = np.linspace(0, 2.4, 481)
    found = step.reference(parameters, time_s, {"supply": supply})
    angle, rate = integrated(parameters, time_s, supply, bends)
    size = max(1.0, float(np.max(np.abs(rate))))
    # where it leaves its rest the integration knows the instant to 10 µs only
    rough = 1e-6 if name in ("table", "reversed") else 1e-9
    np.testing.assert_allclose(found["shaft.rate_rad_s"], rate, atol=rough * size)
    np.testing.assert_allclose(found["shaft.angle_rad"], angle, atol=rough * size)


def test_voltage_is_what_current_and_back_emf_make():
    supply = Step(signal="step", before=12, after=6, time_s=1.2)
    found = step.reference(NOMINAL, np.linspace(0, 2.4, 100), {"supply": supply})
    emf = NOMINAL["torque_constant_N_m_A"] * found["shaft.rate_rad_s"]
    drop = NOMINAL["resistance_Ohm"] * found["motor.current_A"]
    np.testing.assert_allclose(found["motor.voltage_V"], drop + emf, rtol=1e-12)
    assert found["motor.current_A"][0] == 6.0


def test_idle_speeds_and_time_constant_are_those_of_the_table():
    p = NOMINAL
    fall = p["torque_constant_N_m_A"] ** 2 / p["resistance_Ohm"] + p["damping_N_m_s_rad"]
    assert p["inertia_kg_m2"] / fall == pytest.approx(0.217, abs=5e-4)
    late = np.array([0.0, 50.0])
    for voltage, idle in ((12.0, 382.6), (6.0, 187.0)):
        given = {"supply": Constant(signal="constant", value=voltage)}
        rate = step.reference(p, late, given)["shaft.rate_rad_s"][-1]
        assert rate == pytest.approx(idle, abs=0.1)


def test_it_stays_while_friction_holds_it_and_leaves_when_the_ramp_exceeds_it():
    given = {"supply": Ramp(signal="ramp", start=0, end=1, start_s=0, end_s=1)}
    time_s = np.linspace(0, 1, 1001)
    rate = step.reference(NOMINAL, time_s, given)["shaft.rate_rad_s"]
    # k·V/R = τ_c at V = 0.2667 V
    leaves = NOMINAL["friction_N_m"] * NOMINAL["resistance_Ohm"] / NOMINAL["torque_constant_N_m_A"]
    assert np.all(rate[time_s < leaves] == 0)
    assert np.all(rate[time_s > leaves + 0.001] > 0)


def test_a_voltage_without_a_closed_form_is_refused():
    given = {"supply": Sine(signal="sine", amplitude=1, frequency_Hz=1)}
    with pytest.raises(InputError, match="must be constant"):
        step.reference(NOMINAL, np.linspace(0, 1, 10), given)
