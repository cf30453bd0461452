"""Spring and damper with the force clipped at zero, against an integration of its equation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from simcompare.engine import dashpot


def integrated(zeta):
    """x'' = -x - 2ζ·x' from contact at speed 1 until the force x + 2ζ·x' is zero again."""

    def end(t, y):
        return y[0] + 2 * zeta * y[1] if t > 1e-9 else 1.0

    end.terminal = True
    found = solve_ivp(
        lambda t, y: (y[1], -y[0] - 2 * zeta * y[1]), (0, 200), (0.0, 1.0),
        events=end, rtol=1e-11, atol=1e-13, max_step=0.05,
    )  # fmt: skip
    return -found.y[1, -1]


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3, 0.9, 1.0, 1.5, 3.0])
def test_restitution_is_that_of_the_equation(zeta):
    assert dashpot.restitution(zeta) == pytest.approx(integrated(zeta), abs=1e-7)


def test_no_jump_where_the_formula_changes():
    around = [dashpot.restitution(1 + d) for d in (-1e-6, -1e-9, -1e-10, 0, 1e-10, 1e-9, 1e-6)]
    assert np.ptp(around) < 1e-6
    assert around[3] == math.exp(-2)


@given(st.floats(1e-6, 1.0))
def test_damping_ratio_is_the_inverse(e):
    assert dashpot.restitution(dashpot.damping_ratio(e)) == pytest.approx(e, rel=1e-7)


@given(st.floats(0, 1e6), st.floats(0, 1e6))
def test_more_damping_never_bounces_more(a, b):
    low, high = sorted((a, b))
    assert dashpot.restitution(low) >= dashpot.restitution(high) * (1 - 1e-8)


@pytest.mark.parametrize("e", [0.0, -0.1, 1.1, math.nan])
def test_a_restitution_out_of_range_is_refused(e):
    with pytest.raises(ValueError, match="e="):
        dashpot.damping_ratio(e)


def test_a_negative_damping_is_refused():
    with pytest.raises(ValueError, match="zeta"):
        dashpot.restitution(-0.1)
