"""Speed from a wheel and an accelerometer: the first lesson in filters, and what can go wrong."""

from __future__ import annotations

import math

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.estimation import consistency, estimators, wheel
from simcompare.estimation.estimate import Given, Signal
from simcompare.statistics.streams import stream

DIAMETER_M, STEP_S, COUNT = 0.065, 0.01, 200
OPTIONS = {"diameter_m": DIAMETER_M, "jerk_density_m2_s5": 1.0}
U_RATE, U_ACCELERATION = 0.02 / (DIAMETER_M / 2), 0.05


def driven(run, bias=0.0):
    """A vehicle under white jerk, with white noise of known size."""
    generator = stream(5, "speed", run)
    jerk = np.linalg.cholesky(np.array([[STEP_S**3 / 3, STEP_S**2 / 2], [STEP_S**2 / 2, STEP_S]]))
    state = np.zeros(2)
    states = []
    for number in range(COUNT):
        if number:
            state = np.array([state[0] + STEP_S * state[1], state[1]])
            state = state + jerk @ generator.standard_normal(2)
        states.append(state)
    speed, acceleration = np.array(states).T
    time_s = STEP_S * np.arange(COUNT)
    rate = speed / (DIAMETER_M / 2) + U_RATE * generator.standard_normal(COUNT)
    felt = acceleration + bias + U_ACCELERATION * generator.standard_normal(COUNT)
    signals = {
        "wheel_rate": Signal(time_s, rate, U_RATE),
        "acceleration": Signal(time_s, felt, U_ACCELERATION),
    }
    truth = {"speed": Signal(time_s, speed), "acceleration": Signal(time_s, acceleration)}
    return Given(signals, truth, OPTIONS)


def estimated(given, **options):
    estimator = estimators.load("speed_filter")
    both = {**given.options, **options}
    return estimators.apply(estimator, Given(given.signals, given.truth, both))


def nees(found):
    rows = np.array([one.innovations.nees for one in found])
    return consistency.nees(rows, found[0].innovations.states)


def test_the_filter_is_consistent_and_better_than_each_sensor():
    found = [estimated(driven(run)) for run in range(25)]
    assert nees(found).outcome == "consistent"
    ways = {way.name: way for way in found[0].ways}
    errors = {name: one.states["speed_m_s"].rms_error for name, one in ways.items()
              if "speed_m_s" in one.states}  # fmt: skip
    assert errors["smoothed"] < errors["filtered"] < errors["wheel alone"]


def test_a_bias_makes_the_filter_too_sure_and_a_third_state_cures_it():
    given = [driven(run, bias=0.3) for run in range(25)]
    without = nees([estimated(one) for one in given])
    assert without.outcome in ("too sure", "diverged")
    with_state = [estimated(one, bias=1.0) for one in given]
    ways = {way.name: way for way in with_state[0].ways}
    summed_up = ways["acceleration summed up"].states["speed_m_s"]
    assert summed_up.rms_error > 10 * with_state[0].best.states["speed_m_s"].rms_error
    # the bias itself has no truth here: the two states that have are judged
    assert nees(with_state).outcome == "consistent"
    bias = [one.numbers["last_bias_m_s2"] for one in with_state]
    # 25 runs: the mean to a fifth of one uncertainty, three of these
    far = abs(np.mean([one.value for one in bias]) - 0.3)
    assert far < 3 * bias[0].u / math.sqrt(25)


def settling(run):
    """1.7 m/s² that fades in 0.1 s, told 3 % wrong; an accelerometer with a scale of 3 %."""
    generator = stream(6, "fading", run)
    time_s, (told, scale) = 0.01 * np.arange(60), 0.03 * generator.standard_normal(2)
    acceleration = 1.7 * np.exp(-time_s / 0.1)
    speed = 0.17 - 0.1 * acceleration
    rate = speed / (DIAMETER_M / 2) + U_RATE * generator.standard_normal(60)
    felt = acceleration * (1 + scale) + 0.3 + U_ACCELERATION * generator.standard_normal(60)
    signals = {
        "wheel_rate": Signal(time_s, rate, U_RATE),
        "acceleration": Signal(time_s, felt, U_ACCELERATION),
    }
    truth = {"speed": Signal(time_s, speed), "acceleration": Signal(time_s, acceleration)}
    options = {
        "diameter_m": DIAMETER_M, "jerk_density_m2_s5": 1e-6, "bias": 1, "scale": 1,
        "settling_s": 0.1, "faster": told, "u_settling": 0.03,
    }  # fmt: skip
    return Given(signals, truth, options)


