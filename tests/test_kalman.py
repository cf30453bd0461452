"""The Kalman filter against the Riccati equation, known numbers and an independent library."""

from __future__ import annotations

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.estimation import consistency, kalman
from simcompare.estimation.kalman import Belief
from simcompare.estimation.linear import Linear, steady_gain
from simcompare.estimation.smoother import smooth
from simcompare.estimation.speed_filter import matrices
from simcompare.statistics.streams import stream


def model(step_s=0.01, jerk=1.0, u_speed=0.02, u_acceleration=0.05):
    transition, noise = matrices(step_s, jerk)
    return Linear(transition, noise, np.eye(2), np.diag([u_speed**2, u_acceleration**2]))


START = Belief(np.zeros(2), np.diag([0.1**2, 1.0]))


def driven(linear, count, *names):
    """A motion that is as the model says, and its measurements."""
    generator = stream(7, *names)
    step = np.linalg.cholesky(linear.noise)
    u = np.sqrt(np.diag(linear.measurement_noise))
    state = np.linalg.cholesky(START.covariance) @ generator.standard_normal(2)
    states, measured = [], []
    for number in range(count):
        if number:
            state = linear.transition @ state + step @ generator.standard_normal(2)
        states.append(state)
        measured.append(state + u * generator.standard_normal(2))
    return np.array(states), np.array(measured)


def filtered(linear, measured, start=START):
    return kalman.run(start, measured, linear.move, linear.expect)


def test_the_gain_settles_at_the_known_one():
    # the eight printed digits of a gain that 2000 iterations gave independently
    known = [[0.02827884, 0.00565889], [0.03536806, 0.82821491]]
    assert steady_gain(model()) == pytest.approx(np.array(known), abs=5e-9)


def test_the_filter_settles_at_the_gain_of_the_riccati_equation():
    linear = model()
    found = filtered(linear, np.zeros((2000, 2)))
    before = found.predicted_covariances[-1]
    gain = before @ np.linalg.inv(before + linear.measurement_noise)
    # both are algebra in double precision; the slowest eigenvalue 0.97 is 1e-25 after 2000 steps
    assert gain == pytest.approx(steady_gain(linear), abs=1e-12)
    known = [[1.13115374e-5, 1.41472243e-5], [1.41472243e-5, 2.07053727e-3]]
    assert found.covariances[-1] == pytest.approx(np.array(known), rel=1e-8)


def test_josephs_form_is_the_short_one_for_the_best_gain():
    linear = model()
    before = Belief(np.zeros(2), np.array([[4e-4, 1e-4], [1e-4, 9e-3]]))
    expected = linear.expect(before.mean, 0)
    mended = kalman.update(before, np.array([0.1, 0.2]), expected)
    s = before.covariance + linear.measurement_noise
    gain = before.covariance @ np.linalg.inv(s)
    short = (np.eye(2) - gain) @ before.covariance
    # rounding of products of 2x2 matrices
    assert mended.belief.covariance == pytest.approx(short, abs=1e-16)


@pytest.mark.parametrize("factor", [-3.0, 0.0, 0.5, 2.5, 40.0])
def test_josephs_form_stays_positive_with_a_wrong_gain(factor):
    linear = model()
    before = Belief(np.zeros(2), np.array([[4e-4, 1e-4], [1e-4, 9e-3]]))
    gain = factor * steady_gain(linear)
    joseph = kalman.joseph(before, gain, linear.expect(before.mean, 0))
    assert np.linalg.eigvalsh(joseph)[0] > 0
    if factor == 40.0:  # where the short form claims a negative variance
        short = (np.eye(2) - gain) @ before.covariance
        assert np.linalg.eigvalsh((short + short.T) / 2)[0] < 0


@pytest.fixture(scope="module")
def pykalman_filter():
    pykalman = pytest.importorskip("pykalman")
    linear = model(0.02, 3.0, 0.03, 0.1)
    _, measured = driven(linear, 150, "against another library")
    other = pykalman.KalmanFilter(
        transition_matrices=linear.transition,
        observation_matrices=linear.observation,
        transition_covariance=linear.noise,
        observation_covariance=linear.measurement_noise,
        initial_state_mean=START.mean,
        initial_state_covariance=START.covariance,
    )
    return other, linear, measured


def test_an_independent_library_filters_the_same(pykalman_filter):
    other, linear, measured = pykalman_filter
    means, covariances = other.filter(measured)
    ours = filtered(linear, measured)
    # 150 steps of rounding; pykalman uses the short form and a pseudo-inverse
    assert ours.means == pytest.approx(means, abs=1e-10)
    assert ours.covariances == pytest.approx(covariances, abs=1e-12)


def test_an_independent_library_smooths_the_same(pykalman_filter):
    other, linear, measured = pykalman_filter
    means, covariances = other.smooth(measured)
    ours = smooth(filtered(linear, measured))
    assert ours.means == pytest.approx(means, abs=1e-10)
    assert ours.covariances == pytest.approx(covariances, abs=1e-12)


def test_smoothing_errs_less_than_filtering():
    linear = model()
    states, measured = driven(linear, 300, "smoothing")
    forward = filtered(linear, measured)
    errors = {
        name: np.sqrt(np.mean((one.means - states) ** 2, axis=0))
        for name, one in {"filter": forward, "smoother": smooth(forward)}.items()
    }
    assert np.all(errors["smoother"] < errors["filter"])


@pytest.fixture(scope="module")
def two_hundred():
    linear = model()
    runs = []
    for number in range(200):
        states, measured = driven(linear, 40, "consistency", number)
        runs.append((states, filtered(linear, measured)))
    return runs


