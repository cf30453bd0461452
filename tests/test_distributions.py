"""Distributions: their standard uncertainties, and what they draw."""

import math

import numpy as np
import pytest

from simcompare.statistics import distributions as d
from simcompare.statistics.streams import stream

#: a distribution, and its standard uncertainty by JCGM 100:2008, 4.3 and JCGM 101:2008, 6.4
KNOWN = [
    (d.fixed(2.0), 0.0),
    (d.normal(2.0, 0.5), 0.5),
    (d.rectangular(1.0, 3.0), 1 / math.sqrt(3)),
    (d.triangular(1.0, 3.0), 1 / math.sqrt(6)),
    (d.u_shaped(1.0, 3.0), 1 / math.sqrt(2)),
    # N(0, 1) cut at ±1: variance 1 - 2·φ(1)/(2·Φ(1) - 1)
    (d.truncated_normal(2.0, 1.0, 1.0), math.sqrt(0.2911250947)),
    (d.student_t(2.0, 0.3, 9), 0.3 * math.sqrt(9 / 7)),
]


@pytest.mark.parametrize(("known", "u"), KNOWN, ids=lambda value: getattr(value, "kind", ""))
def test_the_standard_uncertainty_is_that_of_what_is_drawn(known, u):
    drawn = known.draw(np.random.default_rng(1), 400_000)
    assert known.u == pytest.approx(u, rel=1e-6)
    # five standard deviations of a standard deviation of 400,000 draws
    assert drawn.std() == pytest.approx(u, rel=0.01)
    assert drawn.mean() == pytest.approx(2.0, abs=5 * max(u, 1e-12) / math.sqrt(400_000))
    assert np.all(np.abs(drawn - 2.0) <= known.half_width)


def test_scaling_keeps_the_shape():
    known = d.rectangular(1.0, 3.0).scaled(-2.0, 1.0)
    assert known == d.rectangular(-5.0, -1.0)


@pytest.mark.parametrize("width", [0.0, -1.0, math.nan, math.inf])
def test_no_width_is_refused(width):
    for make in (lambda: d.normal(0.0, width), lambda: d.rectangular(0.0, width)):
        with pytest.raises(ValueError, match="expected"):
            make()


def test_a_stream_is_that_of_its_names():
    first = stream(3, "imu", "noise").normal(size=4)
    assert np.array_equal(first, stream(3, "imu", "noise").normal(size=4))
    for other in (stream(4, "imu", "noise"), stream(3, "imu", "bias"), stream(3, "imunoise")):
        assert not np.array_equal(first, other.normal(size=4))
