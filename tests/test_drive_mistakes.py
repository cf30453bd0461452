"""Mistakes in what is said of two wheels: each alone is told as itself, a right log never is."""

import math
from dataclasses import replace

import numpy as np
import pytest

from simcompare.hardware.sensors import odometer
from simcompare.hardware.sensors.drive_mistakes import (
    MISSES,
    Cures,
    Driven,
    misfit,
    suspected,
)

CURES = Cures(
    exchange="exchange",
    sign=lambda side: f"sign of {side}",
    track_m=lambda value: f"track {value:.3g}",
    radius_m=lambda value: f"radius {value:.3g}",
    heading_rad=lambda value: f"heading {value:.2f}",
)


def driven(seed, *, lively=False, own_start=True):
    """A drive of 20 s, its wheels not quite alike, with slip, and a survey with noise."""
    g = np.random.default_rng(seed)
    time_s = np.arange(0, 20, 0.1)

    def wave():
        parts = zip(
            g.uniform(0.1, 0.6, 3), g.uniform(0.05, 1.2, 3), g.uniform(0, 6.3, 3), strict=True
        )
        return sum(a * np.sin(w * time_s + p) for a, w, p in parts) / 2

    track, swing = g.uniform(0.1, 0.6), 1.5 if lively else g.uniform(0.3, 1.5)
    turn = wave() * swing + (0.6 if lively else 0.0)
    speed = g.uniform(0.1, 1.5) * (1 + 0.5 * wave())
    ways = [
        np.concatenate(([0.0], np.cumsum((v[1:] + v[:-1]) / 2 * 0.1)))
        for v in (speed - turn * track / 2, speed + turn * track / 2)
    ]
    start = (*g.uniform(-5, 5, 2), g.uniform(-3, 3))
    place = odometer.poses(odometer.arcs(*ways, track, start[2]), start)[:, :2]
    told = [w * (1 + g.normal(0, 0.003)) + np.cumsum(g.normal(0, 4e-4, len(w))) for w in ways]
    began = (*start[:2], start[2] + g.normal(0, 0.02)) if own_start else None
    place = place + g.normal(0, 0.005, place.shape)
    track *= 1 + g.normal(0, 0.01)
    return Driven(*told, track, place, 0.05, began, u_heading_rad=0.02)


def headed(one, by_rad):
    x, y, heading = one.start
    return replace(one, start=(x, y, heading + by_rad))


FAULTS = {
    "exchange": lambda d: replace(d, left_m=d.right_m, right_m=d.left_m),
    "sign of left": lambda d: replace(d, left_m=-d.left_m),
    "sign of right": lambda d: replace(d, right_m=-d.right_m),
    "track": lambda d: replace(d, track_m=d.track_m / 2),
    "radius": lambda d: replace(d, left_m=d.left_m / 2.4, right_m=d.right_m / 2.4),
    "heading": lambda d: headed(d, math.pi),
}


@pytest.mark.parametrize("own_start", [True, False])
def test_a_right_log_is_never_suspected(own_start):
    drives = [driven(seed, own_start=own_start) for seed in range(100)]
    # some of them stray so far that mistakes are looked for at all
    assert sum(misfit(one) > MISSES * one.length_m for one in drives) > 0
    assert [suspected(one, CURES) for one in drives] == [None] * 100


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_told_as_what_it_is(fault):
    for seed in range(3):
        found = suspected(FAULTS[fault](driven(seed, lively=True)), CURES)
        assert found is not None, seed
        assert found.cures[0].startswith(fault), (seed, found)
        assert found.before > 3 * found.after


def test_two_faults_are_told_where_none_alone_explains():
    both = FAULTS["track"](FAULTS["exchange"](driven(0, lively=True)))
    found = suspected(both, CURES)
    assert found is not None
    assert [cure.split()[0] for cure in found.cures] == ["exchange", "track"]


def test_a_heading_is_found_to_be_off_by_any_angle():
    one = driven(1, lively=True)
    found = suspected(headed(one, math.radians(-40)), CURES)
    assert found is not None
    turned = float(found.cures[0].split()[1]) - one.start[2]
    # 0.1 rad: the first heading is drawn with 0.02 rad, and unequal wheels bend the path
    assert math.remainder(turned, 2 * math.pi) == pytest.approx(0, abs=0.1)
