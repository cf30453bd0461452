"""Six positions, a rate table and two pressures recover what a sensor is off by."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from simcompare.errors import InputError
from simcompare.hardware.sensors import six_position
from simcompare.hardware.sensors.calibrated import Readings
from simcompare.hardware.sensors.calibration import Taken
from simcompare.statistics.distributions import normal
from simcompare.statistics.streams import stream

G_M_S2 = 9.80665
NAMES = tuple(six_position.POSITIONS)
UP = np.array([six_position.POSITIONS[name] for name in NAMES])
TRUE_S = np.eye(3) + np.array([[0.02, -0.01, 0.015], [0.008, -0.03, 0.004], [-0.02, 0.01, 0.01]])
TRUE_O = np.array([0.5, -0.4, 0.8])
TRUTH = np.concatenate([TRUE_S.ravel(), TRUE_O])
U_NOISE, U_TILT, U_G = 0.004, 0.002, 0.002


def taken(value: float, u: float) -> Taken:
    return Taken(normal(value, u))


def felt(generator: np.random.Generator, u_tilt: float, u_g: float) -> np.ndarray:
    """What acts in six positions, each a little off the vertical, where g is a little off."""
    tilt = generator.normal(0, u_tilt, (6, 3))
    tilt -= np.sum(tilt * UP, axis=1, keepdims=True) * UP
    up = UP + tilt
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    return np.asarray(generator.normal(G_M_S2, u_g) * up)


def drawn(generator: np.random.Generator, *, noise_known: bool = True):
    force = felt(generator, U_TILT if noise_known else 1e-9, U_G)
    read = force @ TRUE_S.T + TRUE_O + generator.normal(0, U_NOISE, (6, 3))
    u = np.full((6, 3), U_NOISE) if noise_known else None
    tilt = taken(0, U_TILT if noise_known else 1e-9)
    return six_position.calibrate(Readings(NAMES, read, u), taken(G_M_S2, U_G), tilt)


def parameters(calibration) -> np.ndarray:
    return np.concatenate([calibration.sensitivity.ravel(), calibration.offset])


def test_perfect_readings_give_back_sensitivity_and_offset():
    read = G_M_S2 * UP @ TRUE_S.T + TRUE_O
    found = six_position.calibrate(
        Readings(NAMES, read, np.full((6, 3), 1e-9)), taken(G_M_S2, 1e-9), taken(0, 1e-9)
    )
    # rounding of 64-bit numbers of size 10
    assert parameters(found) == pytest.approx(TRUTH, abs=1e-12)
    assert found.apply(read) == pytest.approx(G_M_S2 * UP, abs=1e-11)
    assert found.condition == pytest.approx(np.sqrt(3), rel=1e-12)
    assert all(abs(pose.after) < 1e-10 for pose in found.poses)


def test_noise_alone_gives_the_textbook_uncertainties():
    read = G_M_S2 * UP
    found = six_position.calibrate(
        Readings(NAMES, read, np.full((6, 3), U_NOISE)), taken(G_M_S2, 1e-12), taken(0, 1e-12)
    )
    assert found.u_sensitivity == pytest.approx(U_NOISE / (np.sqrt(2) * G_M_S2), rel=1e-6)
    assert found.u_offset == pytest.approx(U_NOISE / np.sqrt(6), rel=1e-6)


def test_stated_uncertainty_is_that_of_many_calibrations():
    draws = 600
    generator = stream(7, "six positions")
    found = [drawn(generator) for _ in range(draws)]
    errors = np.array([parameters(one) for one in found]) - TRUTH
    stated = np.mean([np.sqrt(np.diag(one.covariance)) for one in found], axis=0)
    # 12 standard deviations of 600 draws each: 2.9 % scatter, 4 of it
    assert stated / errors.std(axis=0, ddof=1) == pytest.approx(1, abs=0.12)
    assert np.mean(stated / errors.std(axis=0, ddof=1)) == pytest.approx(1, abs=0.05)
    assert np.mean(np.abs(errors / stated) < 1.96) == pytest.approx(0.95, abs=0.02)
    # χ² of 6 spare readings: mean 6 ± √12/√600
    assert np.mean([one.chi2 for one in found]) == pytest.approx(6, abs=4 * np.sqrt(12 / draws))


def test_noise_that_is_told_by_the_residuals_has_few_degrees_of_freedom():
    generator = stream(8, "six positions")
    found = [drawn(generator, noise_known=False) for _ in range(600)]
    errors = np.array([parameters(one) for one in found]) - TRUTH
    assert all(1 <= one.degrees_of_freedom[-1] < 6.01 for one in found)
    assert found[0].chi2 is None
    inside = [
        np.abs(error)
        < stats.t.ppf(0.975, one.degrees_of_freedom) * np.sqrt(np.diag(one.covariance))
        for error, one in zip(errors, found, strict=True)
    ]
    # two variances of six residuals: few, so intervals are a little wide, and never narrow
    assert 0.94 < np.mean(inside) < 0.98


def test_levelling_is_no_noise_of_the_axis_that_is_upright():
    """Two rounds of six positions, levelled within 0.5°; the noise is not known."""
    generator, u_tilt, draws = stream(11, "six positions"), np.radians(0.5) / np.sqrt(3), 400
    found = []
    for _ in range(draws):
        force = np.concatenate([felt(generator, u_tilt, 0.0) for _ in range(2)])
        read = force @ TRUE_S.T + TRUE_O + generator.normal(0, 0.02, (12, 3))
        found.append(six_position.calibrate(Readings(NAMES * 2, read), taken(G_M_S2, 1e-9)))
    errors = np.array([parameters(one) for one in found]) - TRUTH
    stated = np.median([np.sqrt(np.diag(one.covariance)) for one in found], axis=0)
    ratio = stated / errors.std(axis=0, ddof=1)
    # the scatter of 400 draws is 3.5 %; with levelling as a noise of all, the diagonal had 2.5
    assert ratio[[0, 4, 8]] == pytest.approx([1, 1, 1], abs=0.25)
    assert ratio[9:] == pytest.approx([1, 1, 1], abs=0.15)
    inside = [
        np.abs(error)
        < stats.t.ppf(0.975, one.degrees_of_freedom) * np.sqrt(np.diag(one.covariance))
        for error, one in zip(errors, found, strict=True)
    ]
    assert np.all(np.mean(inside, axis=0) > 0.92)


def test_levelling_cancels_on_the_diagonal():
    read = G_M_S2 * UP
    noise = np.full((6, 3), 1e-9)
    found = six_position.calibrate(
        Readings(NAMES, read, noise), taken(G_M_S2, 1e-9), taken(0, 0.01)
    )
    off = ~np.eye(3, dtype=bool)
    assert found.u_sensitivity[off] == pytest.approx(0.01 / np.sqrt(2), rel=1e-3)
    # what is left is its square
    assert np.diag(found.u_sensitivity) == pytest.approx(0.01**2 / np.sqrt(2), rel=1e-3)


def test_an_error_of_g_scales_all_of_the_sensitivity():
    read = G_M_S2 * UP @ TRUE_S.T + TRUE_O
    noise = np.full((6, 3), 1e-9)
    found = six_position.calibrate(
        Readings(NAMES, read, noise), taken(G_M_S2, 0.01), taken(0, 1e-9)
    )
    # but for the seven digits that a reading has
    assert found.u_sensitivity == pytest.approx(np.abs(TRUE_S) * 0.01 / G_M_S2, rel=1e-3)
    assert found.u_offset == pytest.approx(0, abs=1e-6)


def test_the_uncertainty_of_a_corrected_reading_is_that_of_many_calibrations():
    generator = stream(9, "six positions")
    reading = TRUE_S @ [3.0, 5.0, 7.5] + TRUE_O
    found = [drawn(generator) for _ in range(600)]
    corrected = np.array([one.apply(reading) for one in found])
    stated = np.mean([one.u(reading) for one in found], axis=0)
    assert stated / corrected.std(axis=0, ddof=1) == pytest.approx(1, abs=0.12)


def test_other_poses_verify_by_their_size():
    generator = stream(10, "poses")
    up = generator.normal(size=(8, 3))
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    force = np.concatenate([felt(generator, 0.001, 1e-9), G_M_S2 * up])
    read = force @ TRUE_S.T + TRUE_O + generator.normal(0, U_NOISE, force.shape)
    names = NAMES + tuple(f"pose {number}" for number in range(8))
    found = six_position.calibrate(
        Readings(names, read, np.full_like(read, U_NOISE)), taken(G_M_S2, 1e-3), taken(0, 0.001)
    )
    verifying = [pose for pose in found.poses if not pose.fitted]
    assert len(verifying) == 8
    assert max(abs(pose.before) for pose in verifying) > 0.3
    # eight of them, none beyond four standard uncertainties
    assert all(abs(pose.after) < 4 * pose.u_after for pose in verifying)


def test_a_missing_position_is_named():
    read = G_M_S2 * UP[:5]
    with pytest.raises(InputError, match=r"-z missing.*each of these axes up"):
        six_position.calibrate(Readings(NAMES[:5], read))


def test_a_reading_of_another_number_of_axes_is_refused():
    with pytest.raises(InputError, match="expected 3 in the last dimension"):
        drawn(stream(1, "one")).apply([1.0, 2.0])