def test_two_hundred_right_filters_are_consistent(two_hundred):
    nees = [consistency.nees_of(one.means - states, one.covariances) for states, one in two_hundred]
    found = consistency.nees(np.array(nees), 2)
    # limits of χ² with 400 degrees of freedom, over 200
    assert (found.low, found.high) == pytest.approx((1.732, 2.287), abs=5e-4)
    assert found.outcome == "consistent"
    # 95 % of 40 correlated instants; fewer than 80 % would be a wrong covariance
    assert found.inside >= 0.8


def test_innovations_of_right_filters_are_white(two_hundred):
    nis = np.array([one.nis for _, one in two_hundred])
    used = np.array([one.used for _, one in two_hundred])
    assert consistency.nis(nis, used).outcome == "consistent"
    rows = [row for _, one in two_hundred for row in (one.innovations / one.innovation_u).T]
    found = consistency.whiteness(rows)
    assert found.outcome == "consistent"
    assert abs(found.lag_1) < 0.05  # 400 rows of 40: 1/√16000 = 0.008, and a bias of -1/40


def test_a_filter_that_trusts_its_sensors_too_much_is_too_sure():
    truth, believed = model(), model(u_speed=0.005, u_acceleration=0.01)
    runs = []
    for number in range(20):
        states, measured = driven(truth, 60, "too sure", number)
        one = filtered(believed, measured)
        runs.append(consistency.nees_of(one.means - states, one.covariances))
    assert consistency.nees(np.array(runs), 2).outcome in ("too sure", "diverged")


def test_a_filter_that_trusts_its_sensors_too_little_is_too_careful():
    truth, believed = model(), model(u_speed=0.1, u_acceleration=0.4)
    values, used = [], []
    for number in range(20):
        _, measured = driven(truth, 60, "too careful", number)
        one = filtered(believed, measured)
        values.append(one.nis)
        used.append(one.used)
    assert consistency.nis(np.array(values), np.array(used)).outcome == "too careful"


@pytest.mark.parametrize("runs", [1, 2, 200])
def test_more_runs_make_the_test_of_innovations_sharper(runs):
    """Innovations that are 10 % too large in their square, of two readings at 2000 instants."""
    values = 1.1 * np.random.default_rng(2).chisquare(2, (runs, 2000))
    found = consistency.nis(values, np.full(values.shape, 2))
    assert found.outcome == "too sure"
    # χ² with 4000 degrees of freedom for each run: ±1.96·2/√2000 for one
    assert found.high - 2 == pytest.approx(1.96 * 2 / np.sqrt(2000 * runs), rel=0.02)


def test_white_innovations_are_seldom_called_not_white():
    """Lags are counted, so the test holds 1 in 400 of one series, not 1 in 100."""
    generator = np.random.default_rng(3)
    found = [consistency.whiteness([generator.standard_normal(200)]) for _ in range(2000)]
    called = sum(one.outcome == "not white" for one in found)
    assert called <= 13  # of a Poisson number of mean 5, more than 13 come once in 1400
    assert found[0].low == pytest.approx(16 / 20)


def test_a_bias_shifts_the_estimate_as_the_closed_form_says():
    linear = model()
    bias = np.tile([0.0, 0.1], (3000, 1))
    found = filtered(linear, bias).means[-1]
    # (I - (I - K)·F)⁻¹·K·b, in the digits in which it is known
    assert found == pytest.approx([0.034147, 0.098500], abs=5e-7)


def test_a_missing_reading_leaves_the_others():
    linear = model()
    _, measured = driven(linear, 50, "gaps")
    measured[10:20, 0] = np.nan
    measured[30] = np.nan
    found = filtered(linear, measured)
    assert list(found.used[[5, 15, 30]]) == [2, 1, 0]
    assert np.isnan(found.nis[30])
    assert np.all(np.isfinite(found.means))
    assert found.uncertainties[19, 0] > found.uncertainties[9, 0]


def test_the_gate_refuses_a_reading_that_cannot_be():
    linear = model()
    _, measured = driven(linear, 50, "gate")
    spoilt = measured.copy()
    spoilt[25, 0] += 5.0
    kept = kalman.run(START, spoilt, linear.move, linear.expect, gate=4.0)
    assert kept.refused.sum() == 1
    assert kept.refused[25, 0]


def test_a_covariance_that_no_computer_can_hold_is_refused():
    with pytest.raises(InputError, match="covariance of the start is singular"):
        filtered(model(), np.zeros((3, 2)), Belief(np.zeros(2), np.diag([1.0, np.inf])))


def test_a_singular_start_is_refused():
    linear = model()
    with pytest.raises(InputError, match=r"covariance of the start is singular.*expected each abo"):
        filtered(linear, np.zeros((3, 2)), Belief(np.zeros(2), np.diag([1.0, 0.0])))


def test_readings_that_tell_each_other_are_refused():
    seen = np.array([[1.0, 0.0], [1.0, 0.0]])
    linear = Linear(*matrices(0.01, 1.0), seen, np.zeros((2, 2)))
    with pytest.raises(InputError, match="covariance of the innovations is singular"):
        filtered(linear, np.zeros((3, 2)))


def test_a_state_that_no_sensor_sees_has_no_steady_gain():
    transition, noise = np.diag([1.0, 2.0]), np.eye(2)
    linear = Linear(transition, noise, np.array([[1.0, 0.0]]), np.eye(1))
    with pytest.raises(InputError, match="not seen by any sensor"):
        steady_gain(linear)


def test_a_filter_that_runs_away_says_so():
    linear = Linear(np.diag([1e200, 1.0]), np.eye(2), np.eye(2), np.eye(2) * 1e300)
    start = Belief(np.array([1e150, 0.0]), np.eye(2))
    with pytest.raises(InputError, match=r"diverged|singular"), np.errstate(all="ignore"):
        filtered(linear, np.full((5, 2), 1e10), start)
