"""The one restitution of engines for a ball whose own depends on the speed and the air."""

import numpy as np
import pytest

from simcompare.fitting.bounces import one_number, tune_engines
from simcompare.fitting.bounces.bounce_models import MODELS, bounces
from simcompare.fitting.bounces.deviations import Deviation, uneven
from simcompare.fitting.bounces.fit import fit
from simcompare.fitting.bounces.impacts import Impacts
from simcompare.fitting.bounces.roles import roles_of
from simcompare.fitting.bounces.tuning_goal import (
    MAX_STEPS,
    MIN_IMPACTS,
    MIN_PHASES,
    PHASES,
    goal_of,
)
from simcompare.scenarios import catalogue
from tests.bounces import IN_AIR, TRUTH, filmed, heard

LAW = {**IN_AIR, "exponent": 0.08}


@pytest.fixture(scope="module")
def best():
    return fit(heard(LAW, 10, u_s=1e-5), "power+drag", profiles=False)


def roles():
    file = catalogue.load("ball")
    return roles_of(file, {name: p.value for name, p in file.parameters.items()})


def goal(measured, model, step_s=None):
    found = fit(measured, model, profiles=False)
    return goal_of(roles(), found, found.restitution_at, [], step_s)


def test_all_but_the_restitution_stays_the_closed_forms(best):
    found = one_number.nearest(best, best.restitution_at).fit
    assert set(found.names) == set(best.names) - {"exponent"}
    for name in set(found.names) - {"restitution"}:
        ours, theirs = found.names.index(name), best.names.index(name)
        assert found.values[ours] == best.values[theirs]
        assert found.u[ours] == pytest.approx(best.u[theirs], rel=1e-12)
        assert found.intervals[ours] == best.intervals[theirs]
    assert np.linalg.eigvalsh(found.internal_covariance).min() > -1e-15


def test_the_nearest_number_is_between_the_ends_and_its_u_holds_the_misfit(best):
    found = one_number.nearest(best, best.restitution_at)
    k = found.fit.names.index("restitution")
    value, u = found.fit.values[k], found.fit.u[k]
    laws = bounces(MODELS["power"], LAW, 9).restitution  # of the tenth impact none is known
    assert laws.min() < value < laws.max()
    assert found.misfit == pytest.approx(np.sqrt(np.mean((laws - value) ** 2)), rel=1e-2)
    assert u >= found.misfit
    assert np.abs(laws - value).max() < 3 * u
    # no other number follows the measured times better
    problem, x = found.fit.problem, found.fit.x

    def chi2(e):
        moved = x.copy()
        moved[k] = e
        return np.sum(problem.residuals(moved) ** 2)

    assert chi2(value) < min(chi2(value - 1e-4), chi2(value + 1e-4))


def test_a_constant_restitution_is_the_closed_forms_own():
    found = fit(heard(IN_AIR, 10), "constant+drag", profiles=False)
    one = one_number.nearest(found, found.restitution_at)
    assert one.misfit == 0
    assert one.fit.values.tolist() == found.values.tolist()
    assert one.fit.u.tolist() == found.u.tolist()


def test_a_restitution_that_is_given_stays(best):
    given = fit(heard(TRUTH), "constant", fixed={"restitution": 0.85},
                unknowns=["drop_height_m", "release_time_s"], profiles=False)  # fmt: skip
    assert one_number.nearest(given, given.restitution_at).fit is given


def test_the_first_impact_is_what_a_plain_loop_is_tuned_to(best):
    speed = best.speeds_m_s[1]
    found = one_number.at_speed(best, best.restitution_at, speed)
    value, _ = best.restitution_at(speed)
    assert found.fit.as_dict()["restitution"] == value
    assert found.misfit > one_number.nearest(best, best.restitution_at).misfit


def test_a_goal_has_the_law_that_all_closed_forms_tell_together(best):
    def law(speed_m_s):
        return 0.8 - 0.01 * speed_m_s, 0.001

    wanted = goal_of(roles(), best, law, [])
    shown = Deviation(*[np.zeros(10)] * 3, np.full(10, 0.8), np.zeros(10), np.zeros(10))
    # what stands beside an engine's impacts is what it was tuned to, not one law among others
    rows = tune_engines.recorded_impacts(best, wanted, [shown])
    assert all(row.closed_form == law(row.speed_m_s)[0] for row in rows)
    assert rows[0].closed_form == pytest.approx(wanted.restitution, rel=1e-12)


def test_a_usual_drop_is_run_at_all_phases():
    found = goal(heard({**TRUTH, "restitution": 0.78, "drop_height_m": 0.8}), "constant")
    assert found.phases == PHASES
    assert found.counts == (7,)


def test_a_restitution_that_changes_from_impact_to_impact_is_uncertain():
    still, falling = (
        Deviation(*[np.zeros(3)] * 3, np.array(e), np.zeros(3), np.zeros(3))
        for e in ([0.8, 0.8, 0.8], [0.79, 0.8, 0.81])
    )
    assert uneven([still]) < 1e-15  # rounding of the mean
    assert uneven([falling]) == pytest.approx(0.01)


@pytest.mark.parametrize("step_s", [1e-3, 5e-4])
def test_a_long_drop_is_not_run_longer_than_engines_can_be_waited_for(step_s):
    high = {"restitution": 0.9, "drop_height_m": 6.0, "terminal_speed_m_s": 14.0}
    found = goal(heard(high, 20), "constant+drag", step_s)
    assert found.phases >= MIN_PHASES
    assert MIN_IMPACTS <= found.counts[0] <= 20
    assert found.phases * found.lasts_s[0] / step_s <= MAX_STEPS


def test_the_first_impacts_are_run_whatever_the_step():
    assert goal(heard(), "constant", 1e-5).counts == (MIN_IMPACTS,)


def test_only_an_impact_after_which_the_ball_was_followed_tells_a_restitution(best):
    times = heard(TRUTH, 7)
    assert (times.count, times.rebounds) == (7, 6)
    # the flight after impact 7, its height, or its samples tell how the ball left it
    assert Impacts(interval_numbers=(6, 7)).rebounds == 7
    assert Impacts(height_numbers=(0, 7)).rebounds == 7
    track = filmed(TRUTH)
    assert track.rebounds == track.track.flight.max()
    # so the headline, and the one number, are of nine of ten impacts
    speeds = bounces(MODELS["power+drag"], LAW, 10).speed_m_s
    assert best.speeds_m_s == pytest.approx((speeds[8], speeds[0]), rel=1e-3)
    laws = bounces(MODELS["power"], LAW, 9).restitution
    found = one_number.at_speed(best, best.restitution_at, best.speeds_m_s[1])
    value = found.fit.as_dict()["restitution"]
    assert found.most == pytest.approx(np.abs(laws - value).max(), rel=0.02)
