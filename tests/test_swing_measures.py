"""Periods and decay of swings from positions: exact, noisy, stepped, unevenly sampled."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import ellipk

from simcompare import measures
from simcompare.measures import Request, _swings, swing_decay, swing_period
from simcompare.model.scenario import Probe
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.pendulum import reference as pendulum

PROBE = Probe(observe="angle", component=None, label="Angle", unit="rad")
#: step of an encoder with 40000 counts a turn
COUNT = math.radians(0.009)


def taken(function, time_s, angle, level=0.0, band=0.02):
    request = Request(PROBE, {}, {"level": level, "band": band})
    return function.measure(Trajectory("log", time_s, {"angle": angle}), request)


def swinging(time_s, **changes):
    p = dict(catalogue.load("pendulum").resolve(changes).parameters)
    small = 2 * math.pi * math.sqrt(p["length_m"] / p["gravity_m_s2"])
    return small, pendulum.motion(p, time_s)[0]


def test_lengthening_is_the_elliptic_integral():
    amplitude = np.array([0.0, 0.1745, 1.0, math.pi / 2, 2.9, 3.1415])
    expected = 2 / math.pi * ellipk(np.sin(amplitude / 2) ** 2)
    np.testing.assert_allclose(_swings.lengthening(amplitude), expected, rtol=1e-9)
    assert np.isnan(_swings.lengthening(np.array([math.pi, 4.0]))).all()


def test_a_sine_has_its_period_whatever_its_phase_and_level():
    t = np.arange(0, 10, 0.001)
    for phase in (0.0, 0.3, 2.0, 4.5):
        found = taken(swing_period, t, 0.7 + 0.2 * np.sin(2 * math.pi * t / 0.83 + phase), 0.7)
        np.testing.assert_allclose(found.series["period"], 0.83, atol=1e-9)
        np.testing.assert_allclose(found.series["swing_amplitude"], 0.2, atol=1e-6)


@pytest.mark.parametrize(
    ("start", "within"), [(0.1, 1e-6), (1.0, 1e-6), (2.0, 5e-6), (2.9, 2e-5), (3.05, 2e-4)]
)
def test_large_swings_are_corrected_to_the_small_period(start, within):
    t = np.arange(0, 10, 0.001)
    small, angle = swinging(t, start_angle_rad=start, damping_N_m_s_rad=0, friction_N_m=0)
    found = taken(swing_period, t, angle)
    longer = 2 / math.pi * ellipk(math.sin(start / 2) ** 2)
    assert found.values["mean_period"] == pytest.approx(small * longer, rel=1e-8)
    assert found.values["small_angle_period"] == pytest.approx(small, rel=within)
    assert found.values["period_scatter"] < 1e-5


def test_decay_within_a_swing_does_not_bias_the_small_period():
    # three per cent are lost in each swing; the amplitude at its beginning would make it 3e-3 short
    t = np.arange(0, 20, 0.001)
    small, angle = swinging(t, damping_N_m_s_rad=0.0002, friction_N_m=0.0006)
    found = taken(swing_period, t, angle)
    np.testing.assert_allclose(found.series["small_period"], small, rtol=2e-4)
    assert found.values["small_angle_period"] == pytest.approx(small, rel=1e-4)


def test_a_level_that_is_a_little_off_does_not_bias_the_small_period():
    t = np.arange(0, 20, 0.001)
    small, angle = swinging(t, damping_N_m_s_rad=0.0002, friction_N_m=0)
    found = taken(swing_period, t, angle, level=0.005)
    assert found.values["small_angle_period"] == pytest.approx(small, rel=3e-5)


def test_noise_and_the_steps_of_an_encoder_make_no_extra_swings():
    random = np.random.default_rng(1)
    t = np.arange(0, 20, 0.001)
    small, angle = swinging(t)
    plain = taken(swing_period, t, angle)
    stepped = np.round((angle + random.normal(0, 0.004, len(t))) / COUNT) * COUNT
    found = taken(swing_period, t, stepped)
    assert len(found.series["period"]) == len(plain.series["period"])
    # a cubic through 80 samples tells a passage to σ/√80 over the rate, some 0.1 ms
    assert np.std(found.series["period"] - plain.series["period"]) < 3e-4
    assert found.values["small_angle_period"] == pytest.approx(small, rel=1e-4)


def test_uneven_times_and_a_start_in_mid_swing_are_measured_as_well():
    random = np.random.default_rng(2)
    t = np.cumsum(random.uniform(0.0005, 0.006, 5000))
    small, angle = swinging(t - t[0], start_angle_rad=-0.4, start_rate_rad_s=3.0)
    found = taken(swing_period, t, angle)
    assert found.values["small_angle_period"] == pytest.approx(small, rel=5e-5)


def test_a_camera_at_thirty_frames_tells_the_period():
    t = np.arange(0, 20, 1 / 30)
    small, angle = swinging(t)
    found = taken(swing_period, t, angle)
    assert found.values["small_angle_period"] == pytest.approx(small, rel=1e-3)


@pytest.mark.parametrize(
    "angle",
    [
        np.zeros(1000),
        np.linspace(-1, 1, 1000),
        np.sin(np.linspace(0, 4.5, 1000)),
        0.01 * np.sin(np.linspace(0, 60, 1000)),
        np.array([1.0]),
        np.array([1.0, -1.0, 1.0]),
    ],
    ids=["rest", "a line", "less than a swing", "within the band", "one sample", "three"],
)
def test_without_a_full_swing_there_is_no_period(angle):
    found = taken(swing_period, np.arange(len(angle)) * 0.001, angle)
    assert set(found.values.values()) == {None}
    assert not len(found.series["period"])
    assert taken(swing_decay, np.arange(len(angle)) * 0.001, angle).values["log_decrement"] is None


def test_one_swing_has_a_period_and_no_scatter():
    t = np.arange(0, 1.6, 0.001)
    found = taken(swing_period, t, np.sin(2 * math.pi * t + 0.5))
    assert found.values["mean_period"] == pytest.approx(1, abs=1e-8)
    assert found.values["period_scatter"] is None


@given(st.floats(0.2, 3.0), st.floats(0.1, 1.5), st.floats(0, 6.3), st.floats(-3, 3))
@settings(max_examples=50)
def test_every_sine_is_measured(period, amplitude, phase, level):
    t = np.arange(0, 10, 0.002)
    angle = level + amplitude * np.sin(2 * math.pi * t / period + phase)
    found = taken(swing_period, t, angle, level)
    np.testing.assert_allclose(found.series["period"], period, rtol=1e-6)
    assert len(found.series["period"]) >= math.floor(2 * (10 / period - 1.5))


def test_the_logarithmic_decrement_is_that_of_the_damper():
    t = np.arange(0, 10, 0.001)
    _, angle = swinging(t, start_angle_rad=0.05, damping_N_m_s_rad=0.0003, friction_N_m=0)
    p = catalogue.load("pendulum").resolve({"damping_N_m_s_rad": 0.0003}).parameters
    omega = math.sqrt(p["gravity_m_s2"] / p["length_m"])
    zeta = 0.0003 / pendulum.inertia_kg_m2(p) / 2 / omega
    found = taken(swing_decay, t, angle, band=0.001)
    decrement = 2 * math.pi * zeta / math.sqrt(1 - zeta**2)
    assert found.values["log_decrement"] == pytest.approx(decrement, rel=1e-3)


def test_dry_friction_shows_as_a_loss_that_does_not_depend_on_the_amplitude():
    t = np.arange(0, 10, 0.001)
    _, angle = swinging(t, start_angle_rad=0.1, damping_N_m_s_rad=0, friction_N_m=0.0002)
    p = catalogue.load("pendulum").resolve().parameters
    stiff = p["mass_kg"] * p["gravity_m_s2"] * p["center_part"] * p["length_m"]
    found = taken(swing_decay, t, angle, band=0.001)
    assert found.values["amplitude_loss"] == pytest.approx(4 * 0.0002 / stiff, rel=3e-3)
    np.testing.assert_allclose(found.series["amplitude_loss_each"], 4 * 0.0002 / stiff, rtol=0.01)


def test_means_are_compared_over_the_swings_that_both_have():
    t = np.arange(0, 10, 0.001)
    _, angle = swinging(t)
    whole, half = (taken(swing_period, t[:n], angle[:n]) for n in (10000, 5000))
    for name, (ours, theirs) in swing_period.against(half, whole).items():
        assert ours == pytest.approx(theirs, abs=1e-7), name
    whole, half = (taken(swing_decay, t[:n], angle[:n]) for n in (10000, 5000))
    for name, (ours, theirs) in swing_decay.against(half, whole).items():
        assert ours == pytest.approx(theirs, abs=1e-6), name


def test_who_does_not_swing_has_no_values_beside_the_truth():
    t = np.arange(0, 10, 0.001)
    _, angle = swinging(t)
    still, truth = (taken(swing_period, t, a) for a in (np.zeros(len(t)), angle))
    judged = swing_period.against(still, truth)
    assert {value for value, _ in judged.values()} == {None}
    assert all(true > 0.7 for _, true in judged.values())
    still, truth = (taken(swing_decay, t, a) for a in (np.zeros(len(t)), angle))
    assert {value for value, _ in swing_decay.against(still, truth).values()} == {None}


def test_the_scenario_takes_them():
    scenario = catalogue.load("pendulum").resolve()
    t = np.arange(0, 4.0005, 0.001)
    truth = Trajectory("reference", t, pendulum.reference(scenario.parameters, t))
    values = {}
    for measure in scenario.measures:
        values |= measures.take(measure, scenario, truth).values
    assert values["small_angle_period"] == pytest.approx(0.78481, abs=3e-5)
    assert values["log_decrement"] > 0.02
