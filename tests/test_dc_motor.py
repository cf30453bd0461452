"""The motor's curves against published numbers, a brute search, and an independent integration."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from simcompare.hardware.motors import dc_motor
from simcompare.hardware.motors.dc_motor import Housing, Motor

#: a small 6 V motor: without viscous friction, and with it
IDEAL = Motor(resistance_Ohm=6.0, torque_constant_N_m_A=5.5e-3, friction_N_m=4e-4)
VISCOUS = Motor(6.0, 5.5e-3, 4e-4, 2e-7)
HOUSING = Housing(resistance_K_W=30.0, capacity_J_K=8.0)
V = 6.0

motors = st.builds(
    Motor,
    st.floats(0.1, 100), st.floats(1e-3, 1), st.floats(1e-7, 1e-5), st.floats(0, 1e-6),
)  # fmt: skip


def test_numbers_of_the_small_motor():
    assert IDEAL.current_at(V, 0.0) == pytest.approx(72.7e-3, abs=5e-5)
    assert IDEAL.stall_current(V) == 1.0
    assert IDEAL.speed_at(V, 0.0) == pytest.approx(1011.6, abs=0.05)
    assert IDEAL.maximum_efficiency(V) == pytest.approx(0.5334, abs=5e-5)
    assert IDEAL.maximum_power(V) == pytest.approx(1.28975, abs=5e-6)
    torque = IDEAL.starting_torque(V) - IDEAL.slope * IDEAL.most_efficient_speed(V)
    assert IDEAL.current_at(V, torque) == pytest.approx(0.2697, abs=5e-5)


def test_closed_forms_hold_without_viscous_friction():
    none, stall = IDEAL.current_at(V, 0.0), IDEAL.stall_current(V)
    assert IDEAL.maximum_efficiency(V) == pytest.approx((1 - math.sqrt(none / stall)) ** 2)
    power = (V - 6.0 * none) ** 2 / (4 * 6.0)
    assert IDEAL.maximum_power(V) == pytest.approx(power)
    # the largest power is at the mean of the two currents
    assert IDEAL.current_at(V, IDEAL.starting_torque(V) / 2) == pytest.approx((none + stall) / 2)


@given(motors, st.floats(0.01, 0.99))
def test_voltages_and_torques_balance(motor, part):
    torque = part * motor.starting_torque(V)
    speed, current = motor.speed_at(V, torque), motor.current_at(V, torque)
    k, friction = motor.torque_constant_N_m_A, motor.damping_N_m_s_rad * speed + motor.friction_N_m
    assert motor.resistance_Ohm * current + k * speed == pytest.approx(V, rel=1e-9)
    assert k * current == pytest.approx(torque + friction, rel=1e-6, abs=1e-9)


@given(motors)
def test_maximum_efficiency_is_what_a_search_finds(motor):
    found = minimize_scalar(
        lambda part: -motor.efficiency_at(V, part * motor.starting_torque(V)),
        bounds=(1e-9, 1 - 1e-9), method="bounded", options={"xatol": 1e-10},
    )  # fmt: skip
    assert motor.maximum_efficiency(V) == pytest.approx(-found.fun, rel=1e-6)
    best = motor.starting_torque(V) - motor.slope * motor.most_efficient_speed(V)
    assert motor.efficiency_at(V, best) == pytest.approx(-found.fun, rel=1e-6)


def test_a_motor_without_friction_wastes_nothing_when_it_gives_nothing():
    assert Motor(1.0, 0.73).maximum_efficiency(V) == pytest.approx(1.0, abs=1e-12)


def test_viscous_friction_costs_efficiency_so_the_simple_form_is_wrong():
    none, stall = VISCOUS.current_at(V, 0.0), VISCOUS.stall_current(V)
    simple = (1 - math.sqrt(none / stall)) ** 2
    assert VISCOUS.maximum_efficiency(V) < IDEAL.maximum_efficiency(V)
    # the simple form, from the idle current that is measured, is too small by more than 1 %
    assert VISCOUS.maximum_efficiency(V) > 1.01 * simple


@given(st.floats(0, 5), st.floats(0, 1000), st.integers(1, 50))
def test_warming_by_exact_steps_does_not_depend_on_their_number(loss, duration, parts):
    temperature = HOUSING.ambient_K
    for _ in range(parts):
        temperature = HOUSING.after(temperature, loss, duration / parts)
    time_constant = 30.0 * 8.0
    rise = loss * 30.0 * -math.expm1(-duration / time_constant)
    assert temperature - HOUSING.ambient_K == pytest.approx(rise, rel=1e-9, abs=1e-9)


def test_warming_along_a_record_follows_a_loss_that_changes():
    t = np.linspace(0, 300, 3001)
    loss = 1 + 0.5 * np.sin(t / 40)
    independent = solve_ivp(
        lambda s, y: [(1 + 0.5 * math.sin(s / 40) - (y[0] - 293.15) / 30) / 8],
        (0, 300), [293.15], "DOP853", t_eval=t, rtol=1e-12, atol=1e-12,
    )  # fmt: skip
    np.testing.assert_allclose(HOUSING.along(loss, t), independent.y[0], atol=1e-6)


def test_a_constant_current_has_a_steady_temperature_or_runs_away():
    # I²·R·α·R_th = 1 at 1.189 A
    limit = math.sqrt(1 / (6.0 * dc_motor.COPPER_PER_K * 30.0))
    assert dc_motor.steady_temperature(IDEAL, HOUSING, limit) is None
    current = 0.5
    end = dc_motor.steady_temperature(IDEAL, HOUSING, current)
    assert end is not None
    # what is made equals what leaves
    made = current**2 * IDEAL.at_temperature(end).resistance_Ohm
    assert made == pytest.approx((end - HOUSING.ambient_K) / 30.0, rel=1e-12)
    near = dc_motor.steady_temperature(IDEAL, HOUSING, 0.999 * limit)
    assert near is not None
    assert near > 10_000


def test_a_loaded_motor_at_constant_voltage_settles_where_its_heat_leaves():
    t = np.array([0.0, 5.0, 240.0, 5000.0])
    warm = dc_motor.warming(IDEAL, HOUSING, V, 1.5e-3, t)
    assert warm[0] == HOUSING.ambient_K
    # at first as at constant loss
    loss = dc_motor.loss_at(IDEAL, V, 1.5e-3)
    cold = HOUSING.after(HOUSING.ambient_K, loss, 5.0)
    assert warm[1] - 293.15 == pytest.approx(cold - 293.15, rel=0.01)
    end = float(warm[-1])
    leaves = (end - HOUSING.ambient_K) / HOUSING.resistance_K_W
    assert dc_motor.loss_at(IDEAL.at_temperature(end), V, 1.5e-3) == pytest.approx(leaves, rel=1e-6)
    # the weaker magnet takes more current for the same torque: hotter than constants would say
    assert end > HOUSING.ambient_K + loss * HOUSING.resistance_K_W


def test_warming_agrees_with_small_exact_steps():
    t = np.linspace(0, 400, 20001)
    warm = dc_motor.warming(VISCOUS, HOUSING, V, 2e-3, t)
    temperature = HOUSING.ambient_K
    for i in range(len(t) - 1):
        middle = (warm[i] + warm[i + 1]) / 2  # as good as the step is short
        loss = dc_motor.loss_at(VISCOUS.at_temperature(middle), V, 2e-3)
        temperature = HOUSING.after(temperature, loss, t[i + 1] - t[i])
    assert temperature == pytest.approx(warm[-1], abs=1e-5)


def test_a_motor_that_weakens_below_its_load_stalls():
    torque = 0.98 * IDEAL.starting_torque(V)
    hot = IDEAL.at_temperature(373.15)
    assert torque > hot.starting_torque(V)
    assert dc_motor.loss_at(hot, V, torque) == pytest.approx(V * V / hot.resistance_Ohm)
    assert hot.resistance_Ohm == pytest.approx(6.0 * (1 + 3.93e-3 * 80))
    assert hot.torque_constant_N_m_A == pytest.approx(5.5e-3 * (1 - 2e-3 * 80))
