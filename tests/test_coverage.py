"""Coverage factors of sums of normal and rectangular sources."""

import math

import numpy as np
import pytest
from scipy import stats

from simcompare.statistics import coverage


def test_one_source_alone_has_the_factor_of_its_distribution():
    assert coverage.factor(1.0, math.inf, []) == pytest.approx(1.95996, abs=1e-4)
    assert coverage.factor(1.0, 4.0, []) == pytest.approx(2.77645, abs=1e-4)
    # 0.95·√3; 200,000 draws tell it to 0.002
    assert coverage.factor(0.0, math.inf, [2.0]) == pytest.approx(0.95 * math.sqrt(3), abs=0.008)


@pytest.mark.parametrize("share", [0.2, 1.0, 5.0])
def test_normal_and_rectangular_together_hold_95_percent(share):
    k = coverage.factor(1.0, math.inf, [share])
    # the chance of |n + r| <= k·u, with r spread over its width
    r = math.sqrt(3) * share * np.linspace(-1, 1, 20_001)
    end = k * math.hypot(1.0, share)
    assert np.mean(stats.norm.cdf(end - r) - stats.norm.cdf(-end - r)) == pytest.approx(
        0.95, abs=0.002
    )
