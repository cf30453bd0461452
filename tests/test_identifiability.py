"""What data can tell: conditions, correlations, and the combinations that they cannot separate."""

import numpy as np
import pytest

from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.identifiability import identifiability
from simcompare.fitting.bounces.reading import from_times
from simcompare.model.plain import plain
from simcompare.results.records.fit_forms import Prior
from simcompare.statistics import identifiability as of_matrices
from tests.bounces import IN_AIR, TERMINAL, filmed, heard, known_words, times_of

KNOWN = {"terminal_speed_m_s": TERMINAL}


def exact(count):
    return from_times(times_of(IN_AIR, count), 1e-4)[0]


@pytest.mark.parametrize(
    ("model", "fixed", "count", "condition"),
    [
        ("constant", KNOWN, 6, 18),
        ("constant+drag", None, 6, 140),
        ("power", KNOWN, 6, 78),
        ("power+drag", None, 6, 1670),
        ("power+drag", None, 9, 780),
    ],
)
def test_the_condition_says_how_much_worse_the_worst_combination_is_known(
    model, fixed, count, condition
):
    known = identifiability(fit(exact(count), model, fixed=fixed))
    assert known.condition == pytest.approx(condition, rel=0.1)
    assert np.all(np.diff(known.singular_values) < 0)
    assert len(known.directions) == len(known.names)


def test_restitution_and_drag_cannot_be_told_apart_together_with_a_velocity_exponent():
    found = fit(exact(6), "power+drag")
    known = identifiability(found)
    i, j = known.names.index("restitution"), known.names.index("terminal_speed_m_s")
    assert known.correlation[i][j] == pytest.approx(-0.999, abs=1e-3)
    weak = [d for d in known.directions if d.weak]
    assert len(weak) == 1
    assert {"restitution", "terminal_speed_m_s", "exponent"} <= set(weak[0].moves)
    assert known_words(found)[0].startswith(
        "drag and a restitution that depends on speed are not separated by the sound: give the"
    )


def test_moving_along_a_weak_direction_changes_the_data_by_one_standard_deviation():
    found = fit(exact(6), "power+drag")
    along = identifiability(found).directions[-1].moves
    k = found.names.index("terminal_speed_m_s")
    step = np.array([along.get(name, 0.0) for name in found.names]) * 0.1
    step[k] *= -2 / found.values[k] ** 3  # what is sought is 1/v_t²
    moved = found.problem.residuals(found.x + step)
    still = found.problem.residuals(found.x)
    assert np.linalg.norm(moved - still) == pytest.approx(0.1, rel=0.15)


def test_well_determined_unknowns_are_said_to_be_so():
    found = fit(heard(), "constant")
    known = identifiability(found)
    assert known_words(found)[0].startswith("the data determine all unknowns")
    assert not any(d.weak for d in known.directions)


def test_priors_do_not_hide_what_the_data_alone_cannot_tell():
    priors = {"drop_height_m": Prior(1.0, 1e-3), "terminal_speed_m_s": Prior(TERMINAL, 0.43)}
    found = fit(exact(6), "power+drag", priors=priors)
    known = identifiability(found)
    assert known.condition == pytest.approx(1670, rel=0.1)
    assert known.u_data[0] > 2.5 * known.u[0]
    assert any("drop height is known from its prior alone" in word for word in known_words(found))


def test_a_clock_and_a_height_that_are_both_free_are_told_to_be_one():
    found = fit(heard(), unknowns=["restitution", "drop_height_m", "release_time_s", "clock_skew"])
    known = identifiability(found)
    assert known.condition > 1e6
    (said,) = [word for word in known_words(found) if "the data do not tell" in word]
    assert "clock skew" in said
    assert "drop height" in said
    helped = fit(heard(), unknowns=list(found.names), priors={"clock_skew": Prior(0.0, 50e-6)})
    assert helped.u[helped.names.index("restitution")] < 1e-4


def test_a_video_with_a_length_scale_of_its_own_is_told_to_measure_a_length():
    unknowns = ["restitution", "drop_height_m", "release_time_s", "floor_m", "scale", "clock_skew"]
    found = fit(filmed(), unknowns=unknowns, profiles=False)
    known = identifiability(found)
    assert known.condition > 1e6
    assert any("clock" in word and "length scale" in word for word in known_words(found))


def test_it_becomes_plain_values():
    again = plain(identifiability(fit(heard(IN_AIR), "power+drag")))
    assert again["names"][0] == "restitution"
    assert len(again["singular_values"]) == 5
    assert again["directions"][-1]["weak"]


def test_an_unknown_that_nothing_depends_on_is_named():
    known = of_matrices.identifiability(["a", "b"], np.array([[1.0, 0.0], [2.0, 0.0]]))
    assert known.u_data[1] is None
    assert [list(one.moves) for one in known.directions if one.weak] == [["b"]]


def test_a_weak_combination_beside_a_weaker_one_has_names_too():
    jacobian = [
        [1, 1, 1, 1],
        [1, 1, -1, -1],
        [1e-4, -1e-4, 1e-4, -1e-4],
        [1e-9, -1e-9, -1e-9, 1e-9],
    ]
    known = of_matrices.identifiability(["a", "b", "c", "d"], np.array(jacobian))
    weak = [direction for direction in known.directions if direction.weak]
    assert [list(direction.moves) for direction in weak] == [["a", "b", "c", "d"]] * 2