def test_a_filter_that_knows_how_accelerations_fade_needs_no_noise_for_it():
    given = [settling(run) for run in range(30)]
    found = [estimated(one) for one in given]
    assert nees(found).outcome == "consistent", nees(found)
    assert nis(found).outcome == "consistent", nis(found)
    noisy = [estimated(one, settling_s=0, jerk_density_m2_s5=3) for one in given]
    assert nis(noisy).outcome == "too careful"
    errors = [
        np.mean([one.best.states["speed_m_s"].rms_error for one in every])
        for every in (found, noisy)
    ]
    assert errors[0] < 0.8 * errors[1]


def nis(found):
    rows = ([getattr(one.innovations, name) for one in found] for name in ("nis", "used"))
    return consistency.nis(*map(np.array, rows))


def test_true_speeds_and_accelerations_are_changes_of_the_way():
    """Of x = t³ they are 3t² and 6t; over 20 ms the speed is 5 ms squared more, and 6t is exact."""
    given = settling(0)
    time_s = np.linspace(0, 1, 1001)
    options = {**given.options, "truth_over_s": 0.02}
    truth = {"way": Signal(time_s, time_s**3), "speed": Signal(time_s, 0 * time_s)}
    found = estimated(Given(given.signals, truth, options)).best
    within = np.isfinite(found.states["speed_m_s"].truth)
    assert np.count_nonzero(within) > 50
    t = found.time_s[within]
    speed, acceleration = (
        found.states[name].truth[within] for name in ("speed_m_s", "acceleration_m_s2")
    )
    assert speed[2:] == pytest.approx(3 * t[2:] ** 2 + 0.005**2, rel=1e-6)
    assert acceleration[2:] == pytest.approx(6 * t[2:], rel=1e-6)


def test_marks_are_counted_in_gates():
    time_s = np.arange(0, 1.0005, 0.001)
    turned = 5.0 * time_s  # rad, at 5 rad/s
    counts = np.floor(turned * 960 / (2 * math.pi))
    signals = {"marks": Signal(time_s, counts)}
    given = Given(signals, {}, {**OPTIONS, "marks": 960.0, "gate_s": 0.02})
    found = estimated(given)
    alone = next(way for way in found.ways if way.name == "wheel alone")
    values = alone.states["speed_m_s"].values
    pitch = wheel.way_of_mark(DIAMETER_M, 960)
    # each count is off by less than one mark
    assert values == pytest.approx(5.0 * DIAMETER_M / 2, abs=pitch / 0.02)
    last = found.best.states["speed_m_s"]
    assert last.values[-1] == pytest.approx(0.1625, abs=3 * last.u[-1])
    assert alone.time_s[0] == pytest.approx(0.01)


def test_a_diameter_is_told_beside_the_filter_and_not_in_it():
    given = driven(0)
    plain, open_ = estimated(given), estimated(given, u_diameter_m=0.0005)
    assert np.array_equal(plain.best.states["speed_m_s"].u, open_.best.states["speed_m_s"].u)
    speed = abs(open_.best.states["speed_m_s"].values[-1])
    told = open_.numbers["speed_open_by_diameter"]
    assert (told.value, told.unit) == (pytest.approx(speed * 0.0005 / DIAMETER_M), "m/s")


def test_the_trap_of_the_unit_is_a_factor_of_two_pi():
    rate_rad_s = 10.0
    right = wheel.speed_from_rate(DIAMETER_M, rate_rad_s)
    assert right == pytest.approx(0.325)
    # rad/s put into the formula for revolutions per second
    trapped = math.pi * DIAMETER_M * rate_rad_s
    assert trapped / right == pytest.approx(2 * math.pi)


@pytest.mark.parametrize(
    ("signals", "options", "told"),
    [
        ({}, OPTIONS, "no wheel is given; expected the signal marks or wheel_rate"),
        (
            {"marks": Signal(np.arange(9.0), np.arange(9.0))},
            OPTIONS,
            "expected the marks in one turn",
        ),
        (
            {"wheel_rate": Signal(np.arange(9.0), np.arange(9.0))},
            OPTIONS,
            "the noise of the wheel is not known",
        ),
        ({}, {}, "the option diameter_m is missing: diameter of the wheel"),
        ({}, {**OPTIONS, "gate_s": -1.0}, "gate_s = -1 is not within"),
        ({}, {**OPTIONS, "jerk": 1.0}, "no option of the estimator is called 'jerk'"),
    ],
)
def test_what_cannot_be_estimated_is_said(signals, options, told):
    estimator = estimators.load("speed_filter")
    with pytest.raises(InputError, match=told):
        estimators.apply(estimator, Given(signals, {}, options))
