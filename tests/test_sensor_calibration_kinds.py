"""A rate table, known pressures and an ellipsoid recover what a sensor is off by."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware.sensors import ellipsoid, rate_table, still_poses, two_point
from simcompare.hardware.sensors.calibrated import Readings
from simcompare.hardware.sensors.calibration import Taken
from simcompare.hardware.sensors.six_position import POSITIONS
from simcompare.statistics.distributions import normal
from simcompare.statistics.streams import stream

G_M_S2 = 9.80665
RATES = np.array([k * np.eye(3)[a] for a in range(3) for k in (-3.5, -1, 1, 3.5)] + [[0.0] * 3] * 3)
#: directions to the faces, edges and corners of a cube
SPREAD = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
SPREAD /= np.linalg.norm(SPREAD, axis=1, keepdims=True)
TRUE_S = np.eye(3) + np.array([[0.02, 0.01, -0.015], [0.01, -0.03, 0.004], [-0.015, 0.004, 0.01]])
TRUE_O = np.array([0.5, -0.4, 0.8])
TRUTH = np.concatenate([TRUE_S.ravel(), TRUE_O])


def named(means: np.ndarray, u: float | None) -> Readings:
    names = tuple(f"pose {number}" for number in range(len(means)))
    return Readings(names, means, None if u is None else np.full_like(means, u))


def summary(found: list) -> tuple[np.ndarray, float]:
    """Stated over observed uncertainty of each parameter, and the part of 95 % intervals."""
    errors = np.array([np.r_[one.sensitivity.ravel(), one.offset] for one in found]) - TRUTH
    stated = np.array([np.sqrt(np.diag(one.covariance)) for one in found])
    covered = np.mean(np.abs(errors) < 1.96 * stated)
    return stated.mean(axis=0) / errors.std(axis=0, ddof=1), float(covered)


def on_the_table(generator: np.random.Generator):
    scale, alignment = Taken(normal(0, 5e-4)), Taken(normal(0, 5e-3))
    axes = np.eye(3) + generator.normal(0, alignment.known.u, (3, 3)) * (1 - np.eye(3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    acting = RATES @ axes * (1 + generator.normal(0, scale.known.u))
    acting = acting + rate_table.EARTH.known.draw(generator, 3)
    read = acting @ TRUE_S.T + TRUE_O + generator.normal(0, 2e-4, acting.shape)
    return rate_table.calibrate(named(read, 2e-4), RATES, scale, alignment)


def on_the_ellipsoid(generator: np.random.Generator):
    acting = generator.normal(G_M_S2, 0.002) * SPREAD
    read = acting @ TRUE_S.T + TRUE_O + generator.normal(0, 0.004, acting.shape)
    return ellipsoid.calibrate(named(read, 0.004), Taken(normal(G_M_S2, 0.002)))


@pytest.mark.parametrize("calibrated", [on_the_table, on_the_ellipsoid])
def test_stated_uncertainty_is_that_of_many_calibrations(calibrated):
    generator = stream(3, calibrated.__name__)
    ratio, covered = summary([calibrated(generator) for _ in range(250)])
    # 250 draws scatter by 4.5 %, 4 of it; over 12 parameters a third of that
    assert ratio == pytest.approx(1, abs=0.18)
    assert np.mean(ratio) == pytest.approx(1, abs=0.06)
    assert covered == pytest.approx(0.95, abs=0.02)


def test_a_rotation_in_the_box_is_seen_by_six_positions_and_not_by_the_ellipsoid():
    angle = 0.05
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    straight, turned = (
        ellipsoid.calibrate(named(G_M_S2 * SPREAD @ s.T, 1e-6), Taken(normal(G_M_S2, 1e-6)))
        for s in (np.eye(3), turn)
    )
    assert turned.sensitivity == pytest.approx(straight.sensitivity, abs=1e-9)
    assert any("rotation" in sentence for sentence in straight.not_separable)


def test_poses_of_an_ellipsoid_that_are_missing_are_named():
    flat = G_M_S2 * np.array([[np.cos(a), np.sin(a), 0] for a in range(12)])
    with pytest.raises(InputError, match="turn z up and down"):
        ellipsoid.calibrate(named(flat, 0.01))
    with pytest.raises(InputError, match="6 still poses; expected 9 or more"):
        ellipsoid.calibrate(named(G_M_S2 * np.array(list(POSITIONS.values())), 0.01))
    doubled = np.repeat(G_M_S2 * np.array(list(POSITIONS.values())), 2, axis=0)
    with pytest.raises(InputError, match="half way between x and y"):
        ellipsoid.calibrate(named(doubled, 0.01))


def test_a_rate_that_was_not_turned_is_named():
    with pytest.raises(InputError, match=r"\+z missing: turn it that way about z"):
        rate_table.calibrate(named(RATES[:10], 1e-3), RATES[:10])


def test_two_pressures_tell_sensitivity_and_offset():
    pressures = [normal(95_000, 8), normal(101_000, 6)]
    read = np.array([[1.002 * one.center + 80] for one in pressures])
    found = two_point.calibrate(Readings(("low", "high"), read, np.full((2, 1), 2.0)), pressures)
    assert found.sensitivity[0, 0] == pytest.approx(1.002, abs=1e-12)
    assert found.offset[0] == pytest.approx(80, abs=1e-6)
    # S = (Y2 - Y1)/(p2 - p1), by hand
    u = np.sqrt(2 * 2.0**2 + 1.002**2 * (8**2 + 6**2)) / 6000
    assert found.u_sensitivity[0, 0] == pytest.approx(u, rel=1e-9)
    # between the two points a corrected reading is as good as their mean
    middle = found.u(np.array([[read.mean()]]))[0, 0]
    assert middle == pytest.approx(np.sqrt(8**2 + 6**2 + 2 * 2**2 / 1.002**2) / 2, rel=1e-9)
    assert found.expected_chi2 == 0


def test_two_pressures_need_a_known_noise():
    pressures = [normal(95_000, 8), normal(101_000, 6)]
    read = np.array([[one.center] for one in pressures])
    with pytest.raises(InputError, match="two readings cannot tell their own noise"):
        two_point.calibrate(Readings(("low", "high"), read), pressures)
    with pytest.raises(InputError, match="all known pressures are the same"):
        two_point.calibrate(Readings(("a", "b"), read, np.ones((2, 1))), [pressures[0]] * 2)


def recorded(ups: np.ndarray, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Six seconds in each pose and one second of shaking between them, at 100 Hz."""
    parts = []
    for up in ups:
        parts += [np.tile(G_M_S2 * up, (600, 1)), G_M_S2 * up + generator.normal(0, 3, (100, 3))]
    force = np.concatenate(parts)
    return np.arange(len(force)) / 100, force + generator.normal(0, 0.02, force.shape)


def test_still_poses_are_found_between_motions():
    ups = np.array([*POSITIONS.values(), SPREAD[0]])
    found = still_poses.find(*recorded(ups, stream(4, "still")))
    readings = still_poses.readings_of(found)
    assert readings.names == (*POSITIONS, "pose 7")
    # 0.02 m/s² over 5 s at 100 Hz: 0.9 mm/s² each, 5 of it
    assert readings.means == pytest.approx(G_M_S2 * ups, abs=0.005)
    assert readings.u == pytest.approx(0.02 / np.sqrt(500), rel=0.35)
    assert readings.degrees_of_freedom > 50


def test_a_recording_that_never_rests_has_no_still_pose():
    time_s = np.arange(2000) / 100
    shaken = stream(5, "shaken").normal(0, 3, (2000, 3))
    with pytest.raises(InputError, match="none was found; let the sensor lie still"):
        still_poses.find(time_s, shaken)
