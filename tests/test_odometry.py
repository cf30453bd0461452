"""The estimator odometry: what it is given, what it tells, and how the answer is said."""

import math

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.estimation import estimators
from simcompare.estimation.dead_reckoning import Wheels, from_counts
from simcompare.estimation.estimate import Given, Signal
from simcompare.verbs.estimate import estimate

pytestmark = pytest.mark.usefixtures("one_motion")
TIME = np.linspace(0, 5, 101)
OPTIONS = {"radius_m": 0.03, "track_m": 0.1, "marks": 500, "u_radius_m": 1e-4, "u_track_m": 1e-3}


def given(larger=0.01, **options):
    """A robot whose right wheel is larger than odometry believes, on an arc."""
    left, right = 5 * TIME, 5.5 * TIME
    counts = [np.floor(a * 500 / (2 * math.pi)) for a in (left, right)]
    truth = from_counts(
        TIME, tuple(a * 500 / (2 * math.pi) for a in (left, right)), 500,
        Wheels(0.03, 0.03 * (1 + larger), 0.1),
    ).pose  # fmt: skip
    signals = {"left_marks": Signal(TIME, counts[0]), "right_marks": Signal(TIME, counts[1])}
    place = {n: Signal(TIME, truth[:, k]) for k, n in enumerate(("x", "y", "heading"))}
    return Given(signals, place, {**OPTIONS, **options})


def apply(what):
    return estimators.apply(estimators.load("odometry"), what)


def test_it_tells_the_drift_with_its_uncertainty():
    found = apply(given())
    way = 0.03 * 5 * 5 * (1 + 1.1 * 1.01) / 2
    assert found.numbers["path_length"].value == pytest.approx(way, rel=1e-3)
    turned = 0.03 * 5.5 * 5 * 0.01 / 0.1
    assert found.numbers["end_turn"].value == pytest.approx(-turned, abs=0.005)  # a mark: 4 mrad
    # two radii of 0.1 mm over 25 and 27.5 rad, the track of 1 % on a turn, and the counting
    u = math.hypot(1e-4 * math.hypot(25, 27.5) / 0.1, 0.01 * 0.03 * 2.5 / 0.1)
    assert found.numbers["end_turn"].u == pytest.approx(u, rel=0.03)
    drift = found.best.states["drift_m"]
    assert found.numbers["end_drift"].value == pytest.approx(drift.values[-1])
    assert drift.rms_error == pytest.approx(math.sqrt(np.mean(drift.values**2)))
    assert list(found.labels) == ["drift_m", "x_m", "y_m", "heading_rad"]


def test_the_corrected_ratio_leaves_the_counting_alone():
    found = apply(given(larger=0.01, right_larger=0.01))
    mark = 2 * math.pi * 0.03 / 500
    # a mark of a wheel turns the robot by 4 mrad, on 0.8 m
    assert found.numbers["end_drift"].value < mark + 0.8 * mark / 0.1


def test_rates_may_take_the_place_of_marks():
    counted = apply(given())
    rates = {
        "left_rate": Signal(TIME, np.full(101, 5.0)), "right_rate": Signal(TIME, np.full(101, 5.5)),
    }  # fmt: skip
    found = apply(Given(rates, given().truth, OPTIONS))
    apart = found.best.states["x_m"].values[-1] - counted.best.states["x_m"].values[-1]
    assert abs(apart) < 0.002


def test_without_a_truth_there_is_a_path_and_no_drift():
    found = apply(Given(given().signals, {}, OPTIONS))
    assert "drift_m" not in found.labels
    assert list(found.numbers) == ["path_length"]


def test_the_region_of_the_end_is_a_line_about_it():
    found = apply(given())
    border = found.ways[1].states
    assert np.mean(border["x_m"].values[:-1]) == pytest.approx(
        found.best.states["x_m"].values[-1], abs=1e-9
    )


def test_wheels_that_are_not_given_are_missed():
    with pytest.raises(InputError, match="expected left_marks and right_marks"):
        apply(Given({"left_marks": Signal(TIME, TIME)}, {}, OPTIONS))


def test_the_answer_tells_how_far_and_whether_that_is_explained():
    found = estimate("robot_line", estimator="odometry", engine="mujoco", draws=2)
    text = " ".join(found.sentences)
    assert "After 1 m odometry ends 21" in text
    assert "That is 1.2 standard uncertainties: what is not known of wheels, track, start" in text
    assert found.plot("path") is not None
    assert "Across ± u (mm)" in found.table().columns


def test_better_callipers_show_that_the_wheels_are_unequal():
    options = {"u_radius_m": 1e-5, "u_track_m": 1e-4}
    found = estimate("robot_line", estimator="odometry", engine="mujoco", draws=1, options=options)
    assert "start and counting does not explain it" in " ".join(found.sentences)
