"""Scores of repeats of which not all can be measured."""

import numpy as np
import pytest

from simcompare.comparison.comparison import Repeat, scores_of
from simcompare.model.scenario import Scenario
from simcompare.model.trajectory import TRUTH, Trajectory

TIME_S = np.linspace(0.0, 1.0, 11)


@pytest.fixture
def scene():
    return Scenario.model_validate(
        {
            "name": "fall", "title": "A fall", "question": "How deep?",
            "world": {"duration_s": 1.0},
            "bodies": {"ball": {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1]}},
            "probes": {"height_m": {"observe": "ball.position_m", "component": 2,
                                    "label": "Height", "unit": "m"}},
            "measures": [{"function": "final", "probe": "height_m"}],
            "tolerances": {"final": {"absolute": 0.1, "reason": "Because of a ruler."}},
        }
    )  # fmt: skip


def at(height, lacks=False):
    signals = {} if lacks else {"ball.position_m": np.full((11, 3), float(height))}
    why = {"ball.position_m": "it has none"} if lacks else {}
    return Trajectory("north", TIME_S, signals, contact="tuned", lacks=why)


def final_of(scene, *found):
    truth = Trajectory(TRUTH, TIME_S, {"ball.position_m": np.ones((11, 3))})
    (score,) = scores_of([Repeat(scene, one, truth) for one in found])
    return score


def test_the_ends_of_the_repeats_stand_beside_their_mean(scene):
    score = final_of(scene, at(1.0), at(1.3), at(0.7))
    assert (score.value, score.low, score.high) == pytest.approx((1.0, 0.7, 1.3))


def test_the_ends_of_those_that_are_known_are_kept_where_there_is_no_mean(scene):
    score = final_of(scene, at(1.0), at(1.3), at(0.7, lacks=True))
    assert score.value is None
    assert score.repeats == 2
    assert (score.low, score.high) == pytest.approx((1.0, 1.3))


def test_why_nothing_is_known_is_told_and_nothing_is_judged(scene):
    score = final_of(scene, *(at(1.0, lacks=True) for _ in range(3)))
    assert (score.low, score.high, score.verdict) == (None, None, "info")
    assert score.lacking == "north does not give ball.position_m: it has none"


def test_a_repeat_that_cannot_be_measured_fails_nobody_whose_others_are_right(scene):
    right = final_of(scene, at(1.0), at(0.95), at(0.7, lacks=True))
    assert (right.value, right.verdict) == (None, "info")
    wrong = final_of(scene, at(1.0), at(1.3), at(0.7, lacks=True))
    assert (wrong.value, wrong.verdict) == (None, "fail")


def test_what_rounding_leaves_of_an_end_is_nothing(scene):
    score = final_of(scene, at(3e-16), at(1.3), at(0.7, lacks=True))
    assert score.low == 0.0


def test_without_a_truth_the_answer_is_about_the_mean_over_all_events():
    bounce = {
        "name": "b", "title": "t", "question": "q?", "world": {"duration_s": 1.0},
        "bodies": {"floor": {"fixed": True, "shapes": [{"type": "plane"}]},
                   "ball": {"mass_kg": 1, "inertia_kg_m2": [1, 1, 1], "position_m": [0, 0, 1],
                            "shapes": [{"type": "sphere", "radius_m": 0.1}]}},
        "contacts": [{"pair": ["ball", "floor"], "restitution": 0.5}],
        "probes": {"height_m": {"observe": "ball.position_m", "component": 2,
                                "label": "Height", "unit": "m"}},
        "measures": [{"function": "bounces", "probe": "height_m"}],
        "answer": {"measure": "restitution", "within": "a", "outside": "b", "nothing": "c"},
    }  # fmt: skip
    made = Scenario.model_validate(bounce)
    time_s, height, e, g = np.linspace(0.0, 1.6, 3201), [], 0.5, 9.80665
    first = np.sqrt(2 / g)
    hits = first * np.cumsum([1.0, *(2 * e**k for k in range(1, 8))])
    for t in time_s:
        k = int(np.searchsorted(hits, t, side="right"))
        speed, since = np.sqrt(2 * g) * e**k, t - hits[k - 1] if k else 0.0
        height.append(max(speed * since - g / 2 * since**2, 0.0) if k else 1 - g / 2 * t * t)
    place = np.column_stack([np.zeros((3201, 2)), height])
    found = Trajectory("north", time_s, {"ball.position_m": place}, contact="tuned")
    scores = scores_of([Repeat(made, found, None)])
    events = [s.value for s in scores if (s.measure, s.index is None) == ("restitution", False)]
    (whole,) = [s for s in scores if (s.measure, s.index) == ("restitution", None)]
    assert len(events) > 2
    assert whole.value == pytest.approx(np.mean(events))
    assert whole.value == pytest.approx(e, rel=0.01)  # the closed form
    assert whole.verdict == "info"
