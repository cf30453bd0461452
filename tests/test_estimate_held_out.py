"""Filters say how far they err: on draws, voltages and walls that no setting was chosen by.

The pages print that filters are consistent. Here that is asked again of every engine, with other
seeds than the pages have, and at other voltages.
"""

from __future__ import annotations

import pytest
from scipy.stats import chi2

import simcompare

from .present import INSTALLED

SPATIAL = [name for name in ("dart", "mujoco", "ode", "pybullet", "rapier") if name in INSTALLED]
DRAWS = 10
#: so seldom does a right filter miss these bands, of which there are two dozen here
MISSED = 1e-3


def band(degrees_of_freedom, count):
    """Limits of the mean of so many independent χ² values; a draw is one, its instants are not."""
    of_all = chi2(degrees_of_freedom * count)
    return of_all.ppf(MISSED / 2) / count, of_all.ppf(1 - MISSED / 2) / count


def consistent(one):
    low, high = band(one.nees.degrees_of_freedom, DRAWS)
    return low < one.nees.value < high


@pytest.mark.parametrize("name", SPATIAL)
@pytest.mark.parametrize("estimator", ["speed_filter", "pose_filter"])
def test_a_robot_that_drives_straight_is_told_as_well_as_its_filter_says(name, estimator):
    found = simcompare.estimate(
        "robot_motor", estimator=estimator, engine=name, draws=DRAWS, seed=7
    )  # fmt: skip
    (one,) = found.done
    assert consistent(one), one.nees
    # of MuJoCo's caster, which lifts and lands, the accelerometer feels a quarter more than noise
    assert one.nis.value == pytest.approx(one.nis.degrees_of_freedom, rel=0.25)
    for reading in one.readings:
        assert abs(reading.whiteness.lag_1) < 0.2, reading


@pytest.mark.parametrize("name", SPATIAL[:1])
@pytest.mark.parametrize("estimator", ["speed_filter", "pose_filter"])
@pytest.mark.parametrize("voltage_V", [1.2, 3.0])
def test_that_holds_at_other_voltages(name, estimator, voltage_V):
    found = simcompare.estimate(
        "robot_motor", estimator=estimator, engine=name, draws=DRAWS, seed=8,
        set={"voltage_V": voltage_V},
    )  # fmt: skip
    assert consistent(found.done[0]), found.done[0].nees


@pytest.mark.parametrize("name", SPATIAL[:1])
@pytest.mark.parametrize(("left_V", "right_V", "wall_m"), [(3.2, 2.9, 0.8), (1.5, 1.8, 2.0)])
def test_that_holds_in_other_curves_before_other_walls(name, left_V, right_V, wall_m):
    parameters = {"left_voltage_V": left_V, "right_voltage_V": right_V, "wall_m": wall_m}
    found = simcompare.estimate("robot_wall", engine=name, draws=DRAWS, seed=9, set=parameters)
    (one,) = found.done
    assert consistent(one), one.nees
    # also what is told once the drive is over: of each state the error is what its u says, on
    # average over draws and instants. 10 draws tell a u to a quarter, and errors last for a drive
    for way in ("filtered", "smoothed"):
        for state in one.labels:
            error = one.error_of(way, state)
            if error.rms_error is not None:
                assert error.rms_error < 2 * error.u, (way, state)
