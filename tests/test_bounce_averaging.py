"""What closed forms of a bounce say together."""

import pytest

from simcompare.fitting.bounces.averaging import averaged
from simcompare.fitting.bounces.model_selection import compare
from tests.bounces import TRUTH, heard


def test_a_law_that_was_told_is_not_averaged():
    choice = compare(heard(), ["power"])
    value, u = choice.best.restitution_at(3.0)
    assert averaged(choice).restitution_at(3.0) == pytest.approx(
        (value, u, value - 1.96 * u, value + 1.96 * u), rel=1e-4
    )


def test_laws_that_fit_as_well_widen_the_interval():
    choice = compare(heard({**TRUTH, "terminal_speed_m_s": 25.0}, count=6, u_s=1e-3))
    _, u = choice.best.restitution_at(4.0)
    value, u_all, low, high = averaged(choice).restitution_at(4.0)
    assert low < 0.85 < high
    assert low < value < high
    assert u_all > 2 * u
