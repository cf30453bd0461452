"""Uncertainties as people state them."""

import math

import pytest

from simcompare.errors import InputError
from simcompare.statistics import distributions as d
from simcompare.statistics.stated import stated


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("2%", d.normal(0.5, 0.01)),
        ("5g", d.normal(0.5, 0.005)),
        (0.005, d.normal(0.5, 0.005)),
        ("5g normal", d.normal(0.5, 0.005)),
        ("±5g", d.rectangular(-0.005, 0.005).scaled(1, 0.5)),
        ("+-5 g", d.rectangular(-0.005, 0.005).scaled(1, 0.5)),
        ("+/-1% triangular", d.triangular(-0.005, 0.005).scaled(1, 0.5)),
        ("±5g u_shaped", d.u_shaped(-0.005, 0.005).scaled(1, 0.5)),
        ("5g, dof 4", d.student_t(0.5, 0.005, 4)),
    ],
)
def test_what_is_stated_becomes_a_distribution(text, known):
    assert stated(text, 0.5, "kg", "mass_kg").distribution == known


def test_limits_may_have_degrees_of_freedom_too():
    found = stated("±5g, dof 8", 0.5, "kg", "mass_kg")
    assert (found.distribution.kind, found.degrees_of_freedom) == ("rectangular", 8.0)
    assert stated("±5g", 0.5, "kg", "mass_kg").degrees_of_freedom == math.inf


@pytest.mark.parametrize(
    ("text", "center", "fault"),
    [
        ("3s", 0.5, "m: the unit 's' does not fit; expected kg or a multiple of it"),
        ("-3g", 0.5, "m: -3g is no uncertainty; expected a number above 0"),
        ("0", 0.5, "m: 0 is no uncertainty; expected a number above 0"),
        ("2%", 0.0, "m: 2% of 0 is nothing; give the uncertainty in kg"),
        ("5g, dof 0.5", 0.5, "m: 0.5 are no degrees of freedom; expected a number of at least 1"),
        (
            "5g rectangular",
            0.5,
            "m: '5g rectangular' is a range without ±, or ± without a range; write ±5g rectangular",
        ),
        (
            "±5g normal",
            0.5,
            "m: '±5g normal' is a range without ±, or ± without a range; leave out the ±",
        ),
        (
            "±±5g",
            0.5,
            "m: '±±5g' is no uncertainty; expected such as 2%, 0.1mm, ±5g, '±5g triangular'"
            " or '0.1mm, dof 4'",
        ),
    ],
)
def test_what_cannot_be_read_is_refused(text, center, fault):
    with pytest.raises(InputError) as error:
        stated(text, center, "kg", "m")
    assert str(error.value) == fault
