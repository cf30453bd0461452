"""Dead reckoning: exact arcs, its uncertainty against random phases, its drift in closed form."""

import math
from dataclasses import replace

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.estimation import dead_reckoning_errors
from simcompare.estimation.dead_reckoning import SYSTEMATIC, Wheels, from_counts, from_rates
from simcompare.estimation.drift import drift, ellipse
from simcompare.hardware.sensors import odometer

WHEELS = Wheels(0.0325, 0.033, 0.12)
#: of a whole turn, for few marks
MARKS = 20


def angles(time_s, factor=1.0):
    """Two wheels that wander; the robot turns left, and its rates change all the time."""
    return factor * (4 * time_s + np.sin(time_s)), factor * (5 * time_s - 1.5 * np.sin(time_s))


def counted(pair, phases=(0.0, 0.0), marks=MARKS):
    per_rad = marks / (2 * math.pi)
    return tuple(np.floor(a * per_rad + p) for a, p in zip(pair, phases, strict=True))


def exact(time_s, pair, wheels=WHEELS):
    """Poses by dead reckoning of what was not counted."""
    rolled = pair[0] * wheels.left_radius_m, pair[1] * wheels.right_radius_m
    return odometer.poses(odometer.arcs(*rolled, wheels.track_m))


def test_a_circle_is_exact_from_two_samples():
    turn, radius = 1.3, 0.4
    ways = [np.array([0.0, turn * (radius + side * 0.06)]) for side in (-1, 1)]
    pose = odometer.poses(odometer.arcs(*ways, 0.12))[-1]
    expected = (radius * math.sin(turn), radius * (1 - math.cos(turn)), turn)
    np.testing.assert_allclose(pose, expected, atol=1e-15)


def test_more_samples_of_a_circle_change_nothing():
    time_s = np.linspace(0, 3, 301)
    few = exact(time_s[::300], (3 * time_s[::300], 5 * time_s[::300]))
    many = exact(time_s, (3 * time_s, 5 * time_s))
    np.testing.assert_allclose(few[-1], many[-1], atol=1e-13)


def test_a_start_elsewhere_turns_and_shifts_the_path():
    time_s = np.linspace(0, 3, 31)
    here = from_counts(time_s, counted(angles(time_s)), MARKS, WHEELS)
    there = from_counts(time_s, counted(angles(time_s)), MARKS, WHEELS, (2.0, -1.0, 0.7))
    c, s = math.cos(0.7), math.sin(0.7)
    turned = here.pose[:, :2] @ np.array([[c, s], [-s, c]]) + (2.0, -1.0)
    np.testing.assert_allclose(there.pose[:, :2], turned, atol=1e-14)
    np.testing.assert_allclose(there.pose[:, 2], here.pose[:, 2] + 0.7, atol=1e-14)


def test_sensitivities_are_what_differences_say():
    time_s, step = np.linspace(0, 6, 31), 1e-6
    counts = counted(angles(time_s))
    found = from_counts(time_s, counts, MARKS, WHEELS, (0.0, 0.0, 0.3)).sensitivity
    for k, name in enumerate(SYSTEMATIC):
        low, high = (
            from_counts(
                time_s, counts, MARKS, replace(WHEELS, **{name: getattr(WHEELS, name) + s}),
                (0.0, 0.0, 0.3),
            ).pose
            for s in (-step, step)
        )  # fmt: skip
        # central differences are off by the third derivative times step², some 1e-7 here
        np.testing.assert_allclose(found[:, :, k], (high - low) / (2 * step), atol=1e-6)


def test_what_counting_leaves_open_is_what_random_phases_scatter():
    time_s = np.linspace(0, 6, 31)
    generator = np.random.default_rng(1)
    errors, stated = [], []
    for _ in range(3000):
        # another phase of each wheel's marks, and a way that differs by some marks
        pair = angles(time_s, generator.uniform(0.9, 1.1))
        found = from_counts(time_s, counted(pair, generator.uniform(size=2), 100), 100, WHEELS)
        errors.append((found.pose - exact(time_s, pair))[[10, 20, 30]])
        stated.append(found.u[[10, 20, 30]] ** 2)
    scatter = np.sqrt(np.mean(np.square(errors), axis=0))
    stated = np.sqrt(np.mean(stated, axis=0))
    # 3000 draws tell a standard deviation to 1.3 %; what could be alike is on the safe side
    assert np.all((scatter > 0.92 * stated) & (scatter < 1.03 * stated))


def square(side_m, step_m):
    """Ways of both wheels around a square at even speeds, turning on the spot at the corners."""
    quarter = math.pi / 2 * 0.12 / 2
    sides, turns = int(side_m / step_m), int(quarter / step_m * 5)
    leg = [(side_m / sides,) * 2] * sides + [(-quarter / turns, quarter / turns)] * turns
    return np.vstack(((0.0, 0.0), np.cumsum(leg * 4, axis=0))).T


