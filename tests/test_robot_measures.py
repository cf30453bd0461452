"""Measures of driving, on motions that are known by construction, right ones and wrong ones."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simcompare.measures import (
    Request,
    acceleration,
    energy_balance,
    heading,
    motor_energy,
    rise,
    side_by_side,
    slip,
)
from simcompare.model.rotations import multiply, quaternions_of
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory

STEP_S = 0.001


def times(end_s=1.0, step_s=STEP_S):
    return np.arange(round(end_s / step_s) + 1) * step_s


def made(t, **signals):
    """A trajectory of scalars by name."""
    return Trajectory("made", t, {f"made.{name}": values for name, values in signals.items()})


def probe(name, component=None):
    return Probe(observe=f"made.{name}", component=component, label=name, unit="1")


def request(first, *also, **options):
    return Request(probe(first), {name: probe(name) for name in also}, options)


# --- acceleration ---------------------------------------------------------------------------------


def accelerated(t, position, **window):
    window = {"start_s": 0.1, "end_s": 1.0, **window}
    found = acceleration.measure(made(t, x=position), request("x", **window))
    return found.values["acceleration"]


@given(
    a=st.floats(-20, 20), v=st.floats(-5, 5), x=st.floats(-100, 100),
    step_s=st.sampled_from([0.0005, 0.001, 0.01]),
)  # fmt: skip
def test_acceleration_of_a_parabola_is_found_from_any_start(a, v, x, step_s):
    t = times(step_s=step_s)
    assert accelerated(t, x + v * t + a * t**2 / 2) == pytest.approx(a, abs=1e-9)


def test_acceleration_is_of_its_window_only():
    t = times()
    position = np.where(t < 0.5, t**2, 0.25 + (t - 0.5) + 3 * (t - 0.5) ** 2)
    assert accelerated(t, position, start_s=0.0, end_s=0.5) == pytest.approx(2, abs=1e-9)
    assert accelerated(t, position, start_s=0.5, end_s=1.0) == pytest.approx(6, abs=1e-9)
    assert accelerated(t, position, start_s=0.25, end_s=0.75) not in (
        pytest.approx(2, abs=0.5),
        pytest.approx(6, abs=0.5),
    )


def test_acceleration_needs_samples():
    t = times()
    assert accelerated(t, t**2, start_s=0.3, end_s=0.304) is None
    assert accelerated(t, t**2, start_s=0.3, end_s=0.305) == pytest.approx(2, rel=1e-6)
    assert accelerated(t, t**2, start_s=2.0, end_s=3.0) is None


def test_acceleration_averages_noise_away():
    t, noise = times(), np.random.default_rng(1)
    position = t**2 + noise.normal(0, 1e-4, len(t))
    assert accelerated(t, position) == pytest.approx(2, abs=1e-3)


# --- slip -----------------------------------------------------------------------------------------


def slipped(t, position, angle, **options):
    options = {"radius_m": 0.03, "start_s": 0.1, "end_s": 1.0, **options}
    found = slip.measure(made(t, x=position, angle=angle), request("x", "angle", **options))
    return found.values["slip"]


@given(part=st.floats(0, 0.99), backward=st.booleans())
def test_slip_is_the_part_that_does_not_become_distance(part, backward):
    t = times()
    angle = (-1 if backward else 1) * 10 * t**2
    assert slipped(t, 7 + (1 - part) * 0.03 * angle, angle) == pytest.approx(part, abs=1e-12)


def test_a_wheel_that_is_smaller_than_said_seems_to_slip():
    t = times()
    assert slipped(t, 0.03 * t, t, radius_m=0.0303) == pytest.approx(0.0099, abs=1e-4)


def test_a_braked_wheel_has_negative_slip_and_a_still_one_none():
    t = times()
    assert slipped(t, 0.06 * t, t) == pytest.approx(-1)
    assert slipped(t, t, 0 * t) is None
    assert slipped(t, t, t, start_s=3.0, end_s=4.0) is None


# --- heading --------------------------------------------------------------------------------------


def turned(yaw, *, pitch=0.0):
    zero = np.zeros(len(yaw))
    yawing = quaternions_of(np.column_stack((zero, zero, yaw)))
    pitching = quaternions_of(np.column_stack((zero, zero + pitch, zero)))
    signals = {"made.q": multiply(yawing, pitching)}
    trajectory = Trajectory("made", times()[: len(yaw)], signals)
    return heading.measure(trajectory, Request(probe("q", component=3))).values


@given(rate=st.floats(-20, 20), first=st.floats(-3, 3), pitch=st.floats(-1.2, 1.2))
def test_heading_counts_on_through_whole_turns(rate, first, pitch):
    found = turned(first + rate * times(), pitch=pitch)
    assert found["heading_change"] == pytest.approx(rate, abs=1e-9)
    assert found["heading_drift"] == pytest.approx(abs(rate), abs=1e-9)


def test_a_drift_that_comes_back_is_still_a_drift():
    found = turned(-0.01 * np.sin(math.pi * times()))
    assert found["heading_change"] == pytest.approx(0, abs=1e-12)
    assert found["heading_drift"] == pytest.approx(0.01, rel=1e-6)


def test_nodding_is_no_turning():
    assert turned(np.zeros(50), pitch=0.4)["heading_drift"] == pytest.approx(0, abs=1e-12)


# --- energy of a vehicle --------------------------------------------------------------------------

BODY, WHEEL, RADIUS = 0.5, 0.03, 0.0325
OPTIONS = {
    "body_mass_kg": BODY,
    "wheel_mass_kg": WHEEL,
    "wheel_inertia_kg_m2": WHEEL * RADIUS**2 / 2,
    "armature_kg_m2": 2e-5,
    "axle_friction_N_m": 1e-3,
    "axle_damping_N_m_s_rad": 1e-4,
    "sliding_friction": 0.2,
    "share": 1.0,
}
SIGNALS = ("distance", "angle", "torque")


def balanced(change=None, scaled=None, **options):
    """Energies of a robot that drives as its torques say, or as they do not."""
    options = {**OPTIONS, **options}
    t = times()
    x, a = t**2, 2.0  # two metres a second more in each second
    angle, rate = x / RADIUS, a * t / RADIUS
    both = 2 if options["share"] == 1 else 1
    inertia = options["wheel_inertia_kg_m2"] + options["armature_kg_m2"]
    felt = options["body_mass_kg"] + both * (options["wheel_mass_kg"] + inertia / RADIUS**2)
    lost = options["axle_friction_N_m"] + options["axle_damping_N_m_s_rad"] * rate
    load = 1.5 + 0 * t
    torque = lost + (felt * a + options["sliding_friction"] * load) * RADIUS / both
    signals = {"body": x, "sliding_load": load}
    for side in ("left", "right"):
        for name, values in zip(SIGNALS, (x, angle, torque), strict=True):
            signals[f"{side}_{name}"] = values
    if change:
        signals[change] = signals[change] * scaled
    trajectory = made(t, **signals)
    asked = request("body", *energy_balance.ROLES, **options)
    return energy_balance.measure(trajectory, asked).values


def test_work_becomes_motion_and_heat():
    found = balanced()
    assert found["drive_work"] == pytest.approx(found["kinetic_gain"] + found["dissipated"])
    assert abs(found["energy_imbalance"]) < 1e-9
    # from 0.001 s to 0.999 s: ½·m·v², with all that turns
    inertia = OPTIONS["wheel_inertia_kg_m2"] + OPTIONS["armature_kg_m2"]
    felt = BODY + 2 * (WHEEL + inertia / RADIUS**2)
    assert found["kinetic_gain"] == pytest.approx(felt / 2 * (1.998**2 - 0.002**2), rel=1e-9)


def test_one_wheel_for_both_counts_once():
    options = {"wheel_mass_kg": 2 * WHEEL, "wheel_inertia_kg_m2": WHEEL * RADIUS**2, "share": 0.5}
    assert abs(balanced(**options)["energy_imbalance"]) < 1e-9


@pytest.mark.parametrize(
    ("change", "scaled"),
    [
        ("left_torque", 1.05), ("right_torque", 0.95), ("body", 0.98), ("left_angle", 1.1),
        ("right_angle", 0.9), ("left_distance", 1.2), ("right_distance", 0.5),
        ("sliding_load", 2.0),
    ],
)  # fmt: skip
def test_a_motion_that_does_not_follow_from_the_torques_is_an_imbalance(change, scaled):
    assert abs(balanced(change, scaled)["energy_imbalance"]) > 2e-3


@pytest.mark.parametrize("option", sorted(set(OPTIONS) - {"share"}))
def test_every_option_counts(option):
    t = times()
    signals = {f"{side}_{part}": t**2 for side in ("left", "right") for part in SIGNALS}
    trajectory = made(t, body=t**2, sliding_load=1 + 0 * t, **signals)
    one, two = (
        energy_balance.measure(
            trajectory,
            request("body", *energy_balance.ROLES, **{**OPTIONS, option: factor * OPTIONS[option]}),
        ).values["energy_imbalance"]
        for factor in (1, 2)
    )
    assert one != pytest.approx(two, rel=1e-6)


def test_without_work_there_is_no_balance():
    assert balanced("left_torque", 0.0)["energy_imbalance"] is not None
    t = np.array([0.0, 0.1])
    trajectory = made(t, body=t, sliding_load=t, **dict.fromkeys(energy_balance.ROLES[:-1], t))
    found = energy_balance.measure(trajectory, request("body", *energy_balance.ROLES, **OPTIONS))
    assert set(found.values.values()) == {None}


# --- rise of a speed ------------------------------------------------------------------------------


def risen(t, position, start_s=0.0, end_s=1.0):
    found = rise.measure(made(t, x=position), request("x", start_s=start_s, end_s=end_s))
    return found.values["terminal_speed"], found.values["time_constant"]


@given(
    speed=st.floats(0.01, 50),
    constant_s=st.floats(0.02, 0.6),
    first=st.floats(-0.5, 0.5),
    x=st.floats(-1, 1),
)
def test_a_rise_is_found_from_any_start(speed, constant_s, first, x):
    t = times()
    gone = -np.expm1(-t / constant_s)
    position = x + speed * (t - (1 - first) * constant_s * gone)
    found = risen(t, position)
    assert found[0] == pytest.approx(speed, rel=1e-6)
    assert found[1] == pytest.approx(constant_s, rel=1e-6)


def test_a_rise_does_not_depend_on_where_the_window_begins():
    t = times()
    position = 0.17 * (t + 0.1 * np.expm1(-t / 0.1))
    for start_s in (0.0, 0.05, 0.2):
        assert risen(t, position, start_s) == (pytest.approx(0.17), pytest.approx(0.1))


def test_a_rise_is_found_in_noise():
    t, noise = times(), np.random.default_rng(2)
    position = 0.17 * (t + 0.1 * np.expm1(-t / 0.1)) + noise.normal(0, 1e-6, len(t))
    speed, constant_s = risen(t, position)
    assert speed == pytest.approx(0.17, rel=1e-3)
    assert constant_s == pytest.approx(0.1, rel=1e-2)


def test_what_does_not_rise_to_an_end_has_no_time_constant():
    t = times()
    for position in (0 * t, 3 * t, t**2, t[:5]):
        assert risen(t[: len(position)], position) == (None, None)


def test_another_shape_is_not_taken_for_the_same_rise():
    # two stages of 0.1 s in place of one: slower at first
    t = times()
    two = 0.17 * (t - 0.2 + (0.2 + t) * np.exp(-t / 0.1))
    assert risen(t, two)[1] > 0.12


# --- energy of a motor ----------------------------------------------------------------------------

RESISTANCE, CONSTANT, RATIO, SHARE = 6.0, 0.0055, 48.0, 0.35


def powered(torque_factor=1.0, **options):
    options = {"resistance_Ohm": RESISTANCE, "efficiency": SHARE, **options}
    t = times()
    angle = 2.5 * t**2
    voltage = 2.0 + t
    current = (voltage - CONSTANT * RATIO * 5 * t) / RESISTANCE
    torque = torque_factor * SHARE * RATIO * CONSTANT * current
    trajectory = made(t, current=current, voltage=voltage, torque=torque, angle=angle)
    asked = request("current", "voltage", "torque", "angle", **options)
    return motor_energy.measure(trajectory, asked).values


def test_what_goes_into_a_motor_comes_out_as_work_and_heat():
    found = powered()
    parts = found["copper_loss"] + found["gear_loss"] + found["shaft_work"]
    assert found["electrical_energy"] == pytest.approx(parts, rel=1e-5)
    assert abs(found["motor_imbalance"]) < 1e-5
    # ∫(2 + t)·i dt and ∫R·i² dt with i = (2 + t - 1.32·t)/6
    assert found["electrical_energy"] == pytest.approx((4 + 0.68 - 0.32 / 3) / 6, rel=1e-5)
    assert found["copper_loss"] == pytest.approx((4 - 0.64 + 0.32**2 / 3) / 6, rel=1e-5)


def test_a_torque_without_its_current_is_an_imbalance():
    assert abs(powered(torque_factor=1.1)["motor_imbalance"]) > 0.01
    assert abs(powered(resistance_Ohm=6.6)["motor_imbalance"]) > 0.01
    assert abs(powered(efficiency=0.4)["motor_imbalance"]) > 0.01


def test_a_motor_without_current_has_no_balance():
    t = times()
    names = ("current", "voltage", "torque", "angle")
    asked = request(*names, resistance_Ohm=1.0, efficiency=0.5)
    found = motor_energy.measure(made(t, **dict.fromkeys(names, 0 * t)), asked)
    assert found.values["motor_imbalance"] is None


# --- all ------------------------------------------------------------------------------------------


def test_each_is_judged_beside_the_truth():
    t = times()
    window = {"start_s": 0.0, "end_s": 1.0}
    for module, asked in (
        (acceleration, request("x", **window)),
        (slip, Request(probe("x"), {"angle": probe("x")}, {"radius_m": 1.1, **window})),
        (rise, request("x", **window)),
    ):
        ours, true = (
            module.measure(made(t, x=f * (t + 0.1 * np.expm1(-t / 0.1))), asked) for f in (2, 1)
        )
        assert side_by_side(ours, true) == {
            name: (ours.values[name], true.values[name]) for name in module.UNITS
        }
