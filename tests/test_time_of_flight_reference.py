"""The range sensor on a cart: its closed form against our rays, and its measure."""

import math

import numpy as np
import pytest

from simcompare.engine.sensing import complete
from simcompare.engine.simulation import sample_times
from simcompare.measures import Request, range_picture
from simcompare.model.trajectory import Trajectory
from simcompare.scenarios import catalogue
from simcompare.scenarios.time_of_flight import reference as looking

CHANGES = [
    {},
    {"wall_turn_rad": -0.5, "height_m": 0.4, "speed_m_s": 0.1},
    {"wall_m": 3.5, "ball_radius_m": 0.03, "height_m": 0.9},
]


def scene(**changes):
    return catalogue.load("time_of_flight").resolve(changes)


def truth_of(scenario):
    times = sample_times(scenario)
    return Trajectory("closed form", times, looking.reference(scenario.parameters, times))


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_agrees_with_rays_that_are_cast_on_the_shapes(changes):
    scenario = scene(**changes)
    truth = truth_of(scenario)
    cast = {name: truth.signals[name] for name in ("way.position_m", "way.velocity_m_s")}
    complete(scenario, truth.time_s, cast, {})
    np.testing.assert_allclose(cast["eye.range_m"], truth.signals["eye.range_m"], atol=1e-9)


def test_each_thing_is_seen_where_it_is():
    start = truth_of(scene()).signals["eye.range_m"][0].reshape(8, 8)
    # the floor fills the last rows, at h/tan of their angles
    for row in (6, 7):
        wanted = 0.15 / math.tan(math.radians(5.625 * (row - 3.5)))
        np.testing.assert_allclose(start[row], wanted, atol=1e-12)
    assert (np.argwhere(start[:4] < 0.82)[:, 1] <= 2).all()  # the ball: above, on the left
    crate = np.argwhere(np.isclose(start, 0.95))
    assert crate.tolist() == [[3, 6], [3, 7], [4, 6], [4, 7], [5, 6], [5, 7]]  # on the right
    assert (np.diff(start[0]) > 0).all()  # the wall's left side is nearer


def test_beyond_its_reach_it_reads_its_reach():
    far = looking.ranges(
        {"wall_m": 9.0, "wall_turn_rad": 0.0, "height_m": 0.15, "ball_radius_m": 0.1},
        np.array([[0.0, 0.0, 0.15]]),
    )
    assert far.max() == 4.0


# --- its measure ----------------------------------------------------------------------------------


def measured(pictures, count=3):
    run = Trajectory("mine", np.arange(len(pictures)) * 0.1, {"eye.range_m": pictures})
    probe = scene().probes["range_m"]
    return range_picture.measure(run, Request(probe, {}, {"count": count}))


def test_the_picture_is_judged_by_its_worst_zone_and_by_how_many_are_wrong():
    true = np.full((5, 64), 2.0)
    seen = true.copy()
    seen[2, 7], seen[4, 0] = 2.5, 1.995
    pairs = range_picture.against(measured(seen), measured(true))
    assert pairs["range_error"] == (0.5, 0.0)
    assert pairs["share_of_wrong_readings"] == (1 / (3 * 64), 0.0)
    assert pairs["nearest"] == (1.995, 2.0)
    np.testing.assert_allclose(measured(seen).series["nearest_range"], [2, 2, 1.995])


def test_pictures_of_other_instants_are_not_compared():
    pairs = range_picture.against(measured(np.ones((5, 64))), measured(np.ones((9, 64))))
    assert pairs["range_error"] == (None, 0.0)
    assert pairs["share_of_wrong_readings"] == (None, 0.0)