@pytest.mark.parametrize(("marks", "step_m"), [(20_000, 1e-3), (576, 1e-3), (200, 3e-4)])
def test_at_even_speed_the_errors_of_counting_beat_and_are_covered(marks, step_m):
    """Samples meet the marks at the same places for long, so that errors do not average out."""
    generator, wheels = np.random.default_rng(8), Wheels(0.03, 0.03, 0.12)
    apart = []
    for number in range(80):
        # half of them turn by a whole number of marks in each step of a corner
        step = step_m * (1.0 if number % 2 else generator.uniform(0.9, 1.1))
        pair = square(generator.uniform(0.4, 0.6), step) / 0.03
        time_s = np.arange(pair.shape[1]) * 0.01
        found = from_counts(time_s, counted(pair, generator.uniform(size=2), marks), marks, wheels)
        apart.append((found.pose[-1, :2] - exact(time_s, pair, wheels)[-1, :2]) / found.u[-1, :2])
    # 80 draws of two coordinates: 95 % ± 1.7 %
    assert np.mean(np.abs(apart) < 1.96) > 0.9


def test_a_heading_from_counts_is_as_uncertain_after_a_second_as_after_a_minute():
    time_s = np.linspace(0, 60, 601)
    u = from_counts(time_s, counted((5 * time_s, 5 * time_s)), MARKS, Wheels(0.03, 0.03, 0.12)).u
    # two wheels, each a triangle of one mark: u = √2·r·2π/(n·√6)/W, whatever the time
    expected = math.sqrt(2) * 0.03 * 2 * math.pi / MARKS / math.sqrt(6) / 0.12
    np.testing.assert_allclose(u[1:, 2], expected, rtol=1e-9)


def test_more_samples_than_marks_do_not_make_odometry_more_certain():
    coarse, fine = np.linspace(0, 6, 31), np.linspace(0, 6, 3001)
    u = [from_counts(t, counted(angles(t)), MARKS, WHEELS).u[-1] for t in (coarse, fine)]
    # the start's count is what turns the path, and it is one in both
    np.testing.assert_allclose(u[1], u[0], rtol=0.1)


def test_systematic_errors_grow_with_the_way_and_noise_with_its_root():
    time_s = np.linspace(0, 40, 401)
    rates = (np.full(401, 5.0), np.full(401, 5.0))
    sure = from_rates(time_s, rates, Wheels(0.03, 0.03, 0.12, 1e-4, 1e-4, correlation=1.0))
    noisy = from_rates(time_s, rates, Wheels(0.03, 0.03, 0.12), u_rad_s=0.1)
    assert sure.u[400, 0] == pytest.approx(4 * sure.u[100, 0], rel=1e-9)
    assert noisy.u[400, 0] == pytest.approx(2 * noisy.u[100, 0], rel=1e-9)
    # both radii wrong by one calliper: the robot believes to drive straight, and does
    assert sure.u[400, 0] == pytest.approx(40 * 5 * 1e-4, rel=1e-9)
    assert sure.u[400, 2] == pytest.approx(0, abs=1e-12)


def test_noise_of_rates_is_what_draws_scatter():
    time_s, generator = np.linspace(0, 5, 51), np.random.default_rng(3)
    rates = (4 + np.cos(time_s), 5 - 1.5 * np.cos(time_s))
    wheels, u = Wheels(0.0325, 0.0325, 0.12), 0.2
    found = from_rates(time_s, rates, wheels, u_rad_s=u)
    ends = [
        from_rates(time_s, tuple(r + generator.normal(0, u, 51) for r in rates), wheels).pose[-1]
        for _ in range(2000)
    ]
    # 2000 draws tell a standard deviation to 1.6 %; both ends of 51 rates serve half a step only
    np.testing.assert_allclose(np.std(ends, axis=0), found.u[-1], rtol=0.06)


def test_95_percent_ellipses_cover_95_percent_of_robots():
    time_s, generator = np.linspace(0, 6, 31), np.random.default_rng(5)
    believed = Wheels(0.0325, 0.0325, 0.12, 1e-4, 1e-4, 1e-3)
    inside = 0
    for _ in range(2000):
        left, right, track = generator.multivariate_normal(
            (0.0325, 0.0325, 0.12), believed.covariance
        )
        truth = Wheels(left, right, track)
        pair = angles(time_s, generator.uniform(0.9, 1.1))
        found = from_counts(time_s, counted(pair, generator.uniform(size=2), 576), 576, believed)
        apart = found.pose[-1, :2] - exact(time_s, pair, truth)[-1, :2]
        chi2 = apart @ np.linalg.solve(found.covariance[-1, :2, :2], apart)
        inside += chi2 <= 5.991  # 95 % of χ² with two degrees of freedom
    assert 0.93 < inside / 2000 < 0.97  # the bar of the job; sampling alone is ±0.5 %


