"""Samples of a video go to the flights of one fitted motion; what is left out has its reason."""

import numpy as np
import pytest

from simcompare.fitting.bounces import arcs
from simcompare.fitting.bounces.bounce_models import MODELS, bounces
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.following import HELD, NOT_SEEN, TOO_LOW
from tests.bounces import filmed_samples

CORK = {"restitution": 0.6, "drop_height_m": 0.6, "release_time_s": 0.2}
FOAM = {"restitution": 0.74, "exponent": 0.03, "terminal_speed_m_s": 14.0, "drop_height_m": 0.9,
        "release_time_s": 0.2}  # fmt: skip
SEEDS = range(5)


def reasons(drop):
    return {one.reason for one in drop.dropped}


def misplaced(drop, values):
    """Samples that are not in the flight in which they were filmed."""
    impacts = bounces(MODELS["power"], values, 40).impact_s
    return int(np.sum(np.searchsorted(impacts, drop.track.time_s) != drop.track.flight))


def flies(time, values):
    """Samples of flights that last for four frames of 30 a second."""
    found = bounces(MODELS["power"], values, 40)
    high = found.apex_m[np.searchsorted(found.impact_s, time)] > 0.018
    return high & (time > values["release_time_s"])


@pytest.mark.parametrize("values", [CORK, FOAM])
@pytest.mark.parametrize("stated", [True, False])
def test_samples_of_late_flights_are_in_their_flights_and_all_are_used(values, stated):
    for seed in SEEDS:
        time, height = filmed_samples(values, seconds=2.0, seed=seed)
        drop = arcs.from_heights(time, height, 3e-3 if stated else None)
        # a frame within a millisecond of an impact may be on either side of it
        assert misplaced(drop, values) <= 1
        assert reasons(drop) <= {HELD, TOO_LOW, NOT_SEEN}
        assert len(drop.track.time_s) >= np.sum(flies(time, values)) - 4


def test_the_true_law_is_never_excluded_and_nothing_is_off():
    z, chi2, dof = [], 0.0, 0
    for seed in range(25):
        time, height = filmed_samples(CORK, seconds=2.0, seed=seed)
        found = fit(arcs.from_heights(time, height, 3e-3), "constant", profiles=False)
        z += [(found.values[k] - CORK[n]) / found.u[k] for k, n in enumerate(found.names[:2])]
        chi2, dof = chi2 + found.chi2, dof + found.count - len(found.names)
    # 50 numbers: their mean is known to 0.14, their standard deviation to 10 %
    assert abs(np.mean(z)) < 0.56
    assert 0.6 < np.std(z) < 1.4
    assert np.abs(z).max() < 4
    # some 900 degrees of freedom: known to 5 %
    assert chi2 / dof == pytest.approx(1, abs=0.19)


def test_a_stretch_on_another_object_is_left_out_and_the_flights_after_it_are_used():
    time, height = filmed_samples(FOAM, seconds=2.0, seed=1)
    impacts = bounces(MODELS["power"], FOAM, 4).impact_s
    other = (time > impacts[0] + 0.1) & (time < impacts[0] + 0.25)
    height[other] = 0.9
    drop = arcs.from_heights(time, height, 3e-3)
    off = [one for one in drop.dropped if "off the flight of its neighbours" in one.reason]
    assert [one.number - 1 for one in off] == np.flatnonzero(other).tolist()
    assert drop.track.flight.max() == 3  # as far as is recorded


def test_a_hidden_bounce_is_counted():
    time, height = filmed_samples(FOAM, seconds=2.0, seed=1)
    impacts = bounces(MODELS["power"], FOAM, 4).impact_s
    seen = (time < impacts[2] - 0.08) | (time > impacts[2] + 0.08)
    drop = arcs.from_heights(time[seen], height[seen], 3e-3)
    assert misplaced(drop, FOAM) == 0
    assert {2, 3} <= set(drop.track.flight.tolist())


def test_a_ball_that_lies_still_ends_what_is_used():
    time, height = filmed_samples(FOAM, seconds=3.0, seed=1)
    impacts = bounces(MODELS["power"], FOAM, 6).impact_s
    height[time > impacts[3]] = 0.123 + np.random.default_rng(1).normal(
        0, 3e-3, np.count_nonzero(time > impacts[3])
    )
    drop = arcs.from_heights(time, height, 3e-3)
    assert drop.track.flight.max() == 3
    assert NOT_SEEN in reasons(drop)


def test_a_recording_that_begins_within_a_rise_is_used_from_its_apex_on_and_says_so():
    time, height = filmed_samples(FOAM, fps=60, seconds=2.0, seed=1)
    found = bounces(MODELS["power"], FOAM, 1)
    late = time > found.impact_s[0] + 0.03
    drop = arcs.from_heights(time[late], height[late], 3e-3)
    apex = FOAM["release_time_s"] + found.apex_s[1]
    # a frame about an apex may be on either side of it
    assert drop.track.time_s[0] == pytest.approx(apex, abs=0.03)
    assert drop.heights_m[0] == pytest.approx(found.apex_m[1], abs=6e-3)
    (note,) = drop.notes
    assert f"counts as dropped at {drop.track.time_s[0]:.2f} s" in note
    assert "later bounce" in note


def test_a_ball_that_is_held_still_needs_no_note():
    time, height = filmed_samples(FOAM, seconds=2.0, seed=1)
    assert arcs.from_heights(time, height, 3e-3).notes == ()


def test_what_a_hand_does_is_no_flight():
    """A ball that is lowered slowly before the release, and one that is caught."""
    time, height = filmed_samples(FOAM, fps=60, seconds=2.0, seed=1)
    impacts = bounces(MODELS["power"], FOAM, 3).impact_s
    held, caught = time < FOAM["release_time_s"], time > impacts[2] + 0.1
    height[held] += 0.3 * np.cos(time[held] / FOAM["release_time_s"] * np.pi / 2) ** 2
    height[caught] = height[caught][0] + 0.3 * (time[caught] - time[caught][0])
    drop = arcs.from_heights(time, height, 3e-3)
    assert drop.track.flight.max() == 2
    assert not np.isin(time[held | caught], drop.track.time_s).any()


def test_flights_before_a_hidden_one_are_used():
    time, height = filmed_samples(FOAM, fps=60, seconds=2.0, seed=1)
    impacts = bounces(MODELS["power"], FOAM, 4).impact_s
    other = (time > impacts[0]) & (time < impacts[1])
    height[other] = 0.9
    drop = arcs.from_heights(time, height, 3e-3)
    assert drop.track.flight.tolist() == sorted(drop.track.flight.tolist())
    assert {0, 2, 3} <= set(drop.track.flight.tolist())
    assert misplaced(drop, FOAM) == 0


def test_samples_keep_their_place_among_all_that_were_recorded():
    time, height = filmed_samples(CORK, seconds=2.0, seed=2)
    height[20:22] = np.nan
    drop = arcs.from_heights(time, height, 3e-3)
    at = {one.number: one.time_s for one in drop.dropped}
    assert all(time[number - 1] == at[number] for number in at)