def test_believing_equal_wheels_drifts_as_the_closed_forms_say():
    larger, track, way = 0.005, 0.12, 1.0
    time_s = np.linspace(0, 5, 51)
    turned = time_s / 5 * way / 0.0325
    truth = exact(time_s, (turned, turned), Wheels(0.0325, 0.0325 * (1 + larger), track))
    equal = Wheels(0.0325, 0.0325, track)
    found = from_rates(time_s, (np.gradient(turned, time_s),) * 2, equal)
    off = drift(found, truth[:, :2], truth[:, 2])
    bend = larger * way / track
    # the scale is wrong by half of it, along; an arc is shorter than its length by bend²/6 of it
    assert off.along_m[-1] == pytest.approx(-larger / 2 * way + way * bend**2 / 6, rel=2e-3)
    # ½·v·ω_b·t² across, to the order of bend²/12 and of the scale
    assert off.across_m[-1] == pytest.approx(-bend * way / 2, rel=3e-3)
    assert off.heading_rad[-1] == pytest.approx(-bend, rel=1e-9)
    distance = math.hypot(off.along_m[-1], off.across_m[-1])
    # the chords between samples are shorter than the arcs, by 3e-8
    assert off.per_metre == pytest.approx(distance / (1 + larger / 2), rel=1e-6)


def test_a_drift_has_the_uncertainty_of_both_places():
    time_s = np.linspace(0, 5, 51)
    rates = (np.full(51, 5.0),) * 2
    found = from_rates(time_s, rates, Wheels(0.03, 0.03, 0.12, 1e-4, 1e-4, correlation=1.0))
    off = drift(found, found.pose[:, :2] + (0.003, 0.0), u_place_m=0.002)
    assert off.u_along_m[-1] == pytest.approx(math.hypot(25 * 1e-4, 0.002))
    assert off.u_across_m[-1] == pytest.approx(0.002)
    assert off.u_distance_m[-1] == pytest.approx(off.u_along_m[-1])


def test_the_ellipse_is_that_of_chi_squared():
    border = ellipse(np.diag([4.0, 1.0]))
    # χ² with two degrees of freedom: 95 % within 5.991
    assert np.ptp(border[:, 0]) == pytest.approx(2 * 2 * math.sqrt(5.991), rel=1e-3)
    assert np.ptp(border[:, 1]) == pytest.approx(2 * math.sqrt(5.991), rel=1e-3)


def test_impossible_wheels_are_refused_all_at_once():
    with pytest.raises(InputError) as caught:
        Wheels(0.0, 0.03, -1.0, u_track_m=-1.0, correlation=2.0)
    assert [f.split()[0] for f in caught.value.faults] == [
        "left_radius_m", "track_m", "u_track_m", "correlation",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("time_s", "left", "says"),
    [
        ([0.0, 1.0], [0.0, 1.0, 2.0], "expected \\(n,\\) of all"),
        ([0.0], [0.0], "n > 1"),
        ([0.0, 1.0], [0.0, math.nan], "not finite"),
        ([1.0, 1.0], [0.0, 1.0], "do not increase"),
    ],
)
def test_counts_that_cannot_be_reckoned_with_are_refused(time_s, left, says):
    with pytest.raises(InputError, match=says):
        from_counts(np.array(time_s), (np.array(left), np.array(left)), MARKS, WHEELS)


def test_no_marks_are_refused():
    time_s = np.array([0.0, 1.0])
    with pytest.raises(InputError, match="0 in a turn"):
        from_counts(time_s, (time_s, time_s), 0, WHEELS)


def test_the_slope_of_the_chord_joins_its_series():
    x = np.array([0.999e-3, 1.001e-3])
    slope = dead_reckoning_errors.sinc_slope(x)
    np.testing.assert_allclose(slope, -x / 3, rtol=1e-6)


def test_a_start_that_points_wrongly_turns_the_whole_path():
    time_s, counts = np.linspace(0, 6, 31), counted(angles(np.linspace(0, 6, 31)))
    here = from_counts(time_s, counts, MARKS, WHEELS, u_start=(0.001, 0.002, 1e-4))
    turned = from_counts(time_s, counts, MARKS, WHEELS, (0.0, 0.0, 1e-4))
    moved = turned.pose[-1] - here.pose[-1]
    expected = np.hypot(moved, (0.001, 0.002, 0.0))
    np.testing.assert_allclose(np.sqrt(np.diag(here.by_start[-1])), expected, rtol=1e-4)
